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
    const double f = check.number("frequency_Hz");
    const auto H_with = [&](int cells) { return response(L, D, adiabatic, cells)(f); };
    const Complex H = resolution_ == Resolution::normal ? H_with(10) : limit_of(H_with(20), H_with(40), H_with(80));
    if (check.quantity == "gain") return std::abs(H);
    const double degrees = std::arg(H) * 180.0 / M_PI, expected = check.value.at(0);
    return degrees + 360.0 * std::round((expected - degrees) / 360.0);  // the branch of the expected value
  }

 private:
  // Step and cell length are refined together.
  const PulseResponse& response(double L, double D, bool adiabatic, int cells) {
    const auto key = std::make_tuple(L, D, adiabatic, cells);
    auto found = runs_.find(key);
    const double period = resolution_ == Resolution::normal ? 1e-3 : 2.5e-3 / cells;
    if (found == runs_.end()) found = runs_.emplace(key, PulseResponse(L, D, adiabatic, cells, period)).first;
    return found->second;
  }
  Resolution resolution_;
  std::map<std::tuple<double, double, bool, int>, PulseResponse> runs_;
};
}  // namespace

TEST_CASE("V05 frequency response of nine lines", "[V05][long]") {
  Case v05("V05");
  v05.run(Resolution::normal, Responses(Resolution::normal));
  v05.run(Resolution::fine, Responses(Resolution::fine));
}
