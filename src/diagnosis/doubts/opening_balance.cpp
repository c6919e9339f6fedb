// One spool opens both sides of a cylinder.
#include "diagnosis/doubts/opening_balance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include <pneuservo/core/golden_section.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/valve.hpp>

#include "diagnosis/doubts/misfits.hpp"
#include "diagnosis/doubts/side_gas.hpp"
#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/residuals/force_balance.hpp"

namespace pneuservo {

namespace {

using Series = std::vector<double>;

/// Both sides to the atmosphere, from 1 to 2, both from the supply.
constexpr int leaks = 5;
/// Of the largest command: closer a dead band need not be known, its misfit is flat there.
constexpr double band_width = 0.03;
constexpr std::size_t least_rows = 4 * leaks;

/// What leaks of at least 0 leave of a series: the best of all subsets of them that stay positive.
class BesideLeaks {
 public:
  explicit BesideLeaks(Eigen::MatrixXd effect) : effect_(std::move(effect)) {
    const Leaks scale = effect_.colwise().norm().transpose().cwiseMax(std::numeric_limits<double>::min());
    effect_ *= scale.cwiseInverse().asDiagonal();
    normal_ = effect_.transpose() * effect_;
  }
  /// Sum of squares.
  double left(const Eigen::VectorXd& offset) const {
    const Leaks wanted = -effect_.transpose() * offset;
    Leaks best = Leaks::Zero();
    double most_explained = 0;
    for (int set = 1; set < 1 << leaks; ++set) {
      Leaks is_in;
      for (int i = 0; i < leaks; ++i) is_in(i) = set >> i & 1;
      // Rows and columns of the others are those of the identity, so that they come out as 0.
      Eigen::Matrix<double, leaks, leaks> part = is_in.asDiagonal() * normal_ * is_in.asDiagonal();
      part.diagonal() += Leaks::Ones() - is_in;
      const Leaks solved = part.ldlt().solve(is_in.cwiseProduct(wanted));
      const double explained = solved.dot(wanted);
      if (!(solved.minCoeff() >= 0 && explained > most_explained)) continue;
      most_explained = explained;
      best = solved;
    }
    return (offset + effect_ * best).squaredNorm();
  }

 private:
  using Leaks = Eigen::Matrix<double, leaks, 1>;
  Eigen::MatrixXd effect_;  ///< of each leak, scaled to a norm of 1
  Eigen::Matrix<double, leaks, leaks> normal_;
};

class SharedOpening {
 public:
  SharedOpening(const Rig& rig, const CylinderRecording& prepared)
      : rig_(rig), prepared_(prepared), motion_(smoothed_motion(rig, prepared)),
        sides_{side_gas(rig, prepared, 0), side_gas(rig, prepared, 1)} {
    const GaussianKernel& kernel = motion_.kernel();
    // Neighbours within half of the kernel's standard deviation say the same.
    const auto apart = static_cast<std::size_t>(std::max(1.0, 0.5 * kernel.sigma_s() / prepared.period_s()));
    for (std::size_t k = 0; k < motion_.samples(); k += apart)
      if (prepared.usable[k] && motion_.usable()[k]) rows_.push_back(k);
    if (!sides_[0] || !sides_[1] || rows_.size() <= least_rows) {
      rows_.clear();
      return;
    }
    const Eigen::VectorXd e1 = smoothed(sides_[0]->emptying), e2 = smoothed(sides_[1]->emptying),
                          f1 = smoothed(sides_[0]->filling), f2 = smoothed(sides_[1]->filling),
                          across = smoothed(past_piston());
    rate_.resize(count(), 2), fills_1_.resize(count(), 2), empties_1_.resize(count(), 2);
    rate_ << smoothed(sides_[0]->mass_kg, 1), smoothed(sides_[1]->mass_kg, 1);
    fills_1_ << f1, -e2;
    empties_1_ << e1, -f2;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(count());
    for (Eigen::MatrixXd& leaving : leaving_) leaving.resize(count(), leaks);
    leaving_[0] << e1, none, across, -f1, none;
    leaving_[1] << none, e2, -across, none, -f2;
    Eigen::MatrixXd both(2 * count(), leaks);
    both << leaving_[0], leaving_[1];
    beside_band_.emplace(std::move(both));
  }

  double of_sides() const {
    if (rows_.empty()) return infinite_misfit;
    return std::sqrt(left_of_any_opening() + between_ends());
  }

  /// The least over dead bands: each edge opens with that much of the command less.
  double of_gas() const {
    if (rows_.empty()) return infinite_misfit;
    double widest_V = 0;
    for (const std::size_t k : rows_) widest_V = std::max(widest_V, std::abs(prepared_.inputs.command_V[0][k]));
    const auto left = [&](double band_V) { return left_beside_band(band_V); };
    const double best_V = golden_section_minimum(left, 0, widest_V, band_width * widest_V);
    const double least = std::min(left(0), left(best_V));
    return std::min(std::sqrt(least + between_ends()), own_swing);
  }

  double of_both() const { return std::sqrt(of_sides() * of_gas()); }

 private:
  Eigen::Index count() const { return static_cast<Eigen::Index>(rows_.size()); }

  /// Derivative of that order at the rows.
  Eigen::VectorXd smoothed(const Series& series, int order = 0) const {
    const Series all = motion_.kernel().apply(series, order);
    Eigen::VectorXd out(count());
    for (Eigen::Index r = 0; r < count(); ++r) out(r) = all[rows_[static_cast<std::size_t>(r)]];
    return out;
  }

  /// Through an opening of 1 m2, from side 1 to side 2.
  Series past_piston() const {
    const Air<double> air(rig_.axis.air);
    const double T = air.temperature_K, ratio = rig_.axis.valve.critical_pressure_ratio;
    Series out;
    for (std::size_t k = 0; k < sides_[0]->port_Pa.size(); ++k) {
      const double p1_Pa = sides_[0]->port_Pa[k], p2_Pa = sides_[1]->port_Pa[k];
      out.push_back(p1_Pa > 0 && p2_Pa > 0 ? orifice_mass_flow(air, 1.0, ratio, p1_Pa, T, p2_Pa, T) : 0.0);
    }
    return out;
  }

  /// At each row an opening moves the gas of both sides along one direction, which its sign and the pressures give.
  /// What is across that, no opening explains. Squared, as a share.
  double left_of_any_opening() const {
    Eigen::VectorXd across(count());
    Eigen::MatrixXd effect(count(), leaks);
    for (Eigen::Index r = 0; r < count(); ++r) {
      const auto flow = rate_(r, 0) > rate_(r, 1) ? fills_1_.row(r) : empties_1_.row(r);
      const Eigen::RowVector2d unit = flow.normalized();
      across(r) = unit(1) * rate_(r, 0) - unit(0) * rate_(r, 1);
      effect.row(r) = unit(1) * leaving_[0].row(r) - unit(0) * leaving_[1].row(r);
    }
    return BesideLeaks(effect).left(across) / rate_.squaredNorm();
  }

  /// Mean difference between a line's ends, for what flows in flows out again: squared, in atmospheres.
  double between_ends() const {
    double squares = 0, lines = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      const Series &port = prepared_.measured[port_signals[i]], &chamber = prepared_.measured[chamber_signals[i]];
      if (port.empty() || chamber.empty()) continue;
      double sum = 0, both = 0;
      for (const std::size_t k : rows_)
        if (const double apart = port[k] - chamber[k]; std::isfinite(apart)) sum += apart, ++both;
      if (!(both > 0)) continue;
      const double share = sum / both / rig_.axis.air.atmosphere_Pa;
      squares += share * share, ++lines;
    }
    return lines > 0 ? squares / lines : 0.0;
  }

  /// Of the gas beside what passes the valve. Squared, as a share.
  double left_beside_band(double band_V) const {
    ValveEffects<double> effects = rig_.axis.effects.valve;
    effects.valve_dead_band.width_V += band_V;
    Valve<double> valve;
    valve.configure(rig_.axis.valve, effects, prepared_.period_s());
    Eigen::VectorXd left(2 * count());
    for (std::size_t i = 0; i < 2; ++i) {
      valve.set_edges(i == 0 ? PortEdges<double>::of_port_1(effects) : PortEdges<double>::of_port_2(effects));
      Series flow_kgps;
      for (std::size_t k = 0; k < motion_.samples(); ++k) {
        const double command_V = (i == 0 ? 1.0 : -1.0) * prepared_.inputs.command_V[0][k];
        const PortAreas<double> areas = valve.areas(std::isfinite(command_V) ? command_V : 0.0);
        flow_kgps.push_back(areas.supply * sides_[i]->filling[k] - areas.exhaust * sides_[i]->emptying[k]);
      }
      const auto at = static_cast<Eigen::Index>(i);
      left.segment(at * count(), count()) = rate_.col(at) - smoothed(flow_kgps);
    }
    return beside_band_->left(left) / rate_.squaredNorm();
  }

  const Rig& rig_;
  const CylinderRecording& prepared_;
  ForceBalance motion_;
  std::array<std::optional<SideGas>, 2> sides_;
  std::vector<std::size_t> rows_;  ///< that are judged; empty: a side is not measured, or too little is left
  /// At the rows, of both sides: the gas's rate, and what an opening of 1 m2 does that fills side 1, that empties it.
  Eigen::MatrixX2d rate_, fills_1_, empties_1_;
  std::array<Eigen::MatrixXd, 2> leaving_;  ///< what each leak of 1 m2 takes from a side
  std::optional<BesideLeaks> beside_band_;  ///< of both sides, one after the other
};

using Misfit = double (SharedOpening::*)() const;

double misfit_of(const Rig& rig, const Recording& recording, Misfit misfit) {
  return misfit_or_infinite([&] {
    const CylinderRecording prepared = prepare_recording(recording, rig, judged_s);
    return (SharedOpening(rig, prepared).*misfit)();
  });
}

}  // namespace

double sides_misfit(const Rig& rig, const Recording& recording) {
  return misfit_of(rig, recording, &SharedOpening::of_sides);
}

double gas_misfit(const Rig& rig, const Recording& recording) {
  return misfit_of(rig, recording, &SharedOpening::of_gas);
}

double opening_misfit(const Rig& rig, const Recording& recording) {
  return misfit_of(rig, recording, &SharedOpening::of_both);
}

}  // namespace pneuservo
