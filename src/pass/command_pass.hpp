// The command pass: the command along a known reference, learned on the config's own model
// (docs/physics/command_pass.md).
#pragma once
#include <functional>
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
  std::vector<LedTick> before;           ///< rest before the reference's time 0
  std::vector<LedTick> ticks;            ///< from the reference's time 0 to the end of the run
  double largest_command_V = 0.0;
  double limited_share = 0.0;            ///< of the ticks at the largest command
  double left_N = 0.0;                   ///< largest force below judged_Hz that the chambers do not give
  std::size_t runs = 0;                  ///< of the model
  std::size_t repeats = 1;               ///< ticks at the end that stand for all later ones
  bool feasible = false;

  /// As the law's pressures show them: by the estimator where the law has it (else the chambers themselves). The first
  /// row is the rest before the motion, for the law takes it on its way to the reference's start, too.
  std::shared_ptr<PassTable> table(const Rig& rig, bool by_estimator) const;
};

/// Four times what sensors with 300 Pa of noise make of the force (0.5 N rms); over the nine lines' position gains
/// of 7 to 40 N/mm it is 0.05 to 0.3 mm.
inline constexpr double most_left_N = 2.0;
/// A reversal of dry friction is faster than any line and costs 0.2 mm; what the learning should have taken is slower.
inline constexpr double judged_Hz = 12.0;

/// So many periods are learned within some seconds, which no signal ends. Of longer runs the part is learned after
/// which the reference rests, or its last period is repeated; where it does neither they are refused.
inline constexpr std::size_t most_pass_ticks = 60'000;

/// Asked before each run of the model; false: nobody waits any more.
using GoesOn = std::function<bool()>;

/// Learns along the whole reference, or along a slower or smaller one; not feasible where it shall not go on. Cold:
/// some 20 runs of the model. Throws std::invalid_argument for a rig without a five-port valve and for a run that is
/// too long and does not repeat.
CommandPass make_command_pass(const Rig& rig, const Reference& reference, const MotionScale& scale = {},
                              const GoesOn& goes_on = {});

/// What a sentence on a missing pass tells: what is missing, or what the lines can do instead, too, which takes as long
/// as eight passes.
enum class PassWords { short_words, full };
/// Why a loop does not follow this pass: the lines cannot carry it, or the loop errs by more than with the formula,
/// beyond what most_left_N makes. Empty where it does; a sentence without its full stop.
std::string refusal_words(const Rig& rig, const Reference& reference, const CommandPass& pass, PassWords words);

/// Position [m/V] in the ticks after one more volt for a period, in the closed loop of the config at rest at the
/// reference's start: linear, without dry friction and what the valve's path does to small commands. Cold: four seconds
/// of the model.
std::vector<double> closed_loop_response_m_per_V(const Rig& rig, const Reference& reference, const CommandPass& pass);

/// The tables for a loop and for its prediction; null where the law asks for none, without rows where they come with
/// the moves (reference of kind `live`).
struct PassTables {
  std::shared_ptr<const PassTable> law, prediction;
};
/// Throws std::invalid_argument with a sentence where the law asks for a pass and there is none.
PassTables pass_tables(const Rig& rig, const Reference& reference, PassWords words = PassWords::full);
struct PassOrFormula {
  PassTables tables;
  std::string why;  ///< there is no pass, in a sentence; empty: there is, or none is asked for
};
/// The same, but where the config goes on without a pass the rig takes the formula.
PassOrFormula pass_or_formula(Rig& rig, const Reference& reference, PassWords words);

/// pass_or_formula before a run. Throws InputError with the config's name where it refuses to go on.
std::string heed_missing_pass(const std::string& config, Rig& rig, const LoadPositions& load);

/// Largest distance of the simulated closed loop from the reference, on the pass's own model without noise [m], with
/// the pass or with another feedforward from the same rest.
double predicted_error_m(const Rig& rig, const Reference& reference, const CommandPass& pass, FeedforwardSource by);

}  // namespace pneuservo
