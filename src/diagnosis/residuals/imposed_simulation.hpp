// The simulation of one recording's gas in lanes, sample by sample: its command and its motion are imposed.
#pragma once
#include <algorithm>
#include <limits>
#include <utility>

#include "diagnosis/residuals/imposed_run.hpp"

namespace pneuservo::imposed {

inline constexpr double highest_pressure_Pa = 1e7;
/// How fast the gas follows the measured port pressures at the start. Slowly, through the mass of a whole side: a
/// pressure imposed at the port would turn line and chamber into a resonator that rings with the sensor's noise.
inline constexpr double follow_s = 0.1;

/// Motion that the slider made where its sensor read this one: y = gain lag(x) + offset turned round.
inline double true_value(const SensorEffects<double>& sensor, double reading, double rate) {
  return (reading - sensor.sensor_offset.offset + sensor.sensor_lag.time_constant_s * rate) / sensor.sensor_gain.gain;
}

template <class S> class ImposedSimulation {
 public:
  using P = Pair<S>;

  ImposedSimulation(const ImposedInputs& inputs, std::span<const ImposedRun> runs, const PlantGrid& grid,
                    const StopQuestion& stop)
      : inputs_(inputs), runs_(runs), stop_(stop), courses_(runs.size()) {
    auto axis = cast<AxisParameters<S>>(runs[0].rig->axis);
    for (std::size_t i = 1; i < runs.size(); ++i) set_parameters_lane(axis, static_cast<int>(i), runs[i].rig->axis);
    plant_.configure(axis, inputs.step_s(), grid, valve_arrangement(*runs[0].rig));
  }

  std::vector<GasCourse> run() {
    const std::size_t samples = inputs_.samples();
    for (GasCourse& course : courses_)
      for (const Signal signal : inputs_.wanted) course[signal].resize(samples);
    begin();
    store(0);
    for (std::size_t k = 0; k + 1 < samples; ++k) {
      advance(k, P(0));
      store(k + 1);
      look_sometimes();
    }
    for (GasCourse& course : courses_) refuse_absurd(course);
    return std::move(courses_);
  }
  /// The gas at sample 0.
  void begin() {
    const P start = port_pressures(0);
    plant_.reset({position(0), low(start), high(start)});
  }
  /// From sample k to the next, with more command to each side's spool.
  void advance(std::size_t k, const P& more_command_V) {
    for (int step = 0; step < inputs_.steps; ++step) {
      if (!inputs_.supply_Pa.empty()) plant_.impose_valve_supply(supply(k, step));
      const S to(step + 1 < inputs_.steps ? position_within(k, step) : position(k + 1));
      plant_.step_led(S(inputs_.command_at(0, k, step)) + low(more_command_V),
                      S(inputs_.command_at(1, k, step)) + high(more_command_V), to);
    }
    if (k + 1 < inputs_.release) follow_ports(k + 1);
    if (k + 1 == inputs_.release) plant_.scale_gas(P(1), start_factors());
  }
  /// From here on, beside what is measured of the supply.
  void add_to_measured_supply(const S& pressure_Pa) { more_supply_Pa_ = pressure_Pa; }
  AxisPlant<S>& plant() { return plant_; }
  const AxisPlant<S>& plant() const { return plant_; }

 private:
  template <class Value> S each_lane(Value&& value) const {
    S out(value(runs_[0]));
    for (std::size_t i = 1; i < runs_.size(); ++i) set_lane(out, static_cast<int>(i), value(runs_[i]));
    return out;
  }
  S position(std::size_t k) const {
    return each_lane([&](const ImposedRun& run) {
      return true_value(run.rig->sensor_effects[Signal::x], inputs_.position_m[k], inputs_.velocity_mps[k]);
    });
  }
  S position_within(std::size_t k, int step) const {
    return each_lane([&](const ImposedRun& run) {
      return true_value(run.rig->sensor_effects[Signal::x], inputs_.position_at(k, step), inputs_.velocity_mps[k]);
    });
  }
  S supply(std::size_t k, int step) const {
    const S measured = each_lane([&](const ImposedRun& run) {
      return true_value(run.rig->sensor_effects[Signal::p_supply], inputs_.supply_at(k, step),
                        inputs_.supply_Pa_per_s[k]);
    });
    return maximum(measured + more_supply_Pa_, S(1e4));
  }
  P port_pressures(std::size_t k) const {
    const auto side = [&](std::size_t i) {
      return each_lane([&](const ImposedRun& run) {
        return true_value(run.rig->sensor_effects[inputs_.start_sensor[i]], inputs_.start_Pa[i][k],
                          inputs_.start_Pa_per_s[i][k]);
      });
    };
    return maximum(join(side(0), side(1)), P(1e4));
  }
  P start_factors() const {
    const auto side = [&](std::size_t i) {
      return each_lane([&](const ImposedRun& run) { return 1.0 + run.start_factor[i]; });
    };
    return join(side(0), side(1));
  }
  /// Brings the gas a part of the way to the measured port pressures: their running mean, then what they do slowly.
  void follow_ports(std::size_t k) {
    const double gain = std::max(1.0 / static_cast<double>(k + 1), inputs_.period_s / follow_s);
    plant_.scale_gas(P(1) + P(gain) * (port_pressures(k) / plant_.port_pressure() - P(1)), P(1));
  }
  void store(std::size_t k) {
    const PerSignal<S> values = true_values(plant_);
    for (const Signal signal : inputs_.wanted)
      for (std::size_t i = 0; i < runs_.size(); ++i) courses_[i][signal][k] = lane(values[signal], static_cast<int>(i));
  }
  /// At the latest after steps_between_looks steps of the plant, or one sample that has more.
  void look_sometimes() {
    steps_ += inputs_.steps;
    if (steps_ < steps_between_looks) return;
    steps_ = 0;
    look_for_stop(stop_);
  }
  static void refuse_absurd(GasCourse& course) {
    const bool is_possible = std::ranges::all_of(pressure_signals, [&](Signal signal) {
      return std::ranges::all_of(
          course[signal], [](double value) { return value > 0.0 && value < highest_pressure_Pa; });  // not of NaN
    });
    if (is_possible) return;
    for (auto& all : course.all) std::ranges::fill(all, std::numeric_limits<double>::quiet_NaN());
  }

  const ImposedInputs& inputs_;
  std::span<const ImposedRun> runs_;
  const StopQuestion& stop_;
  S more_supply_Pa_ = S(0);
  int steps_ = 0;  ///< of the plant since the last look
  std::vector<GasCourse> courses_;
  AxisPlant<S> plant_;
};

}  // namespace pneuservo::imposed
