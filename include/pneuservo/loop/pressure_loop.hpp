// The pass of a pressure rig: read, supervisor, estimator of the far end, law, write, row.
#pragma once
#include <array>
#include <cstdint>

#include <pneuservo/control/axis_controller.hpp>
#include <pneuservo/control/pressure_reference.hpp>
#include <pneuservo/estimator/pipeline_estimator.hpp>
#include <pneuservo/loop/control_loop.hpp>
#include <pneuservo/rig/pressure_axis.hpp>

namespace pneuservo {

/// The same parts as AxisLoop: supervisor with its faults, estimator, law, row. The reference begins with the first
/// active tick: the law's target starts at the pressure that is there. A fault is latched, the valve has the safe
/// output from its tick on.
class PressureLoop final : public ControlLoop {
 public:
  /// Cold: allocates, may throw std::invalid_argument.
  void configure(const Rig& rig);

  bool pass(Backend& backend, std::int64_t tick, std::int64_t skipped, StageTimes* times,
            std::int64_t (*now)() noexcept) noexcept PNEUSERVO_NONBLOCKING override;
  void stop(Backend& backend, std::int64_t tick) noexcept override;
  void restart_reference() noexcept override { begins_ = true; }
  void note_slept(std::int64_t slept_ns) noexcept override { supervisor_.note_slept(slept_ns); }

  const Row& row() const noexcept override { return row_; }
  Row& row() noexcept override { return row_; }
  std::uint64_t faults() const noexcept override { return supervisor_.faults(); }
  std::uint64_t first_faults() const noexcept override { return supervisor_.first_faults(); }
  double reference_start_s() const noexcept override { return reference_start_s_; }
  const Supervisor& supervisor() const noexcept override { return supervisor_; }
  const AxisController& controller() const noexcept override { return controller_; }
  std::size_t size() const noexcept override { return sizeof(PressureLoop); }

 private:
  EstimatorOutput estimate(const JudgedInputs& inputs, std::int64_t skipped) noexcept;
  double controlled_Pa(const JudgedInputs& inputs, const EstimatorOutput& estimate) const noexcept;
  void watch_volume(const JudgedInputs& inputs, const EstimatorOutput& estimate) noexcept;
  double control(double t_s, const JudgedInputs& inputs, const EstimatorOutput& estimate) noexcept;
  void fill_row(double t_s, std::int64_t skipped, bool stepped, const Measurement& measured, const Truth& truth,
                const EstimatorOutput& estimate) noexcept;

  double period_s_ = 1e-3, command_max_V_ = 5.0, pressure_limit_Pa_ = infinite;
  PressureSource source_ = PressureSource::estimated;
  Supervisor supervisor_;
  PipelineEstimator estimator_;
  VolumeGrowth growth_;
  bool grows_ = false, estimated_ = false;
  AxisController controller_;
  PressureReference reference_;
  bool begins_ = true, limited_ = false;
  double reference_start_s_ = 0.0, p_ref_Pa_ = Row::none;
  Row row_;
};

}  // namespace pneuservo
