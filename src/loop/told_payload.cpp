// Which payload the supervision tells, from the config's own simulation.
#include "loop/told_payload.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "loop/trial_motion.hpp"

namespace pneuservo {
namespace {

constexpr double first_off_m = 1e-3;     // from here on the time counts
constexpr int instants = 8;              // before the start, and seven of the reference: a sine's phases
constexpr double lightest_share = 0.1;   // of the moving mass: what weighs less moves as without it
constexpr double heaviest_share = 100.0;  // what weighs more hardly moves

/// 1, 2, 5, 10, ... within the range.
std::vector<double> preferred_numbers(double from, double to) {
  std::vector<double> out;
  for (double decade = std::pow(10.0, std::floor(std::log10(from))); decade <= to; decade *= 10.0)
    for (const double digit : {1.0, 2.0, 5.0})
      if (digit * decade > from && digit * decade <= to) out.push_back(digit * decade);
  return out;
}

/// One machine that gets its payload at an instant.
struct Carrier {
  MotionTwin axis;
  MotionSupervision supervision;
  std::int64_t from_tick = 0, off_tick = -1, fault_tick = -1;
  double off_m = 0.0;
};

void look(Carrier& carrier, const MotionTwin& prediction, double reference_m, std::int64_t tick) {
  const double off_m = std::fabs(carrier.axis.position_m() - prediction.position_m());
  if (tick >= carrier.from_tick && carrier.off_tick < 0 && off_m > first_off_m) carrier.off_tick = tick;
  const std::uint64_t faults = carrier.supervision.check({.position_m = carrier.axis.position_m(),
                                                          .predicted_m = prediction.position_m(),
                                                          .reference_m = reference_m,
                                                          .speed_mps = carrier.axis.speed_mps(),
                                                          .predicted_mps = prediction.velocity_mps(),
                                                          .force_N = carrier.axis.force_N()});
  if (faults == 0 || tick < carrier.from_tick) return;
  carrier.fault_tick = tick;
  carrier.off_m = off_m;
}

std::vector<Carrier> carriers(const Rig& rig, const TrialMotion& motion, const MotionPrediction& prediction) {
  Carrier carrier{prediction.twin, {}};
  carrier.axis.set_machine(rig, rig.axis, MotionTwin::simulated_cells(rig));
  carrier.supervision.configure(prediction.limits, rig.period_s);
  start_at(carrier.axis, rig, motion.start_m);
  std::vector<Carrier> out(instants, carrier);
  const std::int64_t half = (motion.last_tick - motion.reference_tick) / 2;
  for (int i = 1; i < instants; ++i)
    out[static_cast<std::size_t>(i)].from_tick = motion.reference_tick + half * i / instants;
  return out;
}

ToldPayload told(const Rig& rig, const TrialMotion& motion, const MotionPrediction& found, double payload_kg) {
  std::vector<Carrier> all = carriers(rig, motion, found);
  MotionTwin prediction = found.twin;
  start_at(prediction, rig, motion.start_m);
  AxisParameters<double> loaded = rig.axis;
  loaded.slider.payload_kg += payload_kg;
  const double supply_Pa = rig.axis.supply.pressure_Pa;
  std::size_t going = all.size();
  for (std::int64_t tick = 0; tick < motion.last_tick && going > 0; ++tick) {
    const ControlInput in = motion.at(tick);
    double most_V = MotionLimits::unlimited;
    going = 0;
    for (Carrier& carrier : all) {
      if (carrier.fault_tick >= 0) continue;
      ++going;
      if (tick == carrier.from_tick) carrier.axis.load(loaded);
      look(carrier, prediction, in.now.d[0], tick);
      most_V = carrier.supervision.most_command_V();
      carrier.axis.step(in, supply_Pa, most_V);
    }
    prediction.step(in, supply_Pa, most_V);
  }
  ToldPayload out{payload_kg, 0.0};
  for (const Carrier& carrier : all) {
    if (carrier.fault_tick < 0) return {payload_kg, std::nullopt};
    const std::int64_t off_tick = carrier.off_tick < 0 ? carrier.fault_tick : carrier.off_tick;
    out.after_s = std::max(*out.after_s, rig.period_s * static_cast<double>(carrier.fault_tick - off_tick));
    out.off_m = std::max(out.off_m, carrier.off_m);
  }
  return out;
}

}  // namespace

std::vector<ToldPayload> told_payloads(const Rig& rig, const Reference& reference, const MotionPrediction& prediction) {
  const auto& slider = rig.axis.slider;
  const double moving_kg = slider.mass_kg + slider.payload_kg;
  const double permitted_kg = rig.limits.payload_max_kg.value_or(0.0) - slider.payload_kg;
  const TrialMotion motion(rig, reference, prediction.twin);
  std::vector<ToldPayload> out;
  for (const double payload_kg :
       preferred_numbers(std::max(lightest_share * moving_kg, permitted_kg), heaviest_share * moving_kg))
    out.push_back(told(rig, motion, prediction, payload_kg));
  return out;
}

}  // namespace pneuservo
