// The closed loop of a config as a simulation that runs beside the axis: where the slider should be.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include <pneuservo/control/axis_controller.hpp>
#include <pneuservo/elements/sensor.hpp>
#include <pneuservo/rig/plant.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// What the sensors of a drawn machine add to what the law sees.
struct TwinNoise {
  double position_m = 0.0;
  std::array<double, 2> pressure_Pa{};
};

/// The config's law on a plant of its own, on a coarse grid, without noise and estimator: the law's pressures are those
/// of the plant. With the config's own plant it predicts the motion (chapter 3 closed loop); with a drawn one it is one
/// of the machines from which the limits follow (src/loop/motion_limits.cpp). All of it but configure is HOT.
class MotionTwin {
 public:
  /// Cells of each line. The prediction needs what moves the slider, some 10 Hz, for which 2.5 m a cell are enough.
  /// With one cell the limits are nearly the same, but a law that leans on the line's first resonance swings otherwise.
  static constexpr int most_cells = 4;
  /// Relative change of a port's pressure that ends its solution: one Newton step, which leaves half its square, 30 Pa.
  static constexpr double port_tolerance = 1e-2;

  /// Allocates; throws what the law's configuration throws. The plant is the rig's own.
  /// `resting_force_N`: force of the air that friction may hold, or noise may show, at rest.
  /// `pass`: of the reference, as this plant shows it.
  void configure(const Rig& rig, const Reference& reference, double resting_force_N,
                 std::shared_ptr<const PassTable> pass = {}) {
    resting_force_N_ = resting_force_N;
    const auto& cylinder = rig.axis.cylinder;
    area_1_m2_ = cylinder.area_1_m2;
    area_2_m2_ = cylinder.area_2_m2;
    atmosphere_force_N_ = (area_1_m2_ - area_2_m2_) * rig.axis.air.atmosphere_Pa;
    law_.configure(rig.controller, rig.axis, rig.period_s, reference, rig.duration_s, std::move(pass));
    chambers_ = law_.pressure_source() != PressureSource::valve;
    aged_ = rig.simulation.input_age_periods > 0;
    configure_sensors(rig);
    const auto& axis = rig.axis;
    const int needed = std::max(cell_count(axis.line_1.length_m, 1.0), cell_count(axis.line_2.length_m, 1.0));
    // A law on port pressures meets the line's ringing, which coarse cells have too stiff above 100 Hz.
    const bool rings = rig.controller.closes_force_loop() && !chambers_;
    set_machine(rig, axis, rings ? simulated_cells(rig) : std::min(needed, most_cells));
  }
  /// Cells of each line of the simulated machine.
  static int simulated_cells(const Rig& rig) noexcept {
    return std::max(cell_count(rig.axis.line_1.length_m, rig.simulation.cells_per_m),
                    cell_count(rig.axis.line_2.length_m, rig.simulation.cells_per_m));
  }
  /// Another plant behind the rig's law. Allocates.
  void set_machine(const Rig& rig, const AxisParameters<double>& machine, int cells) {
    plant_.configure(machine, rig.period_s, PlantGrid{cells, 0, port_tolerance}, valve_arrangement(rig));
    // Where even flow at the speed of sound needs no second sub-step, none is ever chosen anew.
    if (plant_.sides().needed_substeps(rig.period_s, plant_.sides().sound_mps()) == 1) plant_.sides().fix_substeps(1);
    cells_ = cells;
    droops_ = machine.effects.supply_droop.area_m2 > 0.0;
  }
  /// Another moving mass and friction from here on, in motion, too.
  void load(const AxisParameters<double>& machine) noexcept {
    const auto& cylinder = machine.cylinder;
    plant_.slider().configure(machine.slider, machine.effects.motion, cylinder.stroke_m, cylinder.end_stop_restitution);
  }

  /// Begins at rest with what was measured: position, and the pressure of each side in line and chamber. What friction
  /// may hold it holds: the prediction has none and would jump.
  void start(double position_m, const std::array<double, 2>& pressure_Pa,
             const std::array<double, 2>& command_V) noexcept {
    const double force_N = area_1_m2_ * pressure_Pa[0] - area_2_m2_ * pressure_Pa[1] - atmosphere_force_N_;
    const double held_N = std::fabs(force_N) <= resting_force_N_ ? force_N : 0.0;
    plant_.reset({position_m, pressure_Pa[0], pressure_Pa[1] + held_N / area_2_m2_});
    const auto chamber = plant_.chamber_pressure();
    sensors_[Signal::x].reset(plant_.position());
    for (const auto& [side_1, side_2] : {port_signals, chamber_signals})
      sensors_[side_1].reset(low(chamber)), sensors_[side_2].reset(high(chamber));
    now_ = seen_ = sample();
    law_.reset(command_V);
    command_V_ = command_V;
    speed_mps_ = 0.0;
  }
  /// Slots that the loop skipped: the command was held.
  void hold(std::int64_t periods) noexcept {
    for (std::int64_t i = 0; i < periods; ++i) {
      plant_.step(command_V_[0], command_V_[1]);
      seen_ = now_;
      now_ = sample();
    }
    law_.skip(periods);
  }
  /// One period: the law's step on the present state, its command within +-most_command_V, and the plant's answer.
  void step(const ControlInput& reference, double supply_Pa, double most_command_V,
            const TwinNoise& noise = {}) noexcept {
    const Sample& taken = aged_ ? seen_ : now_;
    ControlInput in = reference;
    in.x_m = taken.position_m + noise.position_m;
    for (std::size_t i = 0; i < 2; ++i) {
      in.port_Pa[i] = taken.port_Pa[i] + noise.pressure_Pa[i];
      in.pressure_Pa[i] = (chambers_ ? taken.chamber_Pa[i] : taken.port_Pa[i]) + noise.pressure_Pa[i];
    }
    const ControlOutput out = law_.step(in);
    for (std::size_t i = 0; i < 2; ++i) command_V_[i] = std::clamp(out.command_V[i], -most_command_V, most_command_V);
    speed_mps_ = out.speed_mps;
    if (!droops_) plant_.set_supply_pressure(supply_Pa);  // else it is measured behind the droop
    plant_.step(command_V_[0], command_V_[1]);
    seen_ = now_;
    now_ = sample();
  }
  void change_gains(const Ppd2GainSet& gains) noexcept { law_.change_gains(gains); }
  void follow_pass(std::span<const PassTick> rows, std::int64_t from) noexcept { law_.follow_pass(rows, from); }

  /// As the encoder should show it behind the loop's correction.
  double position_m() const noexcept { return now_.position_m; }
  double velocity_mps() const noexcept { return plant_.velocity(); }
  /// As the law filtered it in the last step.
  double speed_mps() const noexcept { return speed_mps_; }
  double force_N() const noexcept { return plant_.driving_force(); }
  int cells() const noexcept { return cells_; }
  const AxisController& law() const noexcept { return law_; }
  const std::array<double, 2>& command_V() const noexcept { return command_V_; }

 private:
  struct Sample {
    double position_m = 0.0;
    std::array<double, 2> port_Pa{}, chamber_Pa{};
  };
  // The loop corrects its sensors, so that their lags alone are left. A chamber pressure that is estimated, or the
  // port's less a measured loss, is as late as its port's sensor.
  void configure_sensors(const Rig& rig) {
    const bool estimated = law_.pressure_source() != PressureSource::chamber;
    has_sensor_effects_ = false;
    for (const Signal signal : channel_signals) {
      if (signal != Signal::x && !is_port(signal) && !is_chamber(signal)) continue;
      const bool of_port = estimated && is_chamber(signal);
      const SensorEffects<double> left =
          behind_correction(rig.sensor_effects[of_port ? port_signals[side_of(signal)] : signal]);
      sensors_[signal].configure(left, 0.0, 0.0, rig.period_s, Random());
      has_sensor_effects_ =
          has_sensor_effects_ || left.sensor_gain.gain != 1.0 || left.sensor_lag.time_constant_s > 0.0;
    }
  }
  Sample sample() noexcept {
    const auto port = plant_.port_pressure(), chamber = plant_.chamber_pressure();
    const Sample truth{plant_.position(), {low(port), high(port)}, {low(chamber), high(chamber)}};
    if (!has_sensor_effects_) return truth;
    return {sensors_[Signal::x].read(truth.position_m),
            {sensors_[Signal::p1_port].read(truth.port_Pa[0]), sensors_[Signal::p2_port].read(truth.port_Pa[1])},
            {sensors_[Signal::p1_chamber].read(truth.chamber_Pa[0]),
             sensors_[Signal::p2_chamber].read(truth.chamber_Pa[1])}};
  }

  AxisPlant<double> plant_;
  AxisController law_;
  double resting_force_N_ = 0.0, area_1_m2_ = 1.0, area_2_m2_ = 1.0, atmosphere_force_N_ = 0.0;
  int cells_ = 1;
  bool chambers_ = true, aged_ = false, droops_ = false;
  std::array<double, 2> command_V_{};
  double speed_mps_ = 0.0;
  PerSignal<Sensor> sensors_;  // exact but for the config's effects; those of the chambers close a force loop
  bool has_sensor_effects_ = false;
  Sample now_, seen_;  // of this tick and of the one before
};

}  // namespace pneuservo
