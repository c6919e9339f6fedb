// V06: frequency response, first pole and resonance of a line with laminar layers (losses with memory), and of the
// plain model.
#include "transfer.hpp"

using namespace verification;

namespace {
class Lines {
 public:
  explicit Lines(Resolution resolution) : resolution_(resolution) {}
  Answer operator()(const Check& check) {
    const Measured& line = measured(check.number("L_m"), check.number("D_mm"), !check.is("theory", "model"));
    if (check.quantity == "first_pole_frequency") return std::abs(line.pole) / (2.0 * M_PI);
    if (check.quantity == "first_pole_damping") return -line.pole.real() / std::abs(line.pole);
    if (check.quantity == "peak_gain") return line.peak_gain;
    const Complex H = line.response(check.number("frequency_Hz"));
    if (check.quantity == "gain") return std::abs(H);
    if (check.quantity != "phase") throw std::runtime_error("quantity is unknown");
    const double degrees = std::arg(H) * 180.0 / M_PI, expected = check.value.at(0);
    return degrees + 360.0 * std::round((expected - degrees) / 360.0);  // the branch of the expected value
  }

 private:
  struct Measured {
    PulseResponse response;
    Complex pole;
    double peak_gain;
  };
  const Measured& measured(double L, double D_mm, bool with_memory) {
    const auto key = std::make_tuple(L, D_mm, with_memory);
    const auto found = runs_.find(key);
    if (found != runs_.end()) return found->second;
    PulseResponse response(resolution_, L, D_mm, false, with_memory);
    double best = 1.0;
    for (double f = 1.0; f < 25.0; f *= 1.05)
      if (std::abs(response(f)) > std::abs(response(best))) best = f;
    const double peak = response.peak_frequency(best / 1.08, best * 1.08);
    const Complex pole = response.pole(peak);
    const double gain = std::abs(response(peak));
    return runs_.emplace(key, Measured{std::move(response), pole, gain}).first->second;
  }
  Resolution resolution_;
  std::map<std::tuple<double, double, bool>, Measured> runs_;
};
}  // namespace

TEST_CASE("V06 line with laminar layers, and first resonance of the plain model", "[V06][long]") {
  Case v06("V06", {"frequency_dependent"});
  v06.run(Resolution::normal, Lines(Resolution::normal));
  v06.run(Resolution::fine, Lines(Resolution::fine));
}
