// Tables of other loggers: the same drawn numbers in every dialect are read alike.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/input_error.hpp"
#include "core/test_seed.hpp"
#include "record/files.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/foreign/field_text.hpp"
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

void check_read(const std::string& bytes, const Drawn& values, double tolerance_s = 1e-9) {
  const TemporaryFolder folder;
  const std::vector<Recording> runs = read_recordings(put_plain(folder.file("f.csv"), bytes), std::nullopt, 1e-3);
  REQUIRE(runs.size() == 1);
  REQUIRE(runs[0].rows() == values.t_s.size());
  for (std::size_t i = 0; i < values.t_s.size(); ++i) {
    REQUIRE(runs[0].t_s()[i] == Approx(values.t_s[i]).margin(tolerance_s));
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

TEST_CASE("what a terminal would obey stands in no sentence, and a long field is cut") {
  const TemporaryFolder folder;
  const std::string text = "t_s,x_m,u_V\n0,1,\x1b]0;title\x07\n0.001,2,0\n0.002," + std::string(5000, '\0') +
                           ",0\n0.003,1,\xc2\x9b" + "31m\n";
  const CsvTable table = read_table(put_plain(folder.file("hostile.csv"), text));
  std::string told;
  for (const RecordingProblem& problem : table.problems) told += problem.sentence;
  CHECK(table.problems.size() >= 3);
  CHECK(std::none_of(told.begin(), told.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }));
  CHECK(told.find("\xc2\x9b") == std::string::npos);
  CHECK(told.size() < 1000);
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

namespace {

/// The drawn values with another text for each time, under given names.
std::string with_times(const Drawn& values, const std::function<std::string(double)>& time_text) {
  std::string out = "t_s,x_m,u_V\n";
  for (std::size_t i = 0; i < values.t_s.size(); ++i)
    out += fmt::format("{},{:.6f},{:.4f}\n", time_text(values.t_s[i]), values.x_m[i], values.u_V[i]);
  return out;
}

/// hh:mm:ss.uuuuuu with the sign before the decimals, the hour on a clock of 12 where that is asked.
std::string time_of_day(double time_s, double start_s, char sign = '.', bool is_half = false) {
  const auto all_us = std::llround((start_s + time_s) * 1e6);
  const auto hours = all_us / 3'600'000'000;
  return fmt::format("{}:{:02d}:{:02d}{}{:06d}", is_half ? (hours + 11) % 12 + 1 : hours, all_us / 60'000'000 % 60,
                     all_us / 1'000'000 % 60, sign, all_us % 1'000'000);
}

/// Digits in groups of three.
std::string grouped(double value, const std::string& group, char decimal) {
  const std::string digits = fmt::format("{}", static_cast<long>(value));
  std::string out;
  for (std::size_t i = 0; i < digits.size(); ++i)
    out += (i > 0 && (digits.size() - i) % 3 == 0 ? group : "") + digits[i];
  return fmt::format("{}{}{:02.0f}", out, decimal, 100 * (value - std::floor(value)));
}

std::vector<std::string> taken_for(const std::string& bytes) {
  const TemporaryFolder folder;
  std::vector<std::string> out;
  for (const ColumnGuess& guess : guess_columns(read_table(put_plain(folder.file("g.csv"), bytes))))
    out.push_back(guess.ours.empty() ? "" : fmt::format("{} {:g} {:g}", guess.ours, guess.factor, guess.offset));
  return out;
}

}  // namespace

TEST_CASE("clocks of 12 hours, zones, other dates and durations are the same times") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  const Drawn values = drawn_values(generator, 1e-3);
  const double noon = 12 * 3600 - 0.03, at_one = 13 * 3600 - 0.03;  // passed within the rows
  const auto half = [](double t, double start_s) {
    return time_of_day(t, start_s, '.', true) + (start_s + t < 12 * 3600 ? " AM" : " PM");
  };
  const std::vector<std::function<std::string(double)>> forms{
      [&](double t) { return half(t, noon); },
      [&](double t) { return half(t, at_one); },
      [&](double t) { return "12/31/2026 " + half(t, at_one); },
      [&](double t) { return "31/12/2026 " + time_of_day(t, at_one); },
      [&](double t) { return "31.12.26 " + time_of_day(t, at_one); },
      [&](double t) { return "03-Jan-2026 " + time_of_day(t, at_one); },
      [&](double t) { return "3. Mai 2026 " + time_of_day(t, at_one); },
      [&](double t) { return "2026-01-03 " + time_of_day(t, at_one) + " UTC"; },
      [&](double t) { return "2026-01-03T" + time_of_day(t, at_one) + "+01:00[Europe/Berlin]"; },
      [&](double t) { return fmt::format("20260103T{:06d}.{:06.0f}", 101112, 1e6 * t); },
      [&](double t) { return time_of_day(t, at_one, ':'); },
      [&](double t) { return "0 days " + time_of_day(t, 0); },
      [&](double t) { return fmt::format("{:.6f} sec", t); },
  };
  for (const auto& form : forms) {
    CAPTURE(form(0));
    check_read(with_times(values, form), values, 1e-6);  // seconds since 1970 have seven decimals
  }
}

TEST_CASE("digits in groups of three are numbers, and a sign that may be decimal is not taken for a group's") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> value(1e3, 9e6);
  const TemporaryFolder folder;
  for (const auto& [group, decimal] : std::vector<std::pair<std::string, char>>{
           {".", ','}, {",", '.'}, {"'", '.'}, {" ", ','}, {"\u00a0", ','}, {"\u202f", ','}, {"\xa0", ','}}) {
    std::string text = "t_s;p1_port_Pa\n";
    std::vector<double> expected;
    for (int i = 0; i < 20; ++i) {
      expected.push_back(std::floor(value(generator)) + 0.25);
      text += fmt::format("0{}{:02d};{}\n", decimal, i, grouped(expected.back(), group, decimal));
    }
    CAPTURE(text.substr(0, 60));
    const CsvTable table = read_table(put_plain(folder.file("groups.csv"), text));
    REQUIRE(table.values[1] == expected);
  }
  const CsvTable comma = read_table(put_plain(folder.file("comma.csv"), "t_s;p\n0,001;1,250\n0,002;469,900\n"));
  CHECK(comma.values[1] == std::vector<double>{1.25, 469.9});
  double number = 0;
  for (const char* odd : {"1 23", "1.2.3", "12,34,567", "0.123.456", "1'234'56", "1 234 x", ".123.456", "-"})
    for (const char decimal : {'.', ','}) {
      CAPTURE(odd, decimal);
      CHECK_FALSE(number_in(odd, decimal, number));
    }
}

TEST_CASE("names tell quantity and unit in every form, also a path's last part") {
  const std::string rows = "0,1,2,3\n1,2,3,4\n";
  const std::vector<std::string> mm{"t_s 1 0", "x_m 0.001 0", "u_V 1 0", "p1_port_Pa 100000 0"};
  for (const char* names : {"t/s,x/mm,u/V,p1/bar", "Zeit in s,Weg in mm,Ventil in V,p1 in bar",
                            "Zeit <s>,Weg <mm>,Ventil <V>,p1 <bar>", "TIME [S],POSITION [MM],VALVE [V],P1 [BAR]",
                            "Untitled/Time (s),Untitled/Position (mm),Untitled/Valve (V),Untitled/p1 (bar)",
                            "/log/time_s,/axis/position_mm,/axis/command_V,/axis/p1_bar",
                            "Time,Position,Valve,p1\nSeconds,Millimeters,Volts,Bar",
                            "Time,Position,Valve,p1\ns,mm,V,bar\ndouble,double,double,double"}) {
    CAPTURE(names);
    CHECK(taken_for(std::string(names) + "\n" + rows) == mm);
  }
  for (const char* name : {"p1 [bar(g)]", "p1 [barg]", "p1 (bar g)", "p1_barg", "p1 bar(g)"}) {
    CAPTURE(name);
    CHECK(taken_for(std::string("t_s,") + name + "\n0,1\n1,2\n").at(1) == "p1_port_Pa 100000 101325");
  }
  CHECK(taken_for("t_s,Position [m/s]\n0,1\n1,2\n").at(1).empty());
  CHECK(
      taken_for("Date,Elapsed [ms],x_m\n2026-01-03 10:00:00,0,1\n2026-01-03 10:00:00,1,2\n2026-01-03 10:00:01,2,3\n") ==
      std::vector<std::string>{"", "t_s 0.001 0", "x_m 1 0"});
}

TEST_CASE("names stand in a comment, over several lines, twice or not at all, and heads may look like rows") {
  const TemporaryFolder folder;
  const auto names_of_table = [&](const std::string& bytes) {
    const CsvTable table = read_table(put_plain(folder.file("n.csv"), bytes));
    CHECK(table.rows() == 3);
    return fmt::format("{}", fmt::join(table.names, "|"));
  };
  const std::string rows = "0,1,2\n1,2,4\n2,3,5\n";
  CHECK(names_of_table("# a logger\n# t_s,x_m,u_V\n" + rows) == "t_s|x_m|u_V");
  CHECK(names_of_table("% t_s x_m u_V\n0 1 2\n1 2 4\n2 3 5\n") == "t_s|x_m|u_V");
  CHECK(names_of_table("\"Time\n[s]\",\"Position\r\n[mm]\",u_V\n" + rows) == "Time [s]|Position [mm]|u_V");
  CHECK(names_of_table("t_s,Druck,Druck\n" + rows) == "t_s|Druck|Druck (2)");
  CHECK(names_of_table("Samples,3,3\nX0,0,0\n\n***End***,,\nX_Value,a,b\n" + rows) == "X_Value|a|b");
  CHECK(names_of_table("Model,MSO\nRecord Length,3,\nTIME,CH1,CH2\n" + rows) == "TIME|CH1|CH2");
  CHECK(names_of_table(
            "Name;Weg;Name;Kraft\nUnit;mm;Unit;N\nSampleTime[ms];1;SampleTime[ms];1\n0;1;0;2\n1;2;1;4\n2;3;2;5\n") ==
        "Time|Weg|Time (2)|Kraft");
  const CsvTable joined = read_table(put_plain(folder.file("n.csv"), "Name,x,Name,F\n0,1,0,2\n1,2,10,3\n"));
  CHECK(joined.names == std::vector<std::string>{"Time", "x", "F"});
  CHECK(joined.values[0] == std::vector<double>{0, 1, 10});
  CHECK(joined.values[2][2] == 3);
  CHECK_THROWS_WITH(read_table(put_plain(folder.file("n.csv"), "# 3 channels\n" + rows)),
                    Contains("column name is expected"));
  const CsvTable inches = read_table(put_plain(folder.file("i.csv"), "t_s,size\n0,5\"\n1,6\"\n2,7\"\n"));
  CHECK(inches.rows() == 3);
}

TEST_CASE("a text column is told once, a quoted line end stays in its field, and units behind values are taken off") {
  const TemporaryFolder folder;
  std::string text = "t_s,state,x,note\n";
  for (int i = 0; i < 300; ++i) text += fmt::format("{} ms,RUN,{}.5 mm,{}\n", i, i, i == 7 ? "\"a\nb\"" : "");
  const CsvTable table = read_table(put_plain(folder.file("t.csv"), text));
  CHECK(table.rows() == 300);
  const CsvTable texts = read_table(put_plain(folder.file("s.csv"), "t;a;b;x\n0,5;RUN;AUTO;1,5\n0,6;RUN;AUTO;1,6\n"));
  CHECK(texts.values[3] == std::vector<double>{1.5, 1.6});
  CHECK(table.values[2][299] == 299.5);
  CHECK(table.units == std::vector<std::string>{"ms", "", "mm", ""});
  REQUIRE(table.problems.size() == 3);
  CHECK_THAT(table.problems[0].sentence, Contains("units behind the values"));
  CHECK_THAT(table.problems[1].sentence + table.problems[2].sentence,
             Contains("note is \"a b\"") && Contains("column state holds text such as \"RUN\""));
}

TEST_CASE("lines may end in CR or CR CR LF, blank lines may stand between, and rows may be in another order") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  const Drawn values = drawn_values(generator, 1e-3);
  for (const std::string end : {"\r", "\r\r\n", "\n\n", "\r\n\r\n"}) {
    Writing how;
    how.line_end = end;
    check_read(table_text(values, how), values);
  }
  Drawn reversed = values;
  for (auto* column : {&reversed.t_s, &reversed.x_m, &reversed.u_V}) std::reverse(column->begin(), column->end());
  check_read(table_text(reversed, {}), values);
  std::vector<std::size_t> order(values.t_s.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), generator);
  Drawn shuffled = values;
  for (std::size_t i = 0; i < order.size(); ++i) {
    shuffled.t_s[i] = values.t_s[order[i]];
    shuffled.x_m[i] = values.x_m[order[i]];
    shuffled.u_V[i] = values.u_V[order[i]];
  }
  check_read(table_text(shuffled, {}), values);
  for (const std::string sign : {"\u2212", "\u2013"}) {
    std::string minus = table_text(values, {});
    for (std::size_t at; (at = minus.find(",-")) != std::string::npos;) minus.replace(at, 2, "," + sign);
    check_read(minus, values);
    double value = 0;
    CHECK(number_in(sign + "9.5e" + sign + "05", '.', value));
    CHECK(value == -9.5e-5);
  }
  double grouped = 0;
  CHECK(number_in("(1\u202f234,5)", ',', grouped));
  CHECK(grouped == -1234.5);
}

TEST_CASE("what is no number in the words of some run-time libraries is read as no value") {
  const TemporaryFolder folder;
  for (const std::string word : {"1.#QNAN", "-1.#IND00", "1.#INF", "1.#SNAN", "1.$"}) {
    const CsvTable table =
        read_table(put_plain(folder.file("words.csv"), "t_s,x_m\n0,0.1\n0.001," + word + "\n0.002,0.3 # end\n"));
    INFO(word);
    REQUIRE(table.column("x_m").size() == 3);
    CHECK(std::isnan(table.column("x_m")[1]));
    CHECK(table.column("x_m")[2] == 0.3);
  }
}

TEST_CASE("rows may end in more or fewer separators than others") {
  const TemporaryFolder folder;
  std::string text = "t_s,x_m,u_V\n";
  for (int i = 0; i < 40; ++i)
    text +=
        fmt::format("{:.3f},{:.2f},{}", 1e-3 * i, 0.01 * i, i % 10 == 7 ? "" : "0.5") + std::string(i % 4, ',') + "\n";
  const CsvTable table = read_table(put_plain(folder.file("ragged.csv"), text));
  REQUIRE(table.rows() == 40);
  CHECK(table.column("x_m")[39] == Approx(0.39));
  CHECK(std::isnan(table.column("u_V")[7]));
  CHECK(table.column("u_V")[38] == 0.5);
  CHECK(table.problems.empty());
}

TEST_CASE("a column of the time since the row before makes times, a refused row being as long as the next") {
  const TemporaryFolder folder;
  for (const std::string name : {"dt [ms]", "delta_t_ms", "\u0394t [ms]", "Time step (ms)"}) {
    std::string text = name + ",pos [mm]\n";
    for (int i = 0; i < 30; ++i) text += i == 11 ? "2,1,1\n" : fmt::format("{},{}\n", i % 2 == 0 ? 2 : 3, i);
    INFO(name);
    const CsvTable table = read_table(put_plain(folder.file("intervals.csv"), text));
    const std::vector<double>& t_s = table.column("t_s");
    REQUIRE(t_s.size() == 29);
    CHECK(t_s[1] == Approx(0.003));
    CHECK(t_s[10] == Approx(0.025));
    CHECK(t_s[11] == Approx(0.029));  // row 11 and row 12, both 2 ms
  }
  CHECK(meaning_of("p\u2081 / bar") == "p1_port_Pa");
}

TEST_CASE("a blank line before rows that count themselves holds no field and no name") {
  const TemporaryFolder folder;
  const CsvTable table = read_table(put_plain(folder.file("counted.txt"), "force\n\n1 0.5\n2 0.7\n3 0.8\n"));
  REQUIRE(table.names == std::vector<std::string>{"force"});
  CHECK(table.column("force") == std::vector<double>{0.5, 0.7, 0.8});
}

TEST_CASE("files of other formats are named with what to do") {
  const TemporaryFolder folder;
  using namespace std::string_literals;
  for (const auto& [bytes, words] :
       std::vector<std::pair<std::string, std::string>>{{"PK\3\4" + std::string(300, '\1'), "zip archive"},
                                                        {"\xd0\xcf\x11\xe0\xa1\xb1"s, "Excel"},
                                                        {"TDSm\0\0"s, "TDMS"},
                                                        {"\x89HDF\r\n"s, "HDF5"},
                                                        {"PAR1"s, "Parquet"},
                                                        {"\x28\xb5\x2f\xfd"s, "zstd"},
                                                        {"\xff\xfe\0\0t\0\0\0"s, "UTF-32"},
                                                        {"MATLAB 5.0 MAT-file, x"s, ".mat"}})
    CHECK_THROWS_WITH(read_table(put_plain(folder.file("b.csv"), bytes)), Contains(words) && Contains("as text"));
  CHECK_THROWS_WITH(read_table(put_plain(folder.file("b.csv"), "a\x01"
                                                               "b,c\x02\n1,2\n")),
                    Contains("no text"));
}
