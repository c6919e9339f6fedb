// V06: first pole and resonance of the plain model; the exact laminar layers need friction with memory.
#include "transfer.hpp"

using namespace verification;

namespace {
class Resonances {
 public:
  explicit Resonances(Resolution resolution) : resolution_(resolution) {}
  Answer operator()(const Check& check) {
    if (!check.is("theory", "model")) throw std::runtime_error("quantity is unknown");
    const auto key = std::make_tuple(check.number("L_m"), check.number("D_mm"));
    auto found = runs_.find(key);
    if (found == runs_.end()) found = runs_.emplace(key, measure(std::get<0>(key), std::get<1>(key))).first;
    if (check.quantity == "first_pole_frequency") return std::abs(found->second.pole) / (2.0 * M_PI);
    if (check.quantity == "first_pole_damping") return -found->second.pole.real() / std::abs(found->second.pole);
    if (check.quantity == "peak_gain") return found->second.gain;
    throw std::runtime_error("quantity is unknown");
  }

 private:
  struct Resonance {
    Complex pole;
    double gain;
  };
  Resonance measure(double L, double D_mm) const {
    const PulseResponse response(resolution_, L, D_mm, false);
    double best = 1.0;
    for (double f = 1.0; f < 25.0; f *= 1.05)
      if (std::abs(response(f)) > std::abs(response(best))) best = f;
    const double peak = response.peak_frequency(best / 1.08, best * 1.08);
    return {response.pole(peak), std::abs(response(peak))};
  }
  Resolution resolution_;
  std::map<std::tuple<double, double>, Resonance> runs_;
};
}  // namespace

TEST_CASE("V06 first resonance of the plain model", "[V06]") {
  Case v06("V06");
  if (!v06) return;
  v06.run(Resolution::normal, Resonances(Resolution::normal));
  v06.run(Resolution::fine, Resonances(Resolution::fine));
}
