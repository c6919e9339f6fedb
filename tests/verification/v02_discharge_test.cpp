// V02: discharge of a chamber through an orifice, isothermal, adiabatic and with wall heat.
#include "v02_v03_chamber.hpp"

using namespace verification;

namespace {
class Discharge {
 public:
  explicit Discharge(Resolution resolution) : resolution_(resolution) {}
  Answer operator()(const Check& check) {
    const Air<double> air{nominal_air()};
    if (check.quantity == "time_constant_tau")
      return chamber_1(0.0).volume_m3(2.0 * half_stroke) / (air.flow_constant * 2.6e-6 * std::sqrt(air.R * T_start));
    const ChamberRun& run = of(wall_heat_of(check));
    if (check.quantity == "end_of_choked_flow") return time_of_level(run.t, run.p, air.atmosphere_Pa / 0.35);
    if (check.quantity == "time_to_reach_pressure") return time_of_level(run.t, run.p, check.number("p_Pa"));
    if (check.quantity == "pressure") return value_at(run.t, run.p, check.number("t_s"));
    if (check.quantity == "temperature") return value_at(run.t, run.T, check.number("t_s"));
    if (check.quantity == "mass") return value_at(run.t, run.m, check.number("t_s"));
    const std::size_t coldest = static_cast<std::size_t>(std::min_element(run.T.begin(), run.T.end()) - run.T.begin());
    if (check.quantity == "lowest_temperature") return run.T[coldest];
    if (check.quantity == "time_of_lowest_temperature") return run.t[coldest];
    if (check.quantity == "temperature_when_pressure_equal") return run.T.back();
    throw std::runtime_error("quantity is unknown");
  }

 private:
  const ChamberRun& of(double wall_heat) {
    const auto found = runs_.find(wall_heat);
    if (found != runs_.end()) return found->second;
    return runs_[wall_heat] = run_chamber(resolution_, wall_heat, 700e3, 101325.0, 3.0);
  }
  Resolution resolution_;
  std::map<double, ChamberRun> runs_;
};
}  // namespace

TEST_CASE("V02 discharge of a chamber", "[V02]") {
  Case v02("V02");
  v02.run(Resolution::normal, Discharge(Resolution::normal));
  v02.run(Resolution::fine, Discharge(Resolution::fine));
}
