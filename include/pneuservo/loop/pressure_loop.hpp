// The pass of a pressure rig: read, supervisor, estimator of the far end, law, write, row.
#pragma once
#include <array>
#include <cstdint>

#include <pneuservo/control/pressure_reference.hpp>
#include <pneuservo/loop/loop_pass.hpp>
#include <pneuservo/rig/pressure_axis.hpp>

namespace pneuservo {

/// The same parts as AxisLoop: supervisor with its faults, estimator, law, row. The reference begins with the first
/// active tick: the law's target starts at the pressure that is there. A fault is latched, the valve has the safe
/// output from its tick on, until rearm(). Where it is commanded the set point starts at the pressure that is there,
/// too.
class PressureLoop final : public LoopPass<PressureLoop> {
 public:
  /// Cold: allocates, may throw std::invalid_argument.
  void configure(const Rig& rig);

  /// Leads back from a stop and from every fault: law and estimator start anew, the latched faults are cleared. HOT.
  void rearm() noexcept;
  void restart_reference() noexcept override { begins_ = true; }

 private:
  friend class LoopPass<PressureLoop>;

  bool may_start() const noexcept { return desk_.enabled(); }
  void note_inputs(const JudgedInputs&, std::int64_t) noexcept {}
  EstimatorOutput estimate(const JudgedInputs& inputs, std::int64_t skipped) noexcept;
  void watch(const Measurement&, const JudgedInputs& inputs, const EstimatorOutput& estimate, std::int64_t) noexcept;
  std::array<double, 2> control(std::int64_t tick, const JudgedInputs& inputs, const EstimatorOutput& estimate,
                                std::int64_t skipped) noexcept;
  void fill_row(double t_s, std::int64_t skipped, bool stepped, const Measurement& measured, const Truth& truth,
                const EstimatorOutput& estimate) noexcept;
  void end_tick(std::int64_t tick, const JudgedInputs&) noexcept {
    if (desk_.is_open()) tell_status(tick);
  }
  ReferencePoint set_point(std::int64_t tick, double p_Pa) noexcept;
  void tell_status(std::int64_t tick) noexcept;

  double pressure_limit_Pa_ = infinite;
  VolumeGrowth growth_;
  bool grows_ = false, estimated_ = false;
  PressureReference reference_;
  double p_ref_Pa_ = Row::none, p_ref_Pa_per_s_ = Row::none, p_Pa_ = Row::none;
};

}  // namespace pneuservo
