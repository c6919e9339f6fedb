// The command pass: the command along a known reference, learned on the config's own model (docs/physics/command_pass.md).
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/control/pass_table.hpp>
#include <pneuservo/control/reference.hpp>
#include <pneuservo/rig/rig.hpp>

#include "pass/led_axis.hpp"

namespace pneuservo {

/// What came out of the learning.
struct CommandPass {
  std::vector<LedTick> ticks;            ///< from the reference's time 0 to the end of the run
  double largest_command_V = 0.0;
  double limited_share = 0.0;            ///< of the ticks at the largest command
  double left_N = 0.0;                   ///< largest force that the chambers do not give, dry friction's turning aside
  std::size_t runs = 0;                  ///< of the model
  bool feasible = false;

  /// As the law's pressures show them: by the estimator where the law has it (else the chambers themselves).
  std::shared_ptr<const PassTable> table(const Rig& rig, bool by_estimator) const;
};

/// A force that is missing makes an error of its part of the position gain; of the nine lines' 7 to 40 N/mm these are
/// 0.05 to 0.3 mm.
inline constexpr double most_left_N = 2.0;

/// Learns along the whole reference, or along a slower or smaller one. Cold: some 20 runs of the model. Throws
/// std::invalid_argument for a rig without a five-port valve and for a reference of kind `live`.
CommandPass make_command_pass(const Rig& rig, const Reference& reference, const MotionScale& scale = {});

/// What the line can do instead of a reference that is not feasible; a sentence. Cold: some ten passes.
std::string refusal(const Rig& rig, const Reference& reference, const CommandPass& pass);

/// The tables for a loop and for its prediction; null where the law asks for none.
struct PassTables {
  std::shared_ptr<const PassTable> law, prediction;
};
/// Throws std::invalid_argument with a sentence where the law asks for a pass and there is none.
PassTables pass_tables(const Rig& rig, const Reference& reference);

/// Largest distance of the simulated closed loop from the reference, on the pass's own model without noise [m].
double predicted_error_m(const Rig& rig, const Reference& reference, const CommandPass& pass);

}  // namespace pneuservo
