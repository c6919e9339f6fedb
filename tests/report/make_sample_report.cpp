// Writes a page from synthetic rows: `make_sample_report OUT.html simulated|real`; tests/system/report_page_test.py
// opens it.
#include <algorithm>
#include <iostream>
#include <random>

#include <report/evaluation.hpp>
#include <report/run_report.hpp>
#include <report/run_summary.hpp>

#include "synthetic_rows.hpp"

using namespace pneuservo;
using test::wave;

namespace {

RunResult sample_run(const std::string& source, double error_m, double swing_Pa, bool real) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, 1.0);
  RunResult run;
  run.pressure_source = source;
  run.rows = test::make_rows(10.0, 1e-3, [&](Row& row) {
    const double t_s = row.t_s, ramp = std::min(1.0, t_s);
    row.x_ref_m = 0.08 * ramp * wave(1.0, t_s);
    row.x_true_m = row.x_ref_m - error_m * (ramp * wave(1.0, t_s - 0.1) + 0.2 * wave(8.0, t_s));
    row.measured[Signal::x] = row.x_true_m;
    row.u_V = 3.0 * ramp * wave(1.0, t_s + 0.2) + 0.01 * noise(random);
    row.p1_chamber_true_Pa = 4.7e5 + 6e4 * ramp * wave(1.0, t_s + 0.15) + swing_Pa * wave(12.0, t_s);
    row.p2_chamber_true_Pa = 5.4e5 - 5e4 * ramp * wave(1.0, t_s + 0.15) - swing_Pa * wave(12.0, t_s);
    row.measured[Signal::p1_port] =
        row.p1_chamber_true_Pa + 1.7e4 * ramp * wave(1.0, t_s + 0.2) + 300.0 * noise(random);
    row.measured[Signal::p2_port] =
        row.p2_chamber_true_Pa - 1.6e4 * ramp * wave(1.0, t_s + 0.2) + 300.0 * noise(random);
    row.measured[Signal::p1_chamber] = row.p1_chamber_true_Pa + 300.0 * noise(random);
    row.measured[Signal::p2_chamber] = row.p2_chamber_true_Pa + 300.0 * noise(random);
    row.p1_estimated_Pa = row.p1_chamber_true_Pa + 500.0 * ramp * wave(2.0, t_s) + 60.0 * noise(random);
    row.p2_estimated_Pa = row.p2_chamber_true_Pa + 350.0 * ramp * wave(2.0, t_s) + 60.0 * noise(random);
    row.p1_bound_Pa = row.p2_bound_Pa = 800.0 + 400.0 * ramp * std::fabs(wave(1.0, t_s));
    if (real) row.x_true_m = row.p1_chamber_true_Pa = row.p2_chamber_true_Pa = Row::none;
  });
  run.ticks = static_cast<std::int64_t>(run.rows.size());
  return run;
}

LoopTiming sample_timing() {
  std::mt19937_64 random(11);
  std::lognormal_distribution<double> spread(0.0, 0.35);
  LoopTiming timing;
  for (int k = 0; k < 10000; ++k) {
    const auto lateness_ns = static_cast<std::int64_t>(3000.0 * spread(random) * (k % 900 == 0 ? 20.0 : 1.0));
    const auto backend_ns = static_cast<std::int64_t>(1000.0 * spread(random));
    timing.lateness.add(lateness_ns);
    timing.loop.add(static_cast<std::int64_t>(300.0 * spread(random)));
    timing.estimator.add(static_cast<std::int64_t>(220.0 * spread(random)));
    timing.controller.add(static_cast<std::int64_t>(90.0 * spread(random)));
    timing.backend.add(backend_ns);
    timing.keep_worst({k, lateness_ns, backend_ns + 600});
  }
  return timing;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::cerr << "usage: make_sample_report OUT.html simulated|real\n", 2;
  const bool real = std::string(argv[2]) == "real";
  Rig rig;
  rig.reference.kind = ReferenceKind::sine;
  rig.reference.amplitude_m = 0.08;
  rig.reference.frequency_Hz = 1.0;
  RunReport report;
  report.config = "sample <10 m & 7.65 mm>";
  report.time = argv[2];
  report.duration_s = 10.0;
  report.config_yaml = "name: sample\nnote: \"</script><script>document.title = 'broken'</script>\"\n";
  report.machine = {{"kernel", "6.1.0 PREEMPT_DYNAMIC"}, {"code path", "x86-64-v3"}};
  report.channel_origins = {{"x", real ? "real" : "simulated"}, {"p1_port", real ? "real" : "simulated"}};
  if (real) {
    report.runs = {sample_run("estimated", 0.0012, 900.0, true)};
    report.runs[0].timing = sample_timing();
    report.runs[0].rows.resize(7321);
    report.runs[0].rows.back().flags |= row_fault;
    report.runs[0].faults = {"port pressure 1 is not valid <stuck at 0 Pa> at 7.320 s"};
  } else {
    report.realtime_factor = 2600.0;
    report.runs = {sample_run("valve", 0.0081, 4000.0, false), sample_run("chamber", 0.0013, 2000.0, false),
                   sample_run("estimated", 0.0012, 900.0, false)};
  }
  for (RunResult& run : report.runs) run.metrics = evaluate(rig, run.rows);
  write_run_report(report, rig, argv[1]);
  std::cout << run_text(report);
}
