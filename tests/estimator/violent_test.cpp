// Violent cases: nine lines in six scenarios (start, reversal, telegraph, measured jump, slam, drop-out), 4 s each.
// Every pressure and temperature must stay physical and the gas must be booked to rounding.
#include <catch2/catch.hpp>

#include <cstdlib>
#include <limits>

#include <pneuservo/core/random.hpp>
#include <pneuservo/estimator/pipeline_estimator.hpp>
#include <pneuservo/rig/plant.hpp>

using namespace pneuservo;

namespace {
constexpr double p_atm = 101325.0, p_supply = 700e3;
constexpr std::uint64_t seed = 54;

AxisParameters<double> axis_of(double L, double D, double viscous) {
  AxisParameters<double> axis;
  axis.supply.pressure_Pa = p_supply;
  axis.valve = {5.0, 2.6e-6, 1.3e-5, 0.35};
  axis.line_1 = axis.line_2 = {L, D};
  axis.cylinder = {0.3, 1.257e-3, 1.056e-3, 2e-5, 2e-5, 50.0};
  axis.slider.mass_kg = 2.0;
  axis.slider.viscous_friction_Ns_per_m = viscous;
  return axis;
}

// Collects what every state of lines and chambers has been.
struct Extremes {
  double p_low = 1e9, p_high = 0.0, T_low = 1e9, T_high = 0.0;
  bool finite = true;
  template <class S> void look(const LineWithChamber<S>& sides, int lanes) {
    const auto see = [&](const S& p, const S& T) {
      for (int i = 0; i < lanes; ++i) {
        const double pressure = lane(p, i), temperature = lane(T, i);
        finite = finite && std::isfinite(pressure) && std::isfinite(temperature);
        p_low = std::min(p_low, pressure), p_high = std::max(p_high, pressure);
        T_low = std::min(T_low, temperature), T_high = std::max(T_high, temperature);
      }
    };
    for (int i = 0; i < sides.line().cells(); ++i) see(sides.line().cell_pressure(i), sides.line().cell_temperature(i));
    see(sides.chamber().pressure(), sides.chamber().temperature());
  }
  void judge(double highest) const {
    CHECK(finite);
    CHECK(p_low >= 0.3 * p_atm);
    CHECK(p_high <= highest);
    CHECK(T_low >= 150.0);
    CHECK(T_high <= 600.0);
  }
};

// The sides of a plant stepped so that the flow of every sub-step is booked: the plant's own step() with its sub-steps
// as the period, since flow() is that of the last sub-step.
struct PlantRun {
  AxisPlant<double> plant;
  double booked[2]{}, start[2]{}, period = 1e-3;
  int per_ms = 1;
  Extremes extremes;

  PlantRun(const AxisParameters<double>& axis, double cells_per_m, double p_start) {
    plant.configure(axis, 1e-3, cells_per_m);
    plant.reset({0.0, p_start, p_start});
    per_ms = std::max(plant.sides().begin_period(1e-3), 1) * 2;  // room for the flow's own speed
    period = 1e-3 / per_ms;
    plant.configure(axis, period, cells_per_m);
    plant.reset({0.0, p_start, p_start});
    for (int i = 0; i < 2; ++i) start[i] = mass(i);
  }
  double mass(int i) const { return lane(plant.sides().line().mass() + plant.sides().chamber().mass(), i); }
  void millisecond(double command) {
    for (int k = 0; k < per_ms; ++k) {
      plant.step(command);
      REQUIRE(plant.sides().step_s() == period);  // one sub-step: flow() has told all
      for (int i = 0; i < 2; ++i) booked[i] += period * lane(plant.flow().port_mass_flow_kgps, i);
    }
    extremes.look(plant.sides(), 2);
  }
  void judge() const {
    extremes.judge(1.5 * p_supply);
    for (int i = 0; i < 2; ++i) CHECK(std::fabs(mass(i) - start[i] - booked[i]) <= 1e-12 * std::max(start[i], mass(i)));
  }
};

double telegraph(Random& random, int k, double& sign) {
  if (random.uniform() < 0.03) sign = -sign;
  const double amplitude = random.uniform();
  return sign * ((k / 500) % 2 == 0 ? amplitude : 1.0) * 5.0;
}

void run_plant(int scenario, double L, double D, double cells_per_m, int milliseconds) {
  PlantRun run(axis_of(L, D, scenario == 5 ? 5.0 : 60.0), cells_per_m, scenario == 1 ? p_atm : 470e3);
  Random random(seed, static_cast<std::uint64_t>(L * 1000 + D * 1e6));
  double sign = 1.0;
  for (int k = 0; k < milliseconds; ++k) {
    const double command = scenario == 1   ? 5.0
                           : scenario == 2 ? ((k / 20) % 2 ? -5.0 : 5.0)
                           : scenario == 3 ? telegraph(random, k, sign)
                                           : ((k / 1000) % 2 ? -5.0 : 5.0);
    run.millisecond(command);
  }
  CAPTURE(run.extremes.p_low, run.extremes.p_high, run.extremes.T_low, run.extremes.T_high);
  run.judge();
}

EstimatorInput jump(int k, Random& random) {
  const bool high_1 = (k / 150) % 2 == 0;
  const double a = (high_1 ? 700e3 : 100e3) + 1e3 * random.normal(),
               b = (high_1 ? 100e3 : 700e3) + 1e3 * random.normal();
  const double w = 2.0 * M_PI, t = k * 1e-3;
  return {a, b, 0.08 * std::sin(w * t), 0.08 * w * std::cos(w * t)};
}
EstimatorInput drop_out(int k) {
  const double w = 2.0 * M_PI, t = k * 1e-3, nan = std::numeric_limits<double>::quiet_NaN();
  EstimatorInput in{470e3 + 100e3 * std::sin(w * t), 470e3 - 100e3 * std::sin(w * t), 0.08 * std::sin(w * t),
                    0.08 * w * std::cos(w * t)};
  switch ((k % 400) / 50) {
    case 2: in.p1_port_Pa = 0.0; break;
    case 3: in.x_m = nan; break;
    case 4: in.p2_port_Pa = nan; break;
    case 6: in.p1_port_Pa = in.p2_port_Pa = 1e9; break;
    case 7: in.x_m = 0.0; break;
    default: break;
  }
  return in;
}

// The estimator with its input guards: states and outputs. Its gas is booked in the case below it.
void run_estimator(int scenario, double L, double D, double cells_per_m, int milliseconds) {
  const AxisParameters<double> axis = axis_of(L, D, 60.0);
  EstimatorParameters parameters;
  parameters.supply_pressure_Pa = p_supply;
  parameters.line_1 = parameters.line_2 = axis.line_1;
  parameters.cylinder = axis.cylinder;
  parameters.cells_per_m = cells_per_m;
  PipelineEstimator estimator;
  estimator.configure(parameters);
  estimator.start(470e3, 470e3, 0.0);
  Random random(seed, 4);
  Extremes extremes;
  for (int k = 0; k < milliseconds; ++k) {
    const EstimatorOutput out = estimator.step(scenario == 4 ? jump(k, random) : drop_out(k));
    REQUIRE(std::isfinite(out.chamber_pressure_Pa[0] + out.chamber_pressure_Pa[1] + out.error_bound_Pa.sum()));
    extremes.look(estimator.axis().side(), 2);
  }
  CAPTURE(extremes.p_low, extremes.p_high, extremes.T_low, extremes.T_high);
  extremes.judge((scenario == 4 && cells_per_m > 1.0 ? 2.0 : 1.5) * p_supply);
}

// Gas of a line with chamber under the jumps of S4, every sub-step booked, guards acting.
void book_jumps(double L, double D, double cells_per_m, int milliseconds) {
  LineWithChamber<double> side;
  const LineParameters<double> line{L, D};
  side.configure(line, {1.257e-3, 2e-5, 50.0}, {}, cell_count(L, cells_per_m));
  side.reset(470e3, 293.0, 0.15);
  const double start = side.line().mass() + side.chamber().mass();
  Random random(seed, 4);
  double booked = 0.0, largest = start, before = 470e3, x = 0.0;
  for (int k = 0; k < milliseconds; ++k) {
    const EstimatorInput in = jump(k, random);
    const int n = side.begin_period(1e-3);
    for (int i = 0; i < n; ++i) {
      const double middle = (i + 0.5) / n, end = (i + 1.0) / n;
      const LineFlow<double> flow =
          side.step_prescribed(before + middle * (in.p1_port_Pa - before), 0.15 + x + end * (in.x_m - x));
      booked += side.step_s() * flow.port_mass_flow_kgps;
    }
    before = in.p1_port_Pa, x = in.x_m;
    largest = std::max(largest, side.line().mass() + side.chamber().mass());
  }
  CHECK(std::fabs(side.line().mass() + side.chamber().mass() - start - booked) <= 1e-12 * largest);
}

void all_cases(double cells_per_m, int milliseconds) {
  INFO("seed " << seed << ", " << cells_per_m << " cells/m, " << milliseconds << " ms");
  for (const double D : {4.15e-3, 6.10e-3, 7.65e-3})
    for (const double L : {2.0, 5.0, 10.0}) {
      for (const int scenario : {1, 2, 3, 5}) {
        CAPTURE(scenario, L, D);
        run_plant(scenario, L, D, cells_per_m, milliseconds);
      }
      for (const int scenario : {4, 6}) {
        CAPTURE(scenario, L, D);
        run_estimator(scenario, L, D, cells_per_m, milliseconds);
      }
      book_jumps(L, D, cells_per_m, milliseconds);
    }
}
}  // namespace

TEST_CASE("54 violent cases at 1 cell/m, 4 s") { all_cases(1.0, 4000); }

TEST_CASE("54 violent cases at 10 cells/m, 4 s", "[optimised]") { all_cases(10.0, 4000); }

// On 20 cells a metre a prescribed jump of 600 kPa (S4) empties cells down to the density floor: finite, but no longer
// mass-conserving; a port pressure sampled once a millisecond is no boundary for such a grid.
TEST_CASE("54 violent cases at 0.5, 2 and 4 cells/m, 4 s", "[long]") {
  if (!std::getenv("PNEUSERVO_LONG")) {
    WARN("SKIPPED: a long test; set PNEUSERVO_LONG=1");
    return;
  }
  for (const double cells_per_m : {0.5, 2.0, 4.0}) all_cases(cells_per_m, 4000);
}
