// Backend `sim`: the rig's plant on its own, finer grid behind noisy, quantised sensors; its truth is for recordings
// only.
#pragma once
#include <array>

#include <pneuservo/elements/sensor.hpp>
#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/plant.hpp>
#include <pneuservo/rig/pressure_axis.hpp>
#include <pneuservo/rig/rig.hpp>
#include <pneuservo/rig/valve_drive.hpp>

namespace pneuservo {

/// Sampled at the start of each period, the command held for the period. read(tick) brings the plant to that tick:
/// slots that the loop skipped pass with the last command, as they would on a machine. Everything random comes from
/// rig.seed. The plant is rig with its `deviations`.
class SimBackend final : public Backend {
 public:
  enum class Has { every_sensor, sensors_of_the_config };
  /// sensors_of_the_config: chambers, supply and flow without a section of their own (noise and quantum 0) have no
  /// sensor.
  explicit SimBackend(const Rig& rig, Has sensors = Has::every_sensor);
  void configure() override;
  void activate() override;
  bool read(std::int64_t tick, Measurement& measurement) noexcept override;
  bool write(std::int64_t tick, const Command& command) noexcept override;
  void deactivate() noexcept override;
  Truth truth() const noexcept override;
  /// The machine from here on: supply pressure, leaks of the chambers. HOT.
  void set_machine(double supply_pressure_Pa, const std::array<double, 2>& chamber_leak_m2) noexcept {
    plant_.set_supply_pressure(supply_pressure_Pa);
    plant_.set_chamber_leaks(chamber_leak_m2[0], chamber_leak_m2[1]);
  }
  /// The slider from here on, with stops `way_m` apart in the middle of the stroke. HOT.
  void set_slider(const SliderParameters<double>& slider, const MotionEffects<double>& effects, double way_m) noexcept {
    plant_.slider().configure(slider, effects, way_m, rig_.axis.cylinder.end_stop_restitution);
  }
  /// True speed [m/s]; for recordings only, as the truth is.
  double speed_mps() const noexcept { return plant_.velocity(); }
  Origins origins() const override;
  SafeOutput safe_output() const override { return safe_output_; }
  std::string name() const override { return "sim"; }

 private:
  void configure_plant();
  void step_plant() noexcept;
  void age_by_a_tick(std::int64_t tick, Measurement& measurement) noexcept;
  void show_switches(DigitalInputs& digital) noexcept;

  Rig rig_;
  PerSignal<bool> is_there_;
  AxisPlant<double> plant_;
  std::array<ValveDrive, 2> drives_;
  int drive_ticks_ = 0;  // a period; 0: the valve is a lag
  VolumeGrowth growth_;  // of a pressure rig
  PerSignal<Sensor> sensors_;
  std::int64_t plant_tick_ = 0;
  bool started_ = false;
  Command command_;
  SafeOutput safe_output_;
  Random switches_random_;
  std::array<bool, 2> switches_on_{};
  std::array<double, 2> switch_change_m_{};  ///< where each changes next
  Measurement last_;
  std::int64_t last_tick_ = -1;  // of last_; -1: none yet
};

/// Start of the simulated plant from the config's `initial`.
PlantStart<double> plant_start(const Rig& rig);

}  // namespace pneuservo
