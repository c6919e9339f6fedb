// What the verb design finds out of a config: models, gains by a rule, poles, margins, step, feedforward.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pneuservo/control/spool_loop.hpp>

#include "design/linearisation.hpp"
#include "design/margin_gains.hpp"
#include "design/sampled_loop.hpp"

namespace pneuservo {

/// Where the gains come from: the config, or a rule (design/gain_rules.hpp).
enum class DesignMethod { config, alpha_beta, itae_7, itae_min, margins };
inline constexpr std::array<std::string_view, 5> design_method_names{"config", "alpha_beta", "itae_7", "itae_min",
                                                                     "margins"};

struct DesignRequest {
  DesignMethod method = DesignMethod::config;
  std::optional<double> position_gain_V_per_m;  ///< of a rule; default: the config's
  double alpha = 2.0, beta = 2.0;               ///< of alpha_beta
  double c_1 = 11.0, c_2 = 45.0;                ///< of itae_7: the thesis' C6 (of s) and C5 (of s^2)
  bool needs_mean_pressure = true;  ///< whether to find the mean pressure that the reference needs (slow)
};

/// One linear model with the loop that the gains close around it, with ideal derivatives and no sampling.
struct ModelFigures {
  LinearAxis axis;
  std::vector<std::complex<double>> poles;
  std::vector<double> coefficients;  ///< normalised, by rising power
  std::vector<double> feedforward;  ///< c_1, c_2, ...
  double itae_s2 = 0.0;  ///< infinite: unstable
};

struct AxisDesign {
  explicit AxisDesign(const AxisLinearisation& linearisation) : linear(linearisation) {}

  DesignMethod method = DesignMethod::config;
  AxisLinearisation linear;
  Ppd2Gains gains_before, gains;  ///< of the config, and of the design; of pd_force as its PPD2 equal
  ControllerParameters controller;  ///< the config's with the design's gains
  std::vector<ModelFigures> models;  ///< third, fifth, full order
  SecondOrderLag matched, by_distance;  ///< what stands for all lags in the fifth order, by both reductions
  double delay_s = 0.0;  ///< from the command to the valve
  SampledLoop loop;  ///< full order with observer or filter, hold and command delay
  std::vector<std::complex<double>> poles;
  bool is_stable = false;
  LoopMargins margins;  ///< of `loop`
  LoopMargins exact_margins;  ///< the same law on distributed lines with frequency-dependent friction
  StepResponse step;
  double command_noise_V = 0.0;  ///< rms at rest, from the position sensor's quantum and noise
  std::optional<double> mean_pressure_needed_Pa;  ///< of a servo table's reference; 0: none below the supply
  std::optional<SpoolLoopGains> spool;  ///< inner loop of the config's valve; none: its spool follows at once
  bool spool_in_range = true;  ///< whether its frequency is one of 50 to 300 Hz
  std::vector<std::string> warnings;  ///< one sentence each
};

/// The config's loop at the config's own operating point and payload.
struct LoopPoint {
  double position_m = 0.0, payload_kg = 0.0;
  bool is_stable = false;
  double weakest_Hz = 0.0;  ///< of the pole that grows most or dies slowest, or where the loop is next to -1
  LoopMargins margins;      ///< only where they were asked for
};
/// The sampled loop of the full linear model with the config's gains; on distributed lines, by Nyquist's criterion,
/// where it needs the ports' pressures. Throws std::invalid_argument as design_axis does.
LoopPoint loop_point(const Rig& rig, bool with_margins);

/// Designs the config's axis. Throws std::invalid_argument with one sentence where the request does not fit.
AxisDesign design_axis(const Rig& rig, const DesignRequest& request, const LoadPositions& load = {});

/// Loop transfer of the design's law on distributed lines, positive for negative feedback.
std::complex<double> exact_open(const AxisDesign& design, double frequency_Hz);

}  // namespace pneuservo
