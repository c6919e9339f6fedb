// V12: pressure step along the line: arrival, attenuation of the front, rise of the chamber, plateau.
#include "gas_rig.hpp"

using namespace verification;

namespace {
constexpr double step_Pa = 20.0, rise_s = 0.01;

struct Signal {
  std::vector<double> t, y;
};

// a) closed end, sharp step: pressure of the last cell over the step. Refined at a Courant number close to 1, where the
// leapfrog carries a front without dispersion.
Signal sharp_step(Resolution resolution, double L, double D_mm, bool wall_heat) {
  Line<double> line;
  line.configure(line_of(L, D_mm), nominal_air(), resolution == Resolution::normal ? 10 : 500);
  line.set_adiabatic(!wall_heat);
  line.reset(p_start, T_start);
  const double travel = L / std::sqrt(1.4 * 287.0 * T_start);
  const double h =
      resolution == Resolution::normal ? 1e-3 / substeps_of(line, 1e-3, 0.0) : 0.995 * travel / line.cells();
  line.set_time_step(h);
  Signal out;
  for (double t = h; t < 1.5 * travel; t += h) {
    // At the instant of the jump the pressure is the mean of before and after: half the impulse falls into the first
    // step.
    line.step_prescribed(p_start + (out.t.empty() ? 0.5 : 1.0) * step_Pa, closed_end(line));
    out.t.push_back(t), out.y.push_back((line.cell_pressure(line.cells() - 1) - p_start) / step_Pa);
  }
  return out;
}

// b) smooth step in 10 ms into line and chamber.
Signal smooth_step(double L, double D_mm, int cells, double period) {
  LineWithChamber<double> side;
  side.configure(line_of(L, D_mm), chamber_1(50.0), nominal_air(), cells);
  side.reset(p_start, T_start, half_stroke);
  Signal out{{0.0}, {0.0}};
  for (double t = 0.0; t < 18.0;) {
    const int n = side.begin_period(period);
    for (int i = 0; i < n; ++i) {
      const double z = std::min(1.0, t / rise_s);
      side.step_prescribed(p_start + step_Pa * z * z * z * (10.0 - 15.0 * z + 6.0 * z * z), half_stroke);
      t += side.step_s();
      out.t.push_back(t), out.y.push_back((side.chamber().pressure() - p_start) / step_Pa);
    }
  }
  return out;
}

// Time and height of the first maximum, by a parabola through the three samples around it.
std::pair<double, double> first_peak(const Signal& s) {
  const std::size_t end = static_cast<std::size_t>(std::upper_bound(s.t.begin(), s.t.end(), 1.0) - s.t.begin());
  const std::size_t i =
      static_cast<std::size_t>(std::max_element(s.y.begin() + 1, s.y.begin() + static_cast<long>(end)) - s.y.begin());
  const double a = 0.5 * (s.y[i + 1] - 2.0 * s.y[i] + s.y[i - 1]), b = 0.5 * (s.y[i + 1] - s.y[i - 1]);
  const double d = -b / (2.0 * a);
  return {s.t[i] + d * (s.t[i + 1] - s.t[i]), s.y[i] + 0.5 * b * d};
}

// Height right behind the first front: mean between 0.5 and 2 % of the travel time behind it.
double front_height(const Signal& s, double travel) {
  double sum = 0.0;
  int n = 0;
  for (std::size_t i = 0; i < s.t.size(); ++i)
    if (s.t[i] > 1.005 * travel && s.t[i] < 1.02 * travel) sum += s.y[i], ++n;
  return sum / n;
}

class Steps {
 public:
  explicit Steps(Resolution resolution) : resolution_(resolution) {}
  Answer operator()(const Check& check) {
    const double L = check.number("L_m"), D = check.number("D_mm"), travel = L / std::sqrt(1.4 * 287.0 * T_start);
    const std::string& q = check.quantity;
    if (check.is("part", "a")) {
      const Signal s = sharp_step(resolution_, L, D, !check.is("wall_heat", "off"));
      if (q == "arrival") return time_of_level(s.t, s.y, 1.0);
      if (q == "first_front_at_closed_end_over_step") return front_height(s, travel);
      throw std::runtime_error("quantity is unknown");
    }
    const auto with_cells = [&](int cells) { return number(check, smooth(L, D, cells)); };
    return resolution_ == Resolution::normal ? with_cells(10)
                                             : limit_of(with_cells(25), with_cells(50), with_cells(100));
  }

 private:
  // Step and cell length are refined together.
  const Signal& smooth(double L, double D, int cells) {
    const auto key = std::make_tuple(L, D, cells);
    auto found = smooth_.find(key);
    const double period = resolution_ == Resolution::normal ? 1e-3 : 5e-3 / cells;
    if (found == smooth_.end()) found = smooth_.emplace(key, smooth_step(L, D, cells, period)).first;
    return found->second;
  }
  static double number(const Check& check, const Signal& s) {
    const std::string& q = check.quantity;
    if (q == "time_to_level") return time_of_level(s.t, s.y, check.number("level"));
    if (q == "peak") return first_peak(s).second;
    if (q == "peak_time") return first_peak(s).first;
    if (q == "chamber_rise_over_step") return value_at(s.t, s.y, check.number("t_s"));
    if (q == "plateau") return s.y.back();
    throw std::runtime_error("quantity is unknown");
  }
  Resolution resolution_;
  std::map<std::tuple<double, double, int>, Signal> smooth_;
};
}  // namespace

TEST_CASE("V12 pressure step along the line", "[V12][long]") {
  Case v12("V12");
  v12.run(Resolution::normal, Steps(Resolution::normal));
  v12.run(Resolution::fine, Steps(Resolution::fine));
}
