// Rows of 2.2.2: the valve's inner loop, on the simulated spool.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <fmt/format.h>

#include <pneuservo/rig/valve_drive.hpp>

#include "design/axis_design.hpp"
#include "thesis/groups.hpp"
#include "thesis/pictures.hpp"

namespace pneuservo {

std::complex<double> spool_response(double set_Hz, double Hz) {
  constexpr double share = 0.1;
  ValveDrive drive;
  ValveDriveParameters parameters;
  parameters.loop.natural_frequency_Hz = set_Hz;
  drive.configure(parameters);
  const double w = 2.0 * std::numbers::pi * Hz, T = parameters.loop.period_s;
  // Whole periods, after 25 of them or 0.1 s.
  const int start = static_cast<int>(std::ceil(std::max(0.1, 25.0 / Hz) / T));
  const int ticks = static_cast<int>(std::lround(std::ceil(0.2 * Hz) / (Hz * T)));
  std::complex<double> sum = 0.0, input = 0.0;
  for (int k = 0; k < start + ticks; ++k) {
    const double wanted = share * std::sin(w * k * T);
    if (k >= start) {
      const std::complex<double> turn = std::exp(std::complex<double>(0.0, -w * k * T));
      sum += turn * drive.spool_m();
      input += turn * wanted * spool_stroke_m;
    }
    drive.step(wanted * parameters.command_max_V);
  }
  return sum / input;
}

namespace {

/// Frequency at which the amplitude has fallen to that share.
double falls_to_Hz(double set_Hz, double share) {
  double low = 0.5 * set_Hz, high = 2.0 * set_Hz;
  for (int i = 0; i < 20; ++i) {
    const double middle = std::sqrt(low * high);
    (std::abs(spool_response(set_Hz, middle)) > share ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

/// Largest error of the spool at rest, in per cent of its stroke, after steps to places all over it.
double rest_error_percent(double quantum_m) {
  ValveDriveParameters parameters;
  parameters.spool_quantum_m = quantum_m;
  constexpr int places = 37, ticks = 2000, settled = 1000;
  double most_m = 0.0;
  for (int place = 0; place < places; ++place) {
    const double wanted = -0.9 + 1.8 * place / (places - 1);
    ValveDrive drive;
    drive.configure(parameters);
    for (int k = 0; k < ticks; ++k) {
      drive.step(wanted * parameters.command_max_V);
      if (k >= settled) most_m = std::max(most_m, std::abs(drive.spool_m() - wanted * spool_stroke_m));
    }
  }
  return 100.0 * most_m / spool_stroke_m;
}

/// The table behind valves whose spool, coil and inner loop are simulated.
void add_rows_with_own_loop(std::vector<ThesisRow>& rows) {
  const std::string why = "spool, coil and inner loop in the simulated plant, as device and run have them with "
                          "simulation.valve_drive_period_s; the loop makes up for its one tick";
  const auto error_um = [](const ThesisCourse& course) { return 1e6 * course.max_error_m; };
  for (const char* quantum_m : {"0", "0.125e-6"})
    rows.push_back(
        run_row({.place = "2.2.2",
                 .what = fmt::format("4 mm table behind valves with their own loop, spool sensor of {} um: "
                                     "error of the printed move",
                                     std::string_view(quantum_m) == "0" ? "0" : "0.125"),
                 .unit = "um",
                 .printed = "no figure",
                 .held = std::string_view(quantum_m) == "0" ? "0.0814" : "0.0794",
                 .why = why},
                {table_4mm.config,
                 {"simulation.valve_drive_period_s=1e-4", fmt::format("simulation.spool_quantum_m={}", quantum_m),
                  "controller.command_delay_s=1e-4"}},
                error_um));
}

}  // namespace

ThesisGroup thesis_valve_group() {
  std::vector<ThesisRow> rows;
  // A lag of damping 0.7 has the amplitude 1/1.4 at its natural frequency. 0.5 %: whole periods do not end on a tick.
  for (const int set_Hz : {50, 100, 300})
    rows.push_back({.place = "Fig 2.7",
                    .what = fmt::format("spool set to {} Hz, moved 75 um: natural frequency", set_Hz),
                    .unit = "Hz",
                    .printed = std::to_string(set_Hz),
                    .plant = ThesisPlant::nonlinear,
                    .ours = [set_Hz](ThesisBench&) { return falls_to_Hz(set_Hz, 1.0 / 1.4); },
                    .within = searched_within});
  rows.push_back({.place = "2.2.2",
                  .what = "bandwidth (-3 dB) at 300 Hz",
                  .unit = "Hz",
                  .printed = "300",
                  .plant = ThesisPlant::nonlinear,
                  .ours = [](ThesisBench&) { return falls_to_Hz(300.0, std::sqrt(0.5)); },
                  .within = 0.02,
                  .why = "a lag of damping 0.7 reaches 1 % beyond its natural frequency"});
  rows.push_back({.place = "2.1.2",
                  .what = "error of the spool at rest, of its stroke, by a sensor of 0.125 um",
                  .unit = "%",
                  .printed = "0.1",
                  .plant = ThesisPlant::nonlinear,
                  .ours = [](ThesisBench&) { return rest_error_percent(0.125e-6); },
                  .held = "0.0100",
                  .why = "the simulated spool has no friction and no flow forces: its sensor's steps alone are left"});
  rows.push_back({.place = "Table 2.3",
                  .what = "K_Fc K_i/M_s = 13.62 x 1.0/0.061",
                  .unit = "m/(s2 V)",
                  .printed = "223.28",
                  .ours = [](ThesisBench&) { return SpoolMassParameters<double>{}.acceleration_per_volt_mps2_per_V; }});
  rows.push_back({.place = "Table 2.3",
                  .what = "period of the valve's loop",
                  .unit = "ms",
                  .printed = "0.1",
                  .ours = [](ThesisBench&) { return 1e3 * SpoolLoopParameters{}.period_s; }});
  rows.push_back({.place = "Fig 2.8",
                  .what = "area at half the command over area at all of it",
                  .printed = "linear",
                  .plant = ThesisPlant::config,
                  .ours =
                      [](ThesisBench& bench) {
                        const auto valve = bench.rig({table_4mm.config}).axis.valve;
                        return valve.area_per_volt_m2_per_V * 0.5 * valve.command_max_V / valve.area_max_m2;
                      },
                  .held = "0.50"});
  add_rows_with_own_loop(rows);
  return {"2.2.2 The servo valve", rows};
}

}  // namespace pneuservo
