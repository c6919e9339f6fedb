// V05: line with quasi-steady laminar friction: port pressure to chamber pressure, nine lines.
#include "transfer.hpp"

using namespace verification;

namespace {
class Responses {
 public:
  explicit Responses(Resolution resolution) : resolution_(resolution) {}
  Answer operator()(const Check& check) {
    const double L = check.number("L_m"), D = check.number("D_mm");
    const bool adiabatic = check.is("variant", "adiabatic");
    const auto key = std::make_tuple(L, D, adiabatic);
    auto found = runs_.find(key);
    if (found == runs_.end()) found = runs_.emplace(key, PulseResponse(resolution_, L, D, adiabatic)).first;
    const Complex H = found->second(check.number("frequency_Hz"));
    if (check.quantity == "gain") return std::abs(H);
    const double degrees = std::arg(H) * 180.0 / M_PI, expected = check.value.at(0);
    return degrees + 360.0 * std::round((expected - degrees) / 360.0);  // the branch of the expected value
  }

 private:
  Resolution resolution_;
  std::map<std::tuple<double, double, bool>, PulseResponse> runs_;
};
}  // namespace

TEST_CASE("V05 frequency response of nine lines", "[V05]") {
  Case v05("V05");
  if (!v05) return;
  v05.run(Resolution::normal, Responses(Resolution::normal));
  v05.run(Resolution::fine, Responses(Resolution::fine));
}
