// Fits of hypotheses by Levenberg steps in lanes: several fits go on side by side, each step tries several dampings.
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "diagnosis/residuals/fitted_rows.hpp"
#include "diagnosis/search/free_parameter.hpp"

namespace pneuservo {

/// One fit: where it stands and what it knows there.
struct Fit {
  Hypothesis base;                        ///< what the parameters do not say
  std::vector<FreeParameter> parameters;  ///< those of the explanation first, then the nuisances
  std::size_t own_count = 0;              ///< how many belong to the explanation
  Eigen::VectorXd z, residual;            ///< residual at z
  Eigen::MatrixXd jacobian;               ///< d residual / d z
  std::vector<char> known_columns;        ///< columns that may be kept from an earlier place
  std::shared_ptr<const SlowErrors> freed_from;  ///< residual and Jacobian; null: nothing
  double objective = 0;                   ///< residual'residual + z'z
  bool failed = false;                    ///< cannot be simulated; not to be used
  bool settled = false;

  Hypothesis hypothesis() const;
  /// Where a parameter of the explanation stands; throws std::logic_error where the explanation has none such.
  Eigen::Index own_place(const FreeParameter& parameter) const;
  /// Of half the objective, by the linear model: J'r + z and J'J + 1, the prior in units of its standard deviation.
  Eigen::VectorXd gradient() const { return jacobian.transpose() * residual + z; }
  Eigen::MatrixXd curvature() const;
  double chi2() const { return residual.squaredNorm(); }
  /// Laplace evidence, but for a constant of the data: -objective/2 - logdet(J'J + 1)/2.
  double log_evidence() const;
  /// (J'J + 1)^-1.
  Eigen::MatrixXd covariance() const;
};

/// A fit at the rig as configured: all `own` parameters, and beside them the nuisances that are none of them.
Fit fit_at_start(const Rig& rig, FittedRows& rows, std::vector<FreeParameter> own,
                 const std::vector<FreeParameter>& nuisances);

/// How many of the owner's tolerances that are none of the explanation's own stand where their range ends.
std::size_t tolerances_at_end(const Rig& rig, const Fit& fit);

/// Places of the parameters that two fits have in common, with one unit and one range: a name frees wider what is a
/// nuisance elsewhere.
std::vector<std::pair<Eigen::Index, Eigen::Index>> shared_parameters(const Fit& a, const Fit& b);

/// Residual and Jacobian of a fit, freed from another slow error, come to the one that rows are freed from now.
void bring_to_slow_error(const FittedRows& rows, Fit& fit);
/// Fills the residual and, in every column that is not known, the Jacobian at z.
void linearise(FittedRows& rows, const std::vector<Fit*>& fits);
/// Which derivatives are taken anew at every step: those of the explanation's own parameters (the nuisances' are taken
/// where they are not known yet, and hardly change near a minimum), or all. `corrected`: as `own`, and the nuisances'
/// follow what every step finds along itself.
enum class Columns { own, corrected, all };

/// Moves every fit towards its minimum, at most `iterations` steps, or until a step promises or gains less than
/// settled_gain of the objective; afterwards residual, Jacobian and objective stand at z.
void improve(FittedRows& rows, std::vector<Fit*> fits, int iterations, Columns columns_at_steps,
             double settled_gain = 0.1);

}  // namespace pneuservo
