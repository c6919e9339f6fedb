// V08: steady flow with friction: adiabatic (Fanno), isothermal and with the wall heat of the model.
#include "steady_line.hpp"

using namespace verification;

namespace {
class SteadyLines {
 public:
  explicit SteadyLines(Resolution resolution) : resolution_(resolution) {}
  Answer operator()(const Check& check) {
    return steady_number(resolution_, [&](int cells) { return number(check, of(check, cells)); });
  }

 private:
  static double number(const Check& check, const SteadyFlow& flow) {
    if (check.quantity == "mass_flow") return flow.mass_flow;
    if (check.quantity == "end_Mach") return flow.end_Mach;
    if (check.quantity == "end_temperature") return flow.end_temperature;
    if (check.quantity == "end_pressure") return flow.end_pressure;
    throw std::runtime_error("quantity is unknown");
  }
  const SteadyFlow& of(const Check& check, int cells) {
    const std::string heat = check.text("heat");
    const auto key = std::make_tuple(check.number("L_m"), check.number("D_mm"), check.number("p_1_Pa"),
                                     check.number("p_2_Pa"), heat, cells);
    const auto found = runs_.find(key);
    if (found != runs_.end()) return found->second;
    const double p_1 = check.number("p_1_Pa"), p_2 = check.number("p_2_Pa");
    Line<double> line;
    line.configure(line_of(std::get<0>(key), std::get<1>(key)), nominal_air(), cells);
    line.set_adiabatic(heat == "adiabatic");
    line.set_isothermal(heat == "isothermal");
    line.reset(p_2 < 0.5 * p_1 ? 0.5 * (p_1 + p_2) : p_2, T_start);
    return runs_.emplace(key, run_to_steady(line, p_2, [&] { return line.step_prescribed(p_1, {p_2, T_start}); }))
        .first->second;
  }
  Resolution resolution_;
  std::map<std::tuple<double, double, double, double, std::string, int>, SteadyFlow> runs_;
};
}  // namespace

TEST_CASE("V08 steady flow with friction", "[V08][long]") {
  Case v08("V08");
  v08.run(Resolution::normal, SteadyLines(Resolution::normal));
  v08.run(Resolution::fine, SteadyLines(Resolution::fine));
}
