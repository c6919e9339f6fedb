// Channels with stamps of their own: each, or some together.
#include <cmath>
#include <limits>
#include <string>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "record/motion.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

constexpr double pi = 3.14159265358979;

/// A motion and a pressure of 20 Hz: half of a millisecond away they are 6 % of their swing elsewhere.
double position_m(double t) { return 0.1 * std::sin(2 * pi * 3 * t); }
double pressure_Pa(double t) { return 5e5 + 1e5 * std::sin(2 * pi * 20 * t); }
double command_V(double t) { return std::floor(20 * t); }

/// t1,x,t2,u,t3,p1: each so much later in its row.
std::string pairs(const char* names, double x_later, double u_later, double p_later, int p_each = 1) {
  std::string text = std::string(names) + "\n";
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.001 * i, tx = t + x_later, tu = t + u_later, tp = p_each * t + p_later;
    text += fmt::format("{:.6f},{:.9f},{:.6f},{:.3f},", tx, position_m(tx), tu, command_V(tu));
    text += p_each * i < 1000 ? fmt::format("{:.6f},{:.3f}\n", tp, pressure_Pa(tp)) : ",\n";
  }
  return text;
}

std::size_t count_of(const std::vector<double>& values) {
  std::size_t count = 0;
  for (const double value : values) count += std::isfinite(value);
  return count;
}

}  // namespace

TEST_CASE("channels whose stamps are skewed against each other come to the command's rows by interpolation") {
  for (const char* names :
       {"t1,x,t2,u,t3,p1", "Time_x [s],x [m],Time_u [s],u [V],Time_p1 [s],p1 [Pa]", "x_t,x,u_t,u,p1_t,p1",
        "Time,x,Time,u,Time,p1", "Time A (s),x (m),Time B (s),u (V),Time C (s),p1 (Pa)", "tx,x,tu,u,tp1,p1"}) {
    CAPTURE(names);
    const Understood found = understood(pairs(names, 0, 0.0004, 0.0007));
    const Recording& run = found.run;
    REQUIRE(run.rows() == 1000);
    CHECK(run.period_s == Approx(0.001));
    CHECK_THAT(found.told, Contains("times of its own") && Contains("those of u") && Contains("0.4 of a row"));
    const double first_s = run.t_s()[0];
    CHECK(first_s == Approx(0.0004));
    for (std::size_t i = 2; i + 2 < run.rows(); ++i) {
      const double t = run.t_s()[i];
      REQUIRE(run.column("u_V")[i] == command_V(t));
      REQUIRE(run.column("x_m")[i] == Approx(position_m(t)).margin(1e-7));
      REQUIRE(run.column("p1_port_Pa")[i] == Approx(pressure_Pa(t)).margin(5));
    }
  }
}

TEST_CASE("a channel of a slower rate keeps as many values as it has") {
  const Recording run = understood(pairs("t1,x,t2,u,t3,p1", 0, 0.0002, 0.0004, 4)).run;
  REQUIRE(run.rows() == 1000);
  const std::vector<double>& p = run.column("p1_port_Pa");
  CHECK(count_of(p) <= 250);
  CHECK(count_of(p) >= 248);
  for (std::size_t i = 8; i + 8 < run.rows(); ++i)
    if (std::isfinite(p[i])) REQUIRE(p[i] == Approx(pressure_Pa(run.t_s()[i])).margin(200));
}

TEST_CASE("a missing sample of one channel stays missing, and a gap of all stays a gap") {
  std::string text = "t1,x,t2,u\n";
  for (int i = 0; i < 1000; ++i) {
    if (i >= 500 && i < 600) continue;
    const double t = 0.001 * i, tu = t + 0.0003;
    const std::string x = i == 200 ? "," : fmt::format("{:.6f},{:.9f}", t, position_m(t));
    text += fmt::format("{},{:.6f},{:.3f}\n", x, tu, command_V(tu));
  }
  const Recording run = understood(text).run;
  REQUIRE(run.rows() == 900);
  CHECK(run.missing_rows == 100);
  CHECK(count_of(run.column("u_V")) == 900);
  CHECK(count_of(run.column("x_m")) >= 896);
  CHECK(std::isnan(run.column("x_m")[200]));
  CHECK(std::isfinite(run.column("x_m")[197]));
  CHECK(std::isfinite(run.column("x_m")[203]));
}

TEST_CASE("times of several columns each, numbered or of another length, and in other units") {
  std::string text = "Time_1 [ms],x [m],u [V],Time_2 [s],p1 [Pa],p2 [Pa]\n";
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.001 * i, tp = t + 0.0003;
    text += fmt::format("{:.3f},{:.9f},{:.3f},{:.6f},{:.3f},{:.3f}\n", 1e3 * t, position_m(t), command_V(t), tp,
                        pressure_Pa(tp), 1e6 - pressure_Pa(tp));
  }
  const Recording run = understood(text).run;
  REQUIRE(run.rows() == 1000);
  CHECK(run.t_s()[500] == Approx(0.5));
  CHECK(run.column("p1_port_Pa")[500] == Approx(pressure_Pa(0.5)).margin(5));
  CHECK(run.column("p2_port_Pa")[503] == Approx(1e6 - pressure_Pa(0.503)).margin(5));
}

TEST_CASE("a slow block of columns beside a fast one keeps its rate") {
  std::string text = "t_fast;x;u;t_slow;p1;p2\n";
  for (int i = 0; i < 1000; ++i)
    text += fmt::format("{:.3f};{:.9f};{:.3f};", 0.001 * i, position_m(0.001 * i), command_V(0.001 * i)) +
            (i < 100 ? fmt::format("{:.3f};{:.3f};{:.3f}\n", 0.01 * i, pressure_Pa(0.01 * i), 5e5) : ";;\n");
  const Recording run = understood(text).run;
  REQUIRE(run.rows() == 1000);
  CHECK(count_of(run.column("p1_port_Pa")) == 100);
  CHECK(run.column("p1_port_Pa")[370] == Approx(pressure_Pa(0.37)).margin(1e-3));
}

TEST_CASE("a command written when it changes stands up to its next stamp") {
  std::string text = "t1,x,t2,u\n";
  const double changes[] = {0, 0.0133, 0.1, 0.3207, 0.35, 0.61, 0.9};
  for (int i = 0; i < 1000; ++i)
    text += fmt::format("{:.6f},{:.9f},{}\n", 0.001 * i, position_m(0.001 * i),
                        i < 7 ? fmt::format("{:.6f},{}", changes[i], i + 1) : ",");
  const Recording run = understood(text).run;
  REQUIRE(run.rows() == 1000);
  CHECK(run.column("u_V")[5] == 1);
  CHECK(run.column("u_V")[50] == 2);
  CHECK(run.column("u_V")[250] == 3);
  CHECK(run.column("u_V")[600] == 5);
  CHECK(run.column("u_V")[700] == 6);
  CHECK(run.column("u_V")[950] == 7);
}

TEST_CASE("a stamp of the receiver beside that of the row is no time of other columns") {
  std::string text = "timestamp,x,u,recv_timestamp,p1\n", pair = "timestamp,x,recv_timestamp,p1\n";
  for (int i = 0; i < 1000; ++i)
    pair += fmt::format("{:.6f},{:.9f},{:.6f},{:.3f}\n", 0.001 * i, position_m(0.001 * i), 0.001 * i + 0.0005,
                        pressure_Pa(0.001 * i));
  CHECK(understood(pair).run.column("p1_port_Pa")[500] == Approx(pressure_Pa(0.5)).margin(1e-3));
  for (int i = 0; i < 1000; ++i)
    text += fmt::format("{:.6f},{:.9f},{:.3f},{:.6f},{:.3f}\n", 0.001 * i, position_m(0.001 * i), 1.0,
                        0.001 * i + 0.0005 + 1e-5 * (i % 7), pressure_Pa(0.001 * i));
  const Recording run = understood(text).run;
  REQUIRE(run.rows() == 1000);
  CHECK(run.column("p1_port_Pa")[500] == Approx(pressure_Pa(0.5)).margin(1e-3));
}
