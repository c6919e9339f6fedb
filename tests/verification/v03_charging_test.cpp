// V03: charging of a chamber from a supply through an orifice.
#include "v02_v03_chamber.hpp"

using namespace verification;

namespace {
constexpr double p_supply = 700e3;

class Charging {
 public:
  explicit Charging(Resolution resolution) : resolution_(resolution) {}
  Answer operator()(const Check& check) {
    const std::string& q = check.quantity;
    if (q == "energy_residual") {
      double worst = 0.0;
      for (const double wall_heat : {0.0, 50.0, 5000.0})
        worst = std::max(worst, std::fabs(of(wall_heat, 101325.0, 2.0).energy_residual));
      return worst;
    }
    const double p_0 =
        !check.has("p_0_Pa") ? 101325.0 : std::max(check.number("p_0_Pa"), 10.0);  // 10 Pa: as good as empty
    const ChamberRun& run = of(wall_heat_of(check), p_0, 2.5);
    if (q == "pressure_rate_while_choked") return (value_at(run.t, run.p, 0.1) - value_at(run.t, run.p, 0.01)) / 0.09;
    if (q == "end_of_choked_flow") return time_of_level(run.t, run.p, 0.35 * p_supply);
    if (q == "start_of_linear_part") return time_of_level(run.t, run.p, check.number("p_Pa"));
    if (q == "pressure") return value_at(run.t, run.p, check.number("t_s"));
    if (q == "temperature") return value_at(run.t, run.T, check.number("t_s"));
    if (q == "heat_to_wall") return value_at(run.t, run.heat, check.number("t_s"));
    if (q == "temperature_when_full" || q == "limit_of_temperature_for_an_empty_chamber") return run.T.back();
    if (q == "mass_let_in_until_full") return run.m.back() - run.m.front();
    if (q == "heat_to_wall_until_full") return run.heat.back();
    throw std::runtime_error("quantity is unknown");
  }

 private:
  const ChamberRun& of(double wall_heat, double p_0, double end_s) {
    const auto key = std::make_tuple(wall_heat, p_0, end_s);
    const auto found = runs_.find(key);
    if (found != runs_.end()) return found->second;
    return runs_[key] = run_chamber(resolution_, wall_heat, p_0, p_supply, end_s);
  }
  Resolution resolution_;
  std::map<std::tuple<double, double, double>, ChamberRun> runs_;
};
}  // namespace

TEST_CASE("V03 charging of a chamber", "[V03]") {
  Case v03("V03");
  v03.run(Resolution::normal, Charging(Resolution::normal));
  v03.run(Resolution::fine, Charging(Resolution::fine));
}
