// The backend sim with faults injected on purpose: into its channels, its plant, its output and its emergency stop.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

#include "inject/plant_faults.hpp"
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
  std::vector<std::string> notes() const override;
  std::string name() const override { return "sim"; }

 private:
  static constexpr double longest_delay_s = 1.0;

  struct Injected {
    InjectedFault fault;
    std::size_t channel = 0;  ///< past the last one: it has none
    double kept = 0.0;  ///< what a frozen channel repeats
    bool spent = false;
  };
  void spoil(Injected& injected, Channel& sample) noexcept;
  bool bus_is_off(double t_s) const noexcept;

  Rig rig_;
  SimBackend plant_;
  PlantFaults plant_faults_;
  std::vector<Injected> faults_;
  std::vector<std::array<double, 6>> history_;  // ring of samples, for delays
  std::size_t newest_ = 0;
  double bus_off_since_s_ = -1.0;
};

}  // namespace pneuservo
