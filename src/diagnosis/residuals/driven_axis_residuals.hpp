// Residuals of an axis whose drive force is known: the force balance alone.
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "diagnosis/recordings/held_out.hpp"
#include "diagnosis/recordings/recorded_rigs.hpp"
#include "diagnosis/residuals/force_balance.hpp"
#include "diagnosis/residuals/residual_model.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// One channel, F. A drive force that was commanded acts for a period of the loop from its row on, a measured one is of
/// its instant: the import map says which.
class DrivenAxisResiduals : public ResidualModel {
 public:
  /// Where the rig has piston areas the pressures of their chambers act beside the drive force.
  /// The recordings hold t_s, x_m and F_N (or u_V, where the rig says its force per volt). Throws InputError.
  DrivenAxisResiduals(const Rig& rig, const std::vector<Recording>& recordings);

  const std::vector<ResidualChannel>& channels() const override { return channels_; }
  const std::vector<ResidualRow>& rows() const override { return rows_; }
  void set_stop(StopQuestion stop) override { stop_ = std::move(stop); }
  Eigen::MatrixXd residuals(std::span<const Hypothesis> hypotheses) override;
  std::vector<ChannelMisfit> sample_misfit(const Hypothesis& hypothesis) override;
  std::vector<ResidualCourse> courses(const Hypothesis& hypothesis) override;

 private:
  struct Part {
    ForceBalance balance;
    double interval_s;
    std::vector<double> time_s, drive_N, drive_rate_Nps;  ///< smoothed drive as recorded, and its rate
    std::vector<double> jump_N;  ///< standard deviation by which a jump of the force behind each row is at another time
    std::vector<char> usable;
    std::array<std::vector<double>, 2> pressure_Pa;  ///< of the chambers, smoothed; empty: no piston
    HeldOut held_out;
    MachineChanges changes;  ///< of the owner's rig while it was recorded
    ReadingNoise reading_noise{};  ///< of its rows
  };
  struct Bin {
    std::size_t part, first, count;
  };
  /// The drive force with its sensor's effects undone, and the force that the hypothesis needs.
  std::pair<std::vector<double>, std::vector<double>> forces(const Part& part, const Rig& rig) const;
  double reading_noise_N(const Part& part, const Rig& rig) const;
  void add_recording(const Rig& rig, const Recording& recording);
  void add_pressures(const Rig& rig, const Recording& recording, Part& part) const;
  double jump_error_N(const Bin& bin) const;
  std::pair<double, double> piston_force(const Part& part, const Rig& rig, std::size_t i) const;

  std::vector<ResidualChannel> channels_;
  std::vector<ResidualRow> rows_;
  StopQuestion stop_;
  std::vector<Part> parts_;
  std::vector<Bin> bins_;
  bool has_held_out_ = false;  ///< whole recordings are; else stretches of each
};

}  // namespace pneuservo
