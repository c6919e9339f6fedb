// The result of `run` as JSON.
#include <report/pressure_report.hpp>
#include <report/run_json.hpp>

#include <cmath>

#include <report/json_number.hpp>
#include <report/motion_verdict.hpp>

namespace pneuservo {
namespace {

Json quantiles_json(const TimeHistogram& times) {
  return {{"mean", times.mean_us()},
          {"p50", times.percentile_us(0.5)},
          {"p99", times.percentile_us(0.99)},
          {"p99_9", times.percentile_us(0.999)},
          {"p99_99", times.percentile_us(0.9999)},
          {"max", times.maximum_us()}};
}

void add_timing(Json& json, const LoopTiming& timing) {
  json["lateness_us"] = quantiles_json(timing.lateness);
  json["work_us"] = quantiles_json(timing.work);
  json["tick_us"] = quantiles_json(timing.tick);
  json["loop_us"] = quantiles_json(timing.loop);
  json["estimator_us"] = quantiles_json(timing.estimator);
  json["controller_us"] = quantiles_json(timing.controller);
  json["backend_us"] = quantiles_json(timing.backend);
  json["page_faults"] = timing.page_faults;
  json["context_switches_involuntary"] = timing.context_switches_involuntary;
  json["lateness_histogram_us"] = histogram_json(timing.lateness);
}

/// The same judgement that the headline tells.
Json verdict_json(const MotionVerdict& verdict) {
  Json json;
  json["word"] = verdict_word(verdict);
  json["following"] = following_names[static_cast<std::size_t>(verdict.following)];
  json["amplitude_m"] = number(verdict.amplitude_m);
  json["error_share"] = number(verdict.error_share);
  json["lag_s"] = number(verdict.lag_s);
  json["amplitude_ratio"] = number(verdict.amplitude_ratio);
  json["oscillates"] = verdict.oscillates;
  json["oscillation_Hz"] = number(verdict.oscillation_Hz);
  json["oscillation_m"] = number(verdict.oscillation_m);
  json["oscillation_V"] = number(verdict.oscillation_V);
  json["oscillation_grows"] = verdict.oscillation_grows;
  json["touched_end_stop"] = verdict.touched_end_stop;
  json["end_stop_m"] = number(verdict.end_stop_m);
  json["end_stop_s"] = number(verdict.end_stop_s);
  json["end_stop_speed_mps"] = number(verdict.end_stop_speed_mps);
  return json;
}

void add_ticks(Json& json, const RunResult& run) {
  json["faults"] = run.faults;
  json["ticks"] = run.ticks;
  json["overruns"] = run.overruns;
  if (run.timing) add_timing(json, *run.timing);
}

Json result_json(const RunResult& run) {
  const Metrics& metrics = run.metrics;
  Json json;
  json["pressure_source"] = run.pressure_source;
  json["feedforward"] = run.feedforward;
  json["move"] = run.move;
  if (run.pressure) {
    json["volume"] = pressure_json(*run.pressure);
    add_ticks(json, run);
    return json;
  }
  json["max_position_error_m"] = number(metrics.max_position_error_m);
  json["rms_position_error_m"] = number(metrics.rms_position_error_m);
  json["end_error_m"] = number(metrics.end_error_m);
  json["max_estimation_error_Pa"] = number(metrics.max_estimation_error_Pa);
  json["rms_estimation_error_Pa"] = number(metrics.rms_estimation_error_Pa);
  json["chamber_pressure_ripple_Pa"] = number(metrics.chamber_pressure_ripple_Pa);
  json["command_step_rms_V"] = number(metrics.command_step_rms_V);
  json["motion"] = verdict_json(run.verdict);
  json["motion"]["deviation_limit_m"] = number(run.deviation_limit_m);
  json["motion"]["fault_s"] = number(run.fault_s);
  add_ticks(json, run);
  return json;
}

}  // namespace

nlohmann::ordered_json histogram_json(const TimeHistogram& histogram) {
  Json bins = Json::array();
  for (int bin = 0; bin < TimeHistogram::bins; ++bin)
    if (histogram.bin_count(bin) > 0)
      bins.push_back({static_cast<double>(TimeHistogram::upper_ns(bin)) / 1e3, histogram.bin_count(bin)});
  return bins;
}

nlohmann::ordered_json run_json(const RunReport& report) {
  Json json;
  json["config"] = report.config;
  json["time"] = report.time;
  json["duration_s"] = number(report.duration_s);
  if (std::isfinite(report.shown_from_s)) json["shown_from_s"] = report.shown_from_s;
  json["runs"] = Json::array();
  for (const RunResult& run : report.runs) json["runs"].push_back(result_json(run));
  json["realtime_factor"] = number(report.realtime_factor);
  return json;
}

}  // namespace pneuservo
