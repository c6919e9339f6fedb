// Figures of the servo table under the flatness law: true and wrong parameters, learning, leaks, ways
// (docs/physics/flatness.md, docs/figures.md). The plan has 4 cells a line, the plant 32.
#include <catch2/catch.hpp>

#include <cstdio>
#include <functional>
#include <string>

#include "figures/servo_table_trial.hpp"

using namespace pneuservo;
using namespace pneuservo::figures;

namespace {
constexpr double um = 1e-6;
const std::array<test::TableCase, 2> both{test::table_4mm, test::table_8mm};

TableTrial printed(const test::TableCase& one) {
  TableTrial trial(one, table_move(), 140e3);
  trial.cells_per_m = 32.0 / one.length_m;
  return trial;
}
/// The printed move's speed with a ramp of 0.3 s.
TableTrial middle(const test::TableCase& one) {
  TableTrial trial(one, table_move(0.1, 0.3), 110e3);
  trial.cells_per_m = 32.0 / one.length_m;
  return trial;
}
TableTrial gentle(const test::TableCase& one) {
  TableTrial trial(one, gentle_move(), 110e3);
  trial.cells_per_m = 32.0 / one.length_m;
  return trial;
}
double max_error_um(const TableTrial& trial) { return TableRunner(trial).move().max_error_m / um; }

void believe_area_3_percent_too_large(TableTrial& trial) { trial.real.valve.area_per_volt_m2_per_V /= 1.03; }

/// All of design note 4.2 at once, each in the direction that adds to the others.
void get_seven_parameters_wrong(TableTrial& trial) {
  AxisParameters<double>& real = trial.real;
  believe_area_3_percent_too_large(trial);
  trial.valve_2_factor = 0.97;
  real.cylinder.wall_heat_W_per_m2K = 40.0;
  real.slider.mass_kg *= 1.01;
  const double volume =
      0.02 * (real.cylinder.dead_volume_1_m3 + real.cylinder.area_1_m2 * 0.5 * real.cylinder.stroke_m);
  real.cylinder.dead_volume_1_m3 += volume;
  real.cylinder.dead_volume_2_m3 += volume;
  real.line_1.diameter_m *= 1.02;
  real.line_2.diameter_m *= 1.02;
  real.supply.pressure_Pa *= 1.005;
  trial.port_noise_Pa = 300.0;
  trial.port_quantum_Pa = 100.0;
  trial.integral_gain_V_per_m_s = 1e4;
}

enum class Teach { nothing, flow, area };

/// One row of the table in docs/physics/flatness.md: 4 mm / 8 mm on the three moves, each as often as said.
void print_row(const char* what, const std::function<void(TableTrial&)>& change, int moves = 1,
               Teach teach = Teach::nothing) {
  std::printf("| %s |", what);
  for (auto* const trial_of : {&gentle, &middle, &printed}) {
    for (const auto& one : both) {
      TableTrial trial = trial_of(one);
      change(trial);
      TableRunner runner(trial);
      for (int move = 1; move <= moves; ++move) {
        std::printf("%s%.4f", move > 1 ? ", " : " ", runner.move().max_error_m / um);
        if (teach == Teach::flow) runner.law().learn_flow(trial.believed);
        if (teach == Teach::area) runner.law().learn_area(trial.believed);
      }
      std::printf("%s", one.name == both[0].name ? " /" : " |");
    }
  }
  std::printf("\n");
}
}  // namespace

TEST_CASE("servo table: print the table of figures", "[.table]") {
  const auto same = [](TableTrial&) {};
  print_row("true parameters", same);
  print_row("inverse of the linear model, 5th order, 110 kPa at the start", [](TableTrial& t) {
    t.linear_order = 5;
    t.start_deviation_Pa = 110e3 - t.plan.mean_pressure_Pa;
  });
  print_row("area 3 % too large", believe_area_3_percent_too_large);
  print_row("the same with K_i = 1e4 V/(m s)", [](TableTrial& t) {
    believe_area_3_percent_too_large(t);
    t.integral_gain_V_per_m_s = 1e4;
  });
  print_row("area 3 % too large, flow learned: moves 1 to 4", believe_area_3_percent_too_large, 4, Teach::flow);
  print_row("area 3 % too large, area learned: moves 1 to 3", believe_area_3_percent_too_large, 3, Teach::area);
  print_row("seven wrong, flow learned: moves 1 to 4", get_seven_parameters_wrong, 4, Teach::flow);
  print_row("seven wrong, area learned: moves 1 to 3", get_seven_parameters_wrong, 3, Teach::area);
  print_row("wall heat 40 for 50 W/(m2 K)", [](TableTrial& t) { t.real.cylinder.wall_heat_W_per_m2K = 40.0; });
  print_row("mass 1 % off", [](TableTrial& t) { t.real.slider.mass_kg *= 1.01; });
  print_row("2 kPa too much at the start, K_i", [](TableTrial& t) {
    t.start_deviation_Pa = 2e3;
    t.integral_gain_V_per_m_s = 1e4;
  });
  print_row("port sensors 300 Pa rms, 100 Pa", [](TableTrial& t) {
    t.port_noise_Pa = 300.0;
    t.port_quantum_Pa = 100.0;
  });
  print_row("spool resolution 0.27 mV", [](TableTrial& t) { t.command_quantum_V = 0.27e-3; });
  for (const double way_m : {0.02, 0.05, 0.07}) {
    const std::string what = std::to_string(std::lround(1e3 * way_m)) + " mm, true parameters";
    print_row(what.c_str(), [&](TableTrial& t) {
      const bool slow = t.reference.kind == ReferenceKind::waypoints;
      t.reference = slow ? gentle_move(way_m) : table_move(way_m, t.reference.ramp_s);
    });
  }
}

TEST_CASE("servo table: print the moves with seven parameters wrong", "[.seven]") {
  for (const auto& one : both) {
    TableTrial trial = printed(one);
    get_seven_parameters_wrong(trial);
    TableRunner runner(trial);
    for (int move = 1; move <= 4; ++move) {
      if (move > 1) runner.law().learn_flow(trial.believed);
      std::printf("{\"line\": \"%s\", \"move\": %d, \"error_um\": %.6g}\n", one.name, move,
                  runner.move().max_error_m / um);
    }
  }
}

TEST_CASE("servo table: flatness with true parameters keeps the printed move within 0.3 um, the gentle one 0.01 um") {
  for (const auto& one : both) {
    CAPTURE(one.name);
    CHECK(max_error_um(printed(one)) < 0.3);
    CHECK(max_error_um(gentle(one)) < 0.01);
  }
}

TEST_CASE("servo table: the plant is converged in cells and sub-steps") {
  for (const auto& one : both) {
    TableTrial coarse = printed(one), fine = printed(one);
    coarse.cells_per_m = 16.0 / one.length_m;
    fine.cells_per_m = 48.0 / one.length_m;
    fine.refine = 2;
    CAPTURE(one.name);
    CHECK(max_error_um(coarse) == Approx(max_error_um(fine)).margin(0.03));
  }
}

TEST_CASE("servo table: the inverse of the linear model leaves what the design note says") {
  const std::array<double, 2> expected{121.0, 64.0};
  for (std::size_t i = 0; i < 2; ++i) {
    TableTrial trial = printed(both[i]);
    trial.linear_order = 5;
    trial.start_deviation_Pa = -30e3;  // starts at 110 kPa
    CHECK(max_error_um(trial) == Approx(expected[i]).epsilon(0.02));
  }
}

TEST_CASE("servo table: shorter ways") {
  for (const auto& one : both)
    for (const double way_m : {0.02, 0.05, 0.07}) {
      TableTrial fast = printed(one), slow = gentle(one);
      fast.reference = table_move(way_m);
      slow.reference = gentle_move(way_m);
      CAPTURE(one.name, way_m);
      CHECK(max_error_um(fast) < 0.3);
      CHECK(max_error_um(slow) < 0.08);
    }
}

TEST_CASE("servo table: an area 3 % off is learned, as a flow for this move and as an area for others") {
  for (const auto& one : both) {
    TableTrial trial = printed(one);
    believe_area_3_percent_too_large(trial);
    TableRunner flow(trial), area(trial);
    CAPTURE(one.name);
    CHECK(flow.move().max_error_m / um == Approx(5.8).margin(0.3));
    flow.law().learn_flow(trial.believed);
    CHECK(flow.move().max_error_m / um < 0.6);
    flow.law().learn_flow(trial.believed);
    CHECK(flow.move().max_error_m / um < 0.1);
    area.move();
    area.law().learn_area(trial.believed);
    CHECK(area.law().area_factor() == Approx(1.0 / 1.03).epsilon(0.004));
    CHECK(area.move().max_error_m / um < 0.6);
    TableTrial slow = gentle(one);
    believe_area_3_percent_too_large(slow);
    slow.integral_gain_V_per_m_s = 1e4;
    CHECK(max_error_um(slow) < 0.3);
  }
}

TEST_CASE("servo table: seven parameters wrong at once and noisy port sensors, learned from the move") {
  for (const auto& one : both) {
    TableTrial trial = printed(one);
    get_seven_parameters_wrong(trial);
    TableRunner runner(trial);
    CAPTURE(one.name);
    CHECK(runner.move().max_error_m / um > 10.0);
    for (int move = 2; move <= 4; ++move) {
      runner.law().learn_flow(trial.believed);
      CHECK(runner.move().max_error_m / um < (move == 2 ? 1.0 : 0.1));
    }
  }
}

TEST_CASE("servo table: integral action takes out a leak of 1e-8 m2") {
  for (const auto& one : both) {
    TableTrial trial = gentle(one);
    trial.real.effects.chamber_leak_1.area_m2 = 1e-8;
    trial.port_noise_Pa = 300.0;
    trial.port_quantum_Pa = 100.0;
    CAPTURE(one.name);
    CHECK(std::fabs(TableRunner(trial).move().end_error_m / um) > 0.2);
    trial.integral_gain_V_per_m_s = 1e4;
    trial.after_s = 2.0;
    CHECK(std::fabs(TableRunner(trial).move().end_error_m / um) < 0.01);
  }
}

TEST_CASE("servo table: noisy port sensors and a coarse spool cost little, a wrong mean pressure is brought back") {
  for (const auto& one : both) {
    TableTrial noisy = gentle(one), coarse = gentle(one), wrong = gentle(one);
    noisy.port_noise_Pa = 300.0;
    noisy.port_quantum_Pa = 100.0;
    coarse.command_quantum_V = 0.27e-3;
    wrong.start_deviation_Pa = 2e3;
    wrong.integral_gain_V_per_m_s = 1e4;
    CAPTURE(one.name);
    CHECK(max_error_um(noisy) < 0.02);
    CHECK(max_error_um(coarse) < 0.1);
    const TableOutcome back = TableRunner(wrong).move();
    CHECK(back.max_error_m / um < 0.5);
    CHECK(back.mean_pressure_Pa == Approx(110e3).margin(20.0));
  }
}

TEST_CASE("servo table: flatness inverts lines that are lags of second order") {
  for (const auto& one : both) {
    TableTrial trial = printed(one);
    for (AxisParameters<double>* axis : {&trial.believed, &trial.real})
      for (LineParameters<double>* line : {&axis->line_1, &axis->line_2}) {
        line->model = LineModel::second_order_lag;
        line->natural_frequency_Hz = one.line.natural_frequency_rad_per_s / test::cycle_rad;
        line->damping_ratio = one.line.damping_ratio;
      }
    CAPTURE(one.name);
    CHECK(max_error_um(trial) < 0.3);
  }
}
