// The sizes of stated effects, fitted to recordings together: what a machine that is known is measured by, week by
// week.
#pragma once
#include <string>
#include <vector>

#include <Eigen/Core>

#include "diagnosis/diagnose.hpp"

namespace pneuservo {

/// What a refit found. Nothing is named and nothing judged: the numbers are those of the effects that were asked for.
struct Refit {
  std::vector<std::string> paths;  ///< of the sizes: effects.coulomb_friction.force_N
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;  ///< of the values, in their units, with the tolerances and the starts free beside them
  /// Squared mismatch a row in its floor: well below 1 where the model lacks nothing, since floors hold its own error.
  double misfit = 0;
  Rig refitted;
  std::vector<std::string> warnings;
};

/// Fits `effects` (coulomb_friction, chamber_leak_1), the config's tolerances and the starts to the recordings. Effects
/// that the config has begin at its sizes. Throws InputError for recordings that cannot be used and for names that are
/// no effect with a size of its own, DiagnosisStopped where it is stopped.
Refit refit(const Rig& configured, std::vector<Recording> recordings, const std::vector<std::string>& effects,
            const DiagnoseOptions& options = {});

}  // namespace pneuservo
