// The backend sim with faults injected on purpose: into its channels, its plant, its output and its emergency stop.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

#include "inject/plant_faults.hpp"
#include "inject/sample_faults.hpp"
#include "rig/injected_fault.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {

/// Every fault is what a real device shows: a dropped sample is invalid, a delayed one tells its age, after bus-off
/// nothing comes and nothing goes until the device's watchdog gives its substitute output. Late ticks are the loop's
/// own matter (RunSettings::late).
class InjectingBackend final : public Backend {
 public:
  /// Faults that cannot be injected into sim throw InputError; `origin` begins the sentence.
  InjectingBackend(const Rig& rig, const std::vector<InjectedFault>& faults, const std::string& origin);

  void configure() override;
  void activate() override { plant_.activate(); }
  bool read(std::int64_t tick, Measurement& measurement) noexcept override;
  bool write(std::int64_t tick, const Command& command) noexcept override;
  void deactivate() noexcept override { plant_.deactivate(); }
  Truth truth() const noexcept override { return plant_.truth(); }
  Origins origins() const override;
  SafeOutput safe_output() const override { return plant_.safe_output(); }
  std::vector<std::string> notes() const override;
  std::string name() const override { return "sim"; }

 private:
  bool is_on(InjectedKind kind, double t_s) const noexcept;

  Rig rig_;
  SimBackend plant_;
  PlantFaults plant_faults_;
  SampleFaults sample_faults_;
  std::vector<InjectedFault> faults_;
  double bus_off_since_s_ = -1.0;
};

}  // namespace pneuservo
