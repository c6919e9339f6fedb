// V17: orifice and line in series, steady: flow and port pressure.
#include "steady_line.hpp"

using namespace verification;

namespace {
class Series {
 public:
  explicit Series(Resolution resolution) : resolution_(resolution) {}
  Answer operator()(const Check& check) {
    return steady_number(resolution_, [&](int cells) { return number(check, of(check, cells)); });
  }

 private:
  static double number(const Check& check, const SteadyFlow& flow) {
    if (check.quantity == "mass_flow") return std::fabs(flow.mass_flow);
    if (check.quantity == "port_pressure") return flow.port_pressure;
    throw std::runtime_error("quantity is unknown");
  }
  const SteadyFlow& of(const Check& check, int cells) {
    const bool charge = check.is("direction", "charge");
    const auto key = std::make_tuple(check.number("L_m"), check.number("D_mm"), check.number("S_m2"), charge, cells);
    const auto found = runs_.find(key);
    if (found != runs_.end()) return found->second;
    Line<double> line;
    line.configure(line_of(std::get<0>(key), std::get<1>(key)), nominal_air(), cells);
    line.reset(p_start, T_start);
    const double S = std::get<2>(key);
    const ValvePort<double> port{charge ? S : 0.0, charge ? 0.0 : S, 700e3, 0.35};
    return runs_.emplace(key, run_to_steady(line, p_start, [&] { return line.step_valve(port, {p_start, T_start}); }))
        .first->second;
  }
  Resolution resolution_;
  std::map<std::tuple<double, double, double, bool, int>, SteadyFlow> runs_;
};
}  // namespace

TEST_CASE("V17 orifice and line in series", "[V17]") {
  Case v17("V17");
  v17.run(Resolution::normal, Series(Resolution::normal));
  v17.run(Resolution::fine, Series(Resolution::fine));
}
