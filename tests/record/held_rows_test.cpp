// Rows and columns that repeat a sample, and columns that only look so.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "record/motion.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

double noise(int i) { return std::fmod(i * 0.618034, 1.0); }
double pressure_bar(int i) { return 4 + std::sin(0.004 * i) + 0.001 * noise(i); }

/// The motion with a pressure of its own.
Understood with_pressure(const std::function<double(int)>& bar, int decimals = 4) {
  return understood("t_s,x_m,u_V,p1_bar\n" + rows([&](int i, double t, double x, double u) {
                      return fmt::format("{:.3f},{:.7f},{:.4f},{:.{}f}", t, x, u, bar(i), decimals);
                    }));
}

std::size_t known(const Recording& run, const char* column) {
  const auto& values = run.column(column);
  return static_cast<std::size_t>(std::ranges::count_if(values, [](double value) { return std::isfinite(value); }));
}

}  // namespace

TEST_CASE("a sensor that is written n times alike has one sample in n rows") {
  for (const int n : {2, 3, 4, 10, 50}) {
    CAPTURE(n);
    const Understood found = with_pressure([n](int i) { return pressure_bar(i - (i + 1) % n); });
    REQUIRE(found.run.rows() == row_count);
    const auto samples = static_cast<std::size_t>((row_count + n - 1) / n);
    CHECK(known(found.run, "p1_port_Pa") + 1 >= samples);
    CHECK(known(found.run, "p1_port_Pa") <= samples + 1);
    CHECK(known(found.run, "x_m") == row_count);
    CHECK_THAT(found.told, Contains(fmt::format("p1_bar changes in every {}. row alone", n)));
    const auto& p1 = found.run.column("p1_port_Pa");
    for (int i = 0; i < row_count; ++i)
      if (std::isfinite(p1[static_cast<std::size_t>(i)])) CHECK((i + 1) % n == 0);
  }
}

TEST_CASE("a sensor of 400 Hz in rows of 1 kHz repeats each sample two or three times") {
  const Understood found =
      with_pressure([](int i) { return pressure_bar(static_cast<int>(2.5 * std::floor(i / 2.5))); });
  CHECK(known(found.run, "p1_port_Pa") > 1150);
  CHECK(known(found.run, "p1_port_Pa") <= 1200);
  CHECK_THAT(found.told, Contains("p1_bar changes in every 2. or 3. row alone"));
}

TEST_CASE("rows that repeat as a whole are left out") {
  const Understood found =
      understood("t_s,x_m,u_V,p1_bar\n" + rows([](int i, double t, double, double) {
                   const int k = i / 5;
                   return fmt::format("{:.4f},{:.7f},{:.4f},{:.4f}", t / 5, x_m_at(k), u_V_at(k), pressure_bar(k));
                 }));
  REQUIRE(found.run.rows() == row_count / 5);
  CHECK(found.run.period_s == Approx(1e-3));
  CHECK(found.run.column("x_m")[7] == Approx(x_m_at(7)));
  CHECK(found.run.t_s()[7] == Approx(7e-3));
  CHECK_THAT(found.told, Contains("all columns change in every 5. row alone: 2400 rows"));
}

TEST_CASE("columns of two rates that are both filled up keep their own samples") {
  const Understood found = understood("t_s,x_m,u_V,p1_bar\n" + rows([](int i, double t, double, double) {
                                        return fmt::format("{:.3f},{:.7f},{:.4f},{:.4f}", t, x_m_at(i - i % 4),
                                                           u_V_at(i - i % 4), pressure_bar(i - i % 20));
                                      }));
  CHECK(found.run.rows() == row_count / 4);
  CHECK(known(found.run, "x_m") == row_count / 4);
  CHECK(known(found.run, "p1_port_Pa") == row_count / 20);
}

TEST_CASE("coarse, slow and resting sensors and held commands keep their values") {
  const auto check_whole = [](const char* what, const std::function<double(int)>& bar) {
    CAPTURE(what);
    const Understood found = with_pressure(bar);
    CHECK(found.run.rows() == row_count);
    CHECK(known(found.run, "p1_port_Pa") == row_count);
    CHECK(found.told.empty());
  };
  check_whole("as it is", pressure_bar);
  check_whole("coarse", [](int i) { return std::round(20 * pressure_bar(i)) / 20; });
  check_whole("an even slope of one step in four rows", [](int i) { return 3 + 0.01 * (i / 4); });
  check_whole("at rest", [](int) { return 4.5; });
  check_whole("changed rarely", [](int i) { return i < 1000 ? 4.5 : i < 2000 ? 4.6 : 4.9; });
  const Understood held = understood("t_s,x_m,u_V\n" + rows([](int i, double t, double x, double) {
                                       return fmt::format("{:.3f},{:.7f},{:.4f}", t, x, u_V_at(i - i % 4));
                                     }));
  CHECK(held.told.empty());
  CHECK(known(held.run, "u_V") == row_count);
}

TEST_CASE("a slow quantised channel keeps its rows, whatever its last digit makes of a quantum") {
  for (const double quantum : {0.00244, 0.0098, 0.0488, 0.013})
    for (const double rows_of_quantum : {2.4, 2.6, 3.5, 16.4, 40.7}) {
      CAPTURE(quantum, rows_of_quantum);
      const Understood found = with_pressure([&](int i) { return 3 + quantum * std::floor(i / rows_of_quantum); }, 3);
      CHECK(found.run.rows() == row_count);
      CHECK(known(found.run, "p1_port_Pa") == row_count);
      CHECK(found.told.empty());
    }
}

TEST_CASE("a cycle with a period of so many rows is no clock") {
  for (const int n : {4, 20, 25}) {
    CAPTURE(n);
    const Understood found =
        understood("t_s,x_mm,u_V,p1_bar,p2_bar\n" + rows([n](int i, double t, double, double) {
                     const int k = i / n;
                     const bool is_out = k % 2 != 0;
                     return fmt::format("{:.3f},{},{},{},{}", t, is_out ? 100 - (k % 3 == 0) : 0, is_out ? 5 : -5,
                                        is_out ? 7 - 0.1 * (k % 5 == 0) : 1, is_out ? 1 : 7);
                   }));
    CHECK(found.run.rows() == row_count);
    CHECK(known(found.run, "x_m") == row_count);
    CHECK(known(found.run, "p1_port_Pa") == row_count);
  }
}

TEST_CASE("rows and repeats stay where changes are at few of the n-th rows") {
  // Every 60 rows, and once after 80: all are multiples of 20.
  const Understood found = understood("t_s,x_m,u_V,p1_bar\n" + rows([](int i, double t, double, double) {
                                        const int k = (i < 600 ? i : i - 20) / 60;
                                        return fmt::format("{:.3f},{:.7f},{:.4f},{:.4f}", t, x_m_at(40 * k),
                                                           u_V_at(40 * k), pressure_bar(40 * k));
                                      }));
  CHECK(found.run.rows() == row_count);
  CHECK(known(found.run, "p1_port_Pa") == row_count);
}
