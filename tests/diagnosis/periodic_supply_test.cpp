// The sweep for a supply that swings: a sine between two frequencies at which the model is run, in recordings that
// begin at any time; the sine of no other frequency.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include "diagnosis/closed_form_model.hpp"
#include "diagnosis/residuals/periodic_supply.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

constexpr std::size_t swing_rows = 1000;
constexpr double swing_interval_s = 0.01, swing_lag_s = 0.1;  ///< ten seconds
constexpr double swing_Pa = 800;

/// What a port behind a lag reads of a swinging supply, since the recording's begin.
std::vector<double> lagged_swing(double amplitude_Pa, double frequency_Hz, double phase_rad) {
  const double turn = 2 * std::numbers::pi * frequency_Hz;
  std::vector<double> out;
  for (std::size_t k = 0; k < swing_rows; ++k)
    out.push_back(
        amplitude_Pa / std::hypot(1, turn * swing_lag_s) *
        std::sin(turn * swing_interval_s * static_cast<double>(k) + phase_rad - std::atan(turn * swing_lag_s)));
  return out;
}

/// Compares the swing of the rig's supply with a recorded one.
class SwingingModel final : public ClosedFormModel {
 public:
  SwingingModel(double recorded_Hz, double begin_s) : ClosedFormModel(against(recorded_Hz)) {
    for (std::size_t k = 0; k < swing_rows; ++k) rows_[k].time_s = begin_s + swing_interval_s * static_cast<double>(k);
  }

 private:
  static Residual against(double recorded_Hz) {
    return [recorded = lagged_swing(swing_Pa, recorded_Hz, 0.7)](const Rig& rig) {
      const auto& swing = rig.axis.effects.supply_swing;
      std::vector<double> rows = lagged_swing(swing.amplitude_Pa, swing.frequency_Hz, swing.phase_rad);
      for (std::size_t k = 0; k < swing_rows; ++k) rows[k] -= recorded[k];
      return rows;
    };
  }
};

}  // namespace

TEST_CASE("supply swing: found on and between the frequencies of the sweep, whenever the recording begins") {
  const double recorded_Hz = GENERATE(1.2, 1.25, 3.151, 7.049, 14.9), begin_s = GENERATE(0.0, 613.7);
  SwingingModel model(recorded_Hz, begin_s);
  FittedRows rows(model, {});
  const auto swing = strongest_supply_swing(rows, {});
  REQUIRE(swing);
  CHECK(std::abs(swing->frequency_Hz - recorded_Hz) < 0.01);  // a sixth of what ten seconds resolve is 0.017
  CHECK(swing->share > 0.97);  // a twelfth of that away a sine loses 2 %
  CHECK(swing->amplitude_Pa == Approx(swing_Pa).epsilon(0.02));
  CHECK(swing->next_share < 0.1);
}
