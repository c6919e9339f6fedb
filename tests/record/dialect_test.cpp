// Tables of other loggers: the same drawn numbers in every dialect are read alike.
#include <cmath>
#include <random>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "config/input_error.hpp"
#include "core/test_seed.hpp"
#include "record/files.hpp"
#include "record/import.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

/// How a logger writes.
struct Writing {
  std::string separator = ",";
  char decimal = '.';
  std::string quote;
  std::string before, units;
  bool has_index = false, is_trailing = false;
  std::string line_end = "\n";
};

struct Drawn {
  std::vector<double> t_s, x_m, u_V;
};

Drawn drawn_values(std::mt19937& generator, double interval_s) {
  std::uniform_real_distribution<double> value(-1, 1);
  Drawn out;
  for (int i = 0; i < 60; ++i) {
    out.t_s.push_back(std::round(i * interval_s * 1e6) * 1e-6);
    out.x_m.push_back(std::round(0.1 * value(generator) * 1e6) * 1e-6);
    out.u_V.push_back(std::round(5 * value(generator) * 1e4) * 1e-4);
  }
  return out;
}

std::string number(double value, const Writing& how) {
  std::string text = fmt::format("{:.6f}", value);
  std::replace(text.begin(), text.end(), '.', how.decimal);
  return how.quote + text + how.quote;
}

std::string table_text(const Drawn& values, const Writing& how) {
  const std::string end = (how.is_trailing ? how.separator : "") + how.line_end;
  const auto name = [&](const char* text) { return how.quote + text + how.quote; };
  std::string out = how.before + (how.has_index ? how.separator : "") + name("t_s") + how.separator + name("x_m") +
                    how.separator + name("u_V") + end;
  if (!how.units.empty()) out += how.units + how.line_end;
  for (std::size_t i = 0; i < values.t_s.size(); ++i)
    out += (how.has_index ? fmt::format("{}{}", i, how.separator) : "") + number(values.t_s[i], how) + how.separator +
           number(values.x_m[i], how) + how.separator + number(values.u_V[i], how) + end;
  return out;
}

void check_read(const std::string& bytes, const Drawn& values) {
  const TemporaryFolder folder;
  const std::vector<Recording> runs = read_recordings(put_plain(folder.file("f.csv"), bytes), std::nullopt, 1e-3);
  REQUIRE(runs.size() == 1);
  REQUIRE(runs[0].rows() == values.t_s.size());
  for (std::size_t i = 0; i < values.t_s.size(); ++i) {
    REQUIRE(runs[0].t_s()[i] == Approx(values.t_s[i]).margin(1e-9));
    REQUIRE(runs[0].column("x_m")[i] == Approx(values.x_m[i]).margin(1e-9));
    REQUIRE(runs[0].column("u_V")[i] == Approx(values.u_V[i]).margin(1e-9));
  }
}

std::string utf16(const std::string& text, bool big_endian, bool mark) {
  std::string out = mark ? (big_endian ? "\xfe\xff" : "\xff\xfe") : "";
  for (const char c : text) {
    if (big_endian) out += '\0';
    out += c;
    if (!big_endian) out += '\0';
  }
  return out;
}

}  // namespace

TEST_CASE("a table reads alike in every dialect") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  const Drawn values = drawn_values(generator, 1e-3);
  for (const std::string separator : {",", ";", "\t", " ", "   ", ", ", "|"})
    for (const char decimal : {'.', ','})
      for (const std::string quote : {"", "\""})
        for (const int edge : {0, 1, 2, 3, 4}) {
          if (decimal == ',' && separator.find(',') != std::string::npos && !quote.empty()) continue;
          if (decimal == ',' && separator == ", ") continue;
          const bool is_blank = separator.find_first_not_of(' ') == std::string::npos;
          const bool is_paired = decimal == ',' && separator == ",";
          if ((is_blank || is_paired) && edge > 1) continue;
          Writing how{separator, decimal, quote, "", "", edge == 2, edge == 3, edge == 4 ? "\r\n" : "\n"};
          if (edge == 1) how.before = "Logger 7\nsample rate: 1 kHz\n\n";
          if (edge == 4) how.units = "s" + separator + "m" + separator + "V";
          CAPTURE(separator, decimal, quote, edge);
          check_read(table_text(values, how), values);
        }
}

TEST_CASE("UTF-16 and Latin-1 are read, quotes protect separators, and the dialect is told") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  const Drawn values = drawn_values(generator, 1e-3);
  const std::string text = table_text(values, {});
  for (const bool big_endian : {false, true})
    for (const bool mark : {false, true}) check_read(utf16(text, big_endian, mark), values);
  check_read("\xef\xbb\xbf" + text, values);
  const TemporaryFolder folder;
  const CsvTable table = read_table(put_plain(folder.file("l.csv"), "\"Zeit, lokal\";Weg_\xb5m;Temp_\xb0"
                                                                    "C\n0,5;1,25;2\n0,6;1,5;3\n"));
  CHECK(table.names == std::vector<std::string>{"Zeit, lokal", "Weg_\u00b5m", "Temp_\u00b0C"});
  CHECK(table.values[1] == std::vector<double>{1.25, 1.5});
  REQUIRE(table.problems.size() == 1);
  CHECK_THAT(table.problems[0].sentence, Contains("separator ;") && Contains("decimal comma") && Contains("quotes"));
}

TEST_CASE("dates and epoch times in every unit become seconds from the first row on") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  const double interval_s = std::uniform_int_distribution<int>(1, 20)(generator) * 1e-3;
  const auto start_s = std::uniform_int_distribution<long>(1'000'000'000, 1'900'000'000)(generator);
  const TemporaryFolder folder;
  const auto check_times = [&](const auto& time_text, double tolerance_s) {
    std::string text = "t_s,x_m\n";
    for (int i = 0; i < 80; ++i) text += fmt::format("{},{}\n", time_text(i), 0.001 * i);
    const Recording run = read_recordings(put_plain(folder.file("e.csv"), text), std::nullopt, 1e-3).at(0);
    CAPTURE(text.substr(0, 60));
    CHECK(run.period_s == Approx(interval_s).epsilon(2e-3));
    for (int i = 0; i < 80; ++i)
      REQUIRE(run.t_s()[static_cast<std::size_t>(i)] == Approx(i * interval_s).margin(tolerance_s));
  };
  const long step_us = std::lround(interval_s * 1e6);
  check_times(
      [&](int i) { return fmt::format("{}.{:06d}", start_s + i * step_us / 1'000'000, i * step_us % 1'000'000); },
      1e-5);
  check_times([&](int i) { return fmt::format("{}", start_s * 1000 + i * step_us / 1000); }, 1e-5);
  check_times([&](int i) { return fmt::format("{}", start_s * 1'000'000 + i * step_us); }, 1e-5);
  check_times([&](int i) { return fmt::format("{}", (start_s * 1'000'000 + i * step_us) * 1000); }, 1e-5);
  check_times([&](int i) { return fmt::format("{}", i * step_us); }, 1e-9);         // microseconds
  check_times([&](int i) { return fmt::format("{}", i * step_us * 1000); }, 1e-9);  // nanoseconds
  for (const char* form : {"2026-01-03T23:59:{:02d}.{:06d}Z", "2026-01-03 23:59:{:02d}.{:06d}",
                           "03.01.2026 23:59:{:02d}.{:06d}", "23:59:{:02d}.{:06d}"})
    check_times(
        [&](int i) { return fmt::format(fmt::runtime(form), 10 + i * step_us / 1'000'000, i * step_us % 1'000'000); },
        1e-5);
}

TEST_CASE("a file of one row a second is not taken for milliseconds where the loop is slow") {
  const TemporaryFolder folder;
  std::string text = "t_s,p1_chamber_Pa\n";
  for (int i = 0; i < 50; ++i) text += fmt::format("{},{}\n", i, 5e5 - i);
  const Recording slow = read_recordings(put_plain(folder.file("s.csv"), text), std::nullopt, 0.1).at(0);
  CHECK(slow.t_s().back() == 49);
  const Recording fast = read_recordings(folder.file("s.csv"), std::nullopt, 1e-3).at(0);
  CHECK(fast.t_s().back() == Approx(0.049));
  CHECK_THAT(fast.problems.at(0).sentence, Contains("milliseconds"));
}
