// Numbers that stand for no value, and right values that look like them.
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

/// Pressures of a moving slider with the noise of a sensor.
double p1_bar_at(int i) { return 4 + 1.5 * std::sin(0.004 * i) + 0.001 * std::fmod(i * 0.618034, 1.0); }
double p2_bar_at(int i) { return 5 - 1.5 * std::sin(0.004 * i) + 0.001 * std::fmod(i * 0.414214, 1.0); }

struct Values {
  double x_mm, u_V, p1_bar, p2_bar;
};

/// The motion, changed in each row.
Understood changed(const std::function<void(int, Values&)>& change) {
  return understood("t_s,x_mm,u_V,p1_bar,p2_bar\n" + rows([&](int i, double t, double x, double u) {
                      Values values{1e3 * x, u, p1_bar_at(i), p2_bar_at(i)};
                      change(i, values);
                      return fmt::format("{:.3f},{:.4f},{:.4f},{:.4f},{:.4f}", t, values.x_mm, values.u_V,
                                         values.p1_bar, values.p2_bar);
                    }));
}

std::size_t lacking(const Understood& found, const char* column) {
  std::size_t count = 0;
  for (const double value : found.run.column(column)) count += std::isnan(value);
  return count;
}

bool is_one_of(int i, int every, int length) { return i % every > 40 && i % every <= 40 + length; }

}  // namespace

TEST_CASE("a number that stands for no value is none, whichever it is, and is told once") {
  for (const double mark :
       {-9999.0, -999.25, 9999.0, -999.0, -99.0, 32767.0, -32768.0, 65535.0, 2147483647.0, 1e30, -1.0, 0.0, 7777.5}) {
    CAPTURE(mark);
    const Understood found = changed([&](int i, Values& values) {
      if (is_one_of(i, 97, 1)) values.p1_bar = mark;
    });
    CHECK(lacking(found, "p1_port_Pa") == 31);
    CHECK(lacking(found, "p2_port_Pa") == 0);
    CHECK_THAT(found.told, Contains(fmt::format("{:.10g} stands in 31 samples of p1_bar", mark)));
  }
}

TEST_CASE("marks may stand in runs, at the ends, in whole rows and in the command") {
  const auto mark_p2 = [](double& value) { value = -9999; };
  const Understood runs = changed([&](int i, Values& values) {
    if (is_one_of(i, 500, 30)) mark_p2(values.p2_bar);
  });
  CHECK(lacking(runs, "p2_port_Pa") == 180);
  const Understood ends = changed([&](int i, Values& values) {
    if (i < 50 || i >= row_count - 20) mark_p2(values.p2_bar);
  });
  CHECK(lacking(ends, "p2_port_Pa") == 70);
  const Understood whole = changed([&](int i, Values& values) {
    if (is_one_of(i, 211, 3)) values = {-9999, -9999, -9999, -9999};
  });
  for (const char* column : {"x_m", "u_V", "p1_port_Pa", "p2_port_Pa"}) CHECK(lacking(whole, column) == 45);
  const Understood two = changed([&](int i, Values& values) {
    if (is_one_of(i, 211, 2)) values.x_mm = i % 2 == 0 ? -9999 : 32767;
  });
  CHECK(lacking(two, "x_m") == 30);
  const Understood many = changed([&](int i, Values& values) {
    if (i % 5 == 0) values.p1_bar = -9999;
  });
  CHECK(lacking(many, "p1_port_Pa") == row_count / 5);
}

TEST_CASE("what a machine does is no mark: stops, vents, switched commands, clipped and frozen sensors") {
  const auto check_nothing = [](const char* what, const std::function<void(int, Values&)>& change) {
    CAPTURE(what);
    const Understood found = changed(change);
    for (const char* column : {"x_m", "u_V", "p1_port_Pa", "p2_port_Pa"}) CHECK(lacking(found, column) == 0);
    CHECK(found.told.empty());
  };
  check_nothing("as it is", [](int, Values&) {});
  check_nothing("vented", [](int i, Values& values) {
    const int since = i % 1000 - 500;
    if (since > 0) values.p1_bar = std::max(0.0, values.p1_bar - 0.02 * since);
  });
  check_nothing("end stop", [](int, Values& values) { values.x_mm = std::clamp(values.x_mm, -60.0, 60.0); });
  check_nothing("switched command", [](int i, Values& values) {
    values.u_V = i % 300 < 20 ? 10 : i % 300 > 200 && i % 300 < 215 ? -10 : 0;
  });
  check_nothing("command of 5 V",
                [](int i, Values& values) { values.u_V = i % 300 < 3 ? 10 : 5 + 0.001 * values.u_V; });
  check_nothing("clipped", [](int, Values& values) { values.p1_bar = std::min(5.0, values.p1_bar); });
  check_nothing("frozen", [](int i, Values& values) {
    if (i > 1000 && i < 2000) values.p1_bar = p1_bar_at(1000);
  });
  // A valve switches, the logger sees it a row earlier, and the pressures come to one exact level each.
  for (const double vented_bar : {0.0, 1.01})
    check_nothing("switched valve", [&](int i, Values& values) {
      values.u_V = (i + 1) / 200 % 2 == 0 ? 10 : 0;
      if (i / 200 % 2 != 0) values.p1_bar = vented_bar;
    });
  check_nothing("switched between two levels, one of them clipped", [](int i, Values& values) {
    values.u_V = (i + 1) / 200 % 2 == 0 ? 10 : 0;
    const bool is_filled = i / 200 % 2 == 0;
    values.p1_bar = is_filled ? 5 : 0.01 * std::fmod(i * 0.414214, 1.0);
    values.p2_bar = is_filled ? 0.01 : 6 + 0.001 * p2_bar_at(i);
  });
  check_nothing("supply off for a while", [](int i, Values& values) {
    if (i > 1000 && i < 1100) values.p2_bar = 1.01;
  });
  // Rows of a second: between them a side fills and vents, and the slider goes from stop to stop.
  check_nothing("slow rows", [](int i, Values& values) {
    const bool is_out = i / 10 % 2 == 0;
    values = {is_out ? 150.0 : 0.01 * (i % 2), is_out ? 10.0 : 0.0, is_out ? 6 + 0.01 * p1_bar_at(i) : 0.0,
              is_out ? 0.0 : 6 + 0.01 * p2_bar_at(i)};
  });
}

TEST_CASE("a single wrong value is no mark") {
  const Understood found = changed([](int i, Values& values) {
    if (i == 700) values.p1_bar = 99;
    if (i == 900) values.p1_bar = -80;
  });
  CHECK(lacking(found, "p1_port_Pa") == 0);
  CHECK(found.told.empty());
}
