// Results of the verb `run`: plain structs that the JSON, the table on the screen and the page are made from.
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pneuservo/loop/timing.hpp>
#include <pneuservo/record/row.hpp>

#include <report/pressure_metrics.hpp>

namespace pneuservo {

/// Figures of one run over its evaluation window; NaN where the rows do not hold what a figure needs.
struct Metrics {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  double from_s = none, to_s = none;  ///< evaluation window, from the start of the run; cut to the rows there are
  bool position_is_true = false;  ///< errors are against the simulated plant's position, not the encoder's
  double max_position_error_m = none;
  double rms_position_error_m = none;
  double end_error_m = none;  ///< mean error over the last 0.1 s of the window, with its sign
  double max_estimation_error_Pa = none;  ///< the larger of both chambers
  double rms_estimation_error_Pa = none;  ///< the larger of both chambers
  double chamber_pressure_ripple_Pa = none;  ///< peak to peak above 3.5 Hz, the larger of both chambers
  double command_step_rms_V = none;  ///< of u_k - u_{k-1}
};

/// How far the axis went along with its reference; the limits stand in report/motion_verdict.hpp.
enum class Following { not_judged, rests, follows, lags, does_not_follow };

/// What the axis did in one run. Text, JSON and page say it from here alone.
struct MotionVerdict {
  Following following = Following::not_judged;
  double amplitude_m = Metrics::none;      ///< half the reference's travel in the evaluation window
  double error_share = Metrics::none;      ///< largest error over amplitude_m
  double lag_s = Metrics::none;  ///< by which the position comes after the reference; NaN: no such relation
  double amplitude_ratio = Metrics::none;  ///< of the position over the reference, at that lag
  bool oscillates = false;  ///< a periodic part that neither the reference nor noise explains
  double oscillation_Hz = Metrics::none, oscillation_m = Metrics::none, oscillation_V = Metrics::none;  ///< amplitudes
  bool oscillation_grows = false, oscillation_fills_range = false;
  bool touched_end_stop = false;
  double end_stop_m = Metrics::none, end_stop_s = Metrics::none;  ///< of the first contact; time from the run's start
  double end_stop_speed_mps = Metrics::none;  ///< the fastest contact
  std::string fault;  ///< name of the first fault; empty: none
};

/// Ordered names and values, shown as they stand.
using Facts = std::vector<std::pair<std::string, std::string>>;

/// One pressure source and move.
struct RunResult {
  std::string pressure_source;  ///< a word of pressure_source_names
  std::string feedforward = "none";  ///< "none", "formula", "pass"; of a pressure law "flow"
  int move = 1;
  double start_s = 0.0;  ///< time in `rows` at which this run's reference started
  std::vector<Row> rows;  ///< the whole run, or evenly thinned
  std::vector<std::string> faults;  ///< "name: meaning", in the order in which they came
  double fault_s = Metrics::none;  ///< of the first one, on the time axis of `rows`
  double deviation_limit_m = Metrics::none;  ///< permitted between measured and predicted position; NaN: not checked
  std::int64_t ticks = 0;
  std::int64_t overruns = 0;
  std::optional<LoopTiming> timing;  ///< real time only
  Metrics metrics;
  MotionVerdict verdict;
  std::optional<PressureMetrics> pressure;  ///< of a pressure rig, in place of metrics and verdict
};

/// Everything that one call of `run` found out.
struct RunReport {
  std::string config;  ///< the config's name
  std::string time = "simulated";  ///< "simulated" or "real"
  double duration_s = 0.0;  ///< of one run that comes to its end
  double period_s = 0.0;  ///< of the loop
  double shown_from_s = Metrics::none;  ///< of a long run only the rows from here on were kept; NaN: all were
  std::vector<RunResult> runs;
  double realtime_factor = Metrics::none;  ///< simulated seconds a second of wall time
  std::string config_yaml;  ///< the config as it was used, every key, for the page
  Facts machine;  ///< kernel, policy, code path, version, ...
  Facts channel_origins;  ///< channel, "real" | "simulated" | "replayed" | "absent"
};

}  // namespace pneuservo
