// The JSON and the text of `run`: exactly the keys of the contract, null for what is not known, units in the headers.
#include <catch2/catch.hpp>

#include <report/run_json.hpp>
#include <report/run_summary.hpp>

using namespace pneuservo;

namespace {

std::vector<std::string> keys(const nlohmann::ordered_json& json) {
  std::vector<std::string> names;
  for (const auto& item : json.items()) names.push_back(item.key());
  return names;
}

RunResult result(const std::string& source, double rms_m) {
  RunResult run;
  run.pressure_source = source;
  run.ticks = 10000;
  run.metrics.rms_position_error_m = rms_m;
  run.metrics.max_position_error_m = 2.5 * rms_m;
  run.verdict.following = Following::follows;
  run.verdict.amplitude_m = 0.08;
  run.verdict.error_share = 2.5 * rms_m / 0.08;
  return run;
}

RunReport three_sources() {
  RunReport report;
  report.config = "cylinder-10m-7.65mm";
  report.duration_s = 10.0;
  report.period_s = 1e-3;
  report.realtime_factor = 2600.0;
  report.runs = {result("valve", 0.0082), result("chamber", 0.0013), result("estimated", 0.0012)};
  return report;
}

LoopTiming timing() {
  LoopTiming timing;
  for (int k = 1; k <= 1000; ++k) timing.lateness.add(std::int64_t{100} * k);
  timing.loop.add(300);
  timing.estimator.add(200);
  timing.controller.add(100);
  timing.backend.add(1000);
  timing.page_faults = 2;
  timing.context_switches_involuntary = 3;
  timing.keep_worst({17, 90000, 2000});
  return timing;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("in simulated time the JSON has the contract's keys and no latency") {
  const auto json = run_json(three_sources());
  REQUIRE(keys(json) == std::vector<std::string>{"config", "time", "duration_s", "runs", "realtime_factor"});
  REQUIRE(json["runs"].size() == 3);
  REQUIRE(keys(json["runs"][0]) ==
          std::vector<std::string>{"pressure_source", "feedforward", "move", "max_position_error_m",
                                   "rms_position_error_m", "end_error_m", "max_estimation_error_Pa",
                                   "rms_estimation_error_Pa", "chamber_pressure_ripple_Pa", "command_step_rms_V",
                                   "motion", "faults", "ticks", "overruns"});
  REQUIRE(json["runs"][0]["rms_position_error_m"] == 0.0082);
  REQUIRE(json["runs"][0]["end_error_m"].is_null());
  REQUIRE(json["runs"][0]["faults"].is_array());
}

TEST_CASE("in real time every run has its latencies, and no realtime factor is null") {
  RunReport report = three_sources();
  report.time = "real";
  report.realtime_factor = Metrics::none;
  report.runs[0].timing = timing();
  const auto json = run_json(report);
  const auto& run = json["runs"][0];
  const auto names = keys(run);
  REQUIRE(std::vector<std::string>(names.begin() + 14, names.end()) ==
          std::vector<std::string>{"lateness_us", "work_us", "tick_us", "loop_us", "estimator_us", "controller_us",
                                   "backend_us", "page_faults", "context_switches_involuntary",
                                   "lateness_histogram_us"});
  REQUIRE(keys(run["lateness_us"]) == std::vector<std::string>{"mean", "p50", "p99", "p99_9", "p99_99", "max"});
  REQUIRE(keys(run["work_us"]) == keys(run["lateness_us"]));
  REQUIRE(run["lateness_us"]["p50"].get<double>() == Approx(50.0).epsilon(0.02));
  REQUIRE(run["lateness_us"]["max"].get<double>() == Approx(100.0));
  REQUIRE(run["page_faults"] == 2);
  REQUIRE(run["context_switches_involuntary"] == 3);
  REQUIRE(json["realtime_factor"].is_null());
  REQUIRE_FALSE(json["runs"][1].contains("lateness_us"));
}

TEST_CASE("the headline names the best source without a fault") {
  RunReport report = three_sources();
  REQUIRE(best_run(report) == 2);
  REQUIRE(headline(report) == "Estimated chamber pressures hold the position best: 1.20 mm rms error, 3.00 mm at most, "
                              "3.75 % of the amplitude of 80.0 mm; against 1.30 mm with measured chamber pressures and "
                              "8.20 mm with the valve's port "
                              "pressures (rms).");
  report.runs[2].faults = {"position sensor invalid at 3.214 s"};
  REQUIRE(best_run(report) == 1);
  REQUIRE(
      contains(headline(report), "estimated chamber pressures ended in a fault: position sensor invalid at 3.214 s."));
  report.runs.clear();
  REQUIRE(headline(report) == "No run was made.");
}

TEST_CASE("no run is praised that does not follow or swings, and one judgement stands in text and JSON") {
  RunReport report = three_sources();
  for (RunResult& run : report.runs) {
    run.verdict.following = Following::does_not_follow;
    run.verdict.error_share = 0.9;
  }
  CHECK(contains(headline(report),
                 "Estimated chamber pressures come closest to the reference, the axis does not follow "
                 "its reference: "));
  report.runs[2].verdict.following = Following::follows;
  report.runs[2].verdict.oscillates = true;
  report.runs[2].verdict.oscillation_Hz = 27.0;
  report.runs[2].verdict.oscillation_m = 4e-4;
  report.runs[2].verdict.oscillation_V = 1.0;
  CHECK(contains(headline(report),
                 "With estimated chamber pressures it oscillates at 27.0 Hz: the position by ±0.400 mm, "
                 "the command by ±1.00 V."));
  report.runs.erase(report.runs.begin(), report.runs.begin() + 2);
  CHECK(contains(headline(report), "the axis follows its reference: "));
  CHECK(contains(headline(report), " It oscillates at 27.0 Hz"));
  const auto motion = run_json(report)["runs"][0]["motion"];
  CHECK(motion["word"] == "oscillates");
  CHECK(motion["oscillation_Hz"] == 27.0);
  report.runs[0].verdict.touched_end_stop = true;
  report.runs[0].verdict.end_stop_m = -0.15;
  CHECK(contains(headline(report), "It touched the end stop at -150 mm"));
  CHECK(run_json(report)["runs"][0]["motion"]["word"] == "end_stop");
  report.runs[0].faults = {"deviation: far off"};
  report.runs[0].verdict.fault = "deviation";
  report.runs[0].fault_s = 3.236;
  CHECK(contains(headline(report), "ended in a fault at t = 3.236 s: deviation. It oscillates at 27.0 Hz"));
}

TEST_CASE("the text aligns figures under their units and lists faults and latencies") {
  RunReport report = three_sources();
  report.runs[1].faults = {"supply pressure out of range"};
  report.runs[1].timing = timing();
  const std::string text = run_text(report);
  REQUIRE(contains(text, "simulated time, 10 s, 2600 times as fast as real time"));
  for (RunResult& run : report.runs) run.ticks = 3237;
  REQUIRE(contains(run_text(report), "simulated time, ended after 3.237 of 10 s"));
  REQUIRE(contains(text, "[mm]"));
  REQUIRE(contains(text, "[kPa]"));
  REQUIRE(contains(text, "[mV]"));
  REQUIRE(contains(text, "fault (chamber): supply pressure out of range"));
  REQUIRE(contains(text, "p99.99"));
  REQUIRE(contains(text, "worst cycles (chamber)"));
}

TEST_CASE("a column of figures has one number of decimals, and a dash for what is not known") {
  REQUIRE(figure_column("", "mm", {12.345678, 0.1}).cells == std::vector<std::string>{"12.35", "0.10"});
  REQUIRE(figure_column("", "mm", {8.2, 0.00123}).cells == std::vector<std::string>{"8.2000", "0.0012"});
  REQUIRE(figure_column("", "mm", {123456.0}).cells == std::vector<std::string>{"123456"});
  REQUIRE(figure_column("", "mm", {0.0, Metrics::none}).cells == std::vector<std::string>{"0", "–"});
  Table table;
  table.columns = {text_column("name", {"a", "bcd"}), figure_column("value", "mm", {1.0, 20.0})};
  REQUIRE(text_table(table) == "name  value\n       [mm]\na      1.00\nbcd   20.00\n");
}
