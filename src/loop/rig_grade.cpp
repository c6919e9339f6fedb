// Grading what a config asks for, one function a grade.
#include "loop/rig_grade.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "rig/bus_load.hpp"

namespace pneuservo {
namespace {

using Level = FindingLevel;
using Findings = std::vector<Finding>;

void add(Findings& findings, Level level, std::string topic, std::string what, std::string remedy) {
  findings.push_back({level, std::move(topic), std::move(what), std::move(remedy)});
}

/// Explicit steps that a pressure wave forces on one period: it may cross at most one cell a step.
double wave_steps_per_period(const Rig& rig, double cells_per_m) {
  return rig.period_s * Air<double>(rig.axis.air).sound_speed() * cells_per_m;
}

void grade_period(const Rig& rig, Findings& findings) {
  // Without lines there is nothing that asks for more than one step.
  const double wave_steps = rig.valves() > 0 ? wave_steps_per_period(rig, rig.estimator.cells_per_m) : 1.0;
  const double steps = std::max(1.0, std::ceil(wave_steps));
  const std::string what = fmt::format("{:g} us, at least {:.0f} estimator step{} of {:.0f} us each",
                                       rig.period_s * 1e6, steps, steps > 1 ? "s" : "", rig.period_s * 1e6 / steps);
  if (rig.period_s < 50e-6)
    add(findings, Level::bad, "period_s", what + ": shorter than the wake-up latency of most machines",
        "choose period_s of 0.0001 or more, see 'pneuservo latency'");
  else if (steps > 20) add(findings, Level::acceptable, "period_s", what, "lower estimator.cells_per_m or period_s");
  else add(findings, Level::good, "period_s", what, "");
}

void grade_command_range(const Rig& rig, Findings& findings) {
  const auto& valve = rig.axis.valve;
  const double full_V = valve.area_max_m2 / valve.area_per_volt_m2_per_V;
  if (rig.safe_output.command_V != 0)
    add(findings, Level::acceptable, "safe_output.command_V",
        fmt::format("{:g} V: holds only a valve that closes there", rig.safe_output.command_V),
        "choose the command at which the valve was measured to close, 0 unless it has an offset");
  if (full_V < 0.5 * valve.command_max_V)
    add(findings, Level::acceptable, "valve.area_max_m2",
        fmt::format("is reached at {:.3g} V of {:g} V: the rest of the range does nothing", full_V,
                    valve.command_max_V),
        "check valve.area_max_m2 and valve.area_per_volt_m2_per_V, or lower valve.command_max_V");
  else
    add(findings, Level::good, "valve range",
        fmt::format("+-{:g} V, fully open at {:.3g} V", valve.command_max_V, full_V), "");
}

const PressureSensorParameters& fed_back_pressure(const Rig& rig) {
  return rig.controller.takes_chambers() ? rig.sensors.chamber_pressure : rig.sensors.port_pressure;
}

void grade_gains(const Rig& rig, Findings& findings) {
  const auto& controller = rig.controller.of<PdForce>();
  const std::size_t before = findings.size();
  const auto zero = [&](double gain, Level level, const char* key, const char* meaning) {
    if (gain == 0)
      add(findings, level, std::string("controller.") + key, std::string("is 0: ") + meaning, "choose a value above 0");
  };
  zero(controller.position_gain_N_per_m, Level::bad, "position_gain_N_per_m",
       "nothing pulls the slider to its reference");
  zero(controller.force_gain_V_per_N, Level::bad, "force_gain_V_per_N", "the valve is never opened by the force loop");
  zero(controller.velocity_gain_Ns_per_m, Level::acceptable, "velocity_gain_Ns_per_m",
       "the position loop is not damped");
  if (findings.size() == before) add(findings, Level::good, "controller gains", "none of the three is 0", "");
  if (controller.velocity_filter_s > 0 && controller.velocity_filter_s < rig.period_s)
    add(findings, Level::acceptable, "controller.velocity_filter_s",
        fmt::format("{:g} s is shorter than the period: it filters little", controller.velocity_filter_s),
        "choose two periods or more");
}

void grade_noise(const Rig& rig, Findings& findings) {
  const auto& pressure = fed_back_pressure(rig);
  const double command_V = command_noise_rms_V(rig), share = command_V / rig.axis.valve.command_max_V;
  const std::string what =
      fmt::format("moves the command by about {:.2g} V rms, {:.2g} % of its range", command_V, 100 * share);
  if (share > 0.05)
    add(findings, Level::acceptable, "sensor noise", what,
        "lower controller.force_gain_V_per_N or velocity_gain_Ns_per_m, or lengthen velocity_filter_s");
  else add(findings, Level::good, "sensor noise", what, "");
  if (pressure.noise_Pa == 0 && pressure.quantum_Pa == 0)
    add(findings, Level::acceptable, "pressure sensors",
        "have neither noise nor quantum: the simulation is kinder than a rig",
        "give noise_Pa and quantum_Pa of the sensors' data sheet");
}

void grade_bus(const Rig& rig, Findings& findings) {
  if (!rig.hal || !rig.hal->can) return;
  const BusLoad load = bus_load(rig);
  const std::string what = bus_load_text(load, rig.period_s);
  const char* remedy =
      rig.period_s < 0.001
          ? "classic CAN carries one full frame in 200 us: close this loop over DA/AD boards in the PC, "
            "or choose period_s of 0.001 or more"
          : "choose a longer period_s, fewer bytes, or put channels on DA/AD boards";
  if (load.share > bus_load_limit) add(findings, Level::bad, "bus load", what, remedy);
  else if (load.share > bus_load_comfortable) add(findings, Level::acceptable, "bus load", what, remedy);
  else add(findings, Level::good, "bus load", what, "");
  if (rig.hal->channels.u.can && rig.safe_output.command_V != 0.0)
    add(findings, Level::acceptable, "substitute output",
        fmt::format("{:g} V is written into the device: makers align 0x6444 differently", rig.safe_output.command_V),
        "measure the output after unplugging the bus, or choose safe_output.command_V of 0");
}

}  // namespace

double command_noise_rms_V(const Rig& rig) {
  const PdForceParameters& controller = rig.controller.of<PdForce>();
  const double force_N =
      fed_back_pressure(rig).rms_Pa() * std::hypot(rig.axis.cylinder.area_1_m2, rig.axis.cylinder.area_2_m2);
  const double smoothing = 1 - std::exp(-rig.period_s / std::max(controller.velocity_filter_s, 1e-9));
  const double velocity_mps = rig.sensors.position.rms_m() * smoothing * std::sqrt(2.0) / rig.period_s;
  return controller.force_gain_V_per_N * std::hypot(force_N, controller.velocity_gain_Ns_per_m * velocity_mps);
}

std::vector<Finding> grade_rig(const Rig& rig) {
  Findings findings;
  const bool has_valve = rig.valves() > 0, has_force_loop = has_valve && rig.controller.is<PdForce>();
  grade_period(rig, findings);
  if (has_valve) grade_command_range(rig, findings);
  if (has_force_loop) grade_gains(rig, findings);
  if (has_force_loop) grade_noise(rig, findings);
  grade_bus(rig, findings);
  return findings;
}

}  // namespace pneuservo
