// Figures of a run over its evaluation window.
#include <report/evaluation.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <pneuservo/elements/sensor.hpp>

#include <report/even_signal.hpp>
#include <report/high_pass.hpp>

namespace pneuservo {
namespace {

constexpr double time_tolerance_s = 1e-9;
constexpr std::array<RowColumn, 3> commands{&Row::u_V, &Row::u1_V, &Row::u2_V};

bool has_values(const std::vector<Row>& rows, RowColumn column) {
  return std::any_of(rows.begin(), rows.end(), [&](const Row& row) { return std::isfinite(column.of(row)); });
}

/// Largest magnitude, mean and root mean square of what is added; values that are not finite are left out.
struct Statistics {
  double largest = 0.0, sum = 0.0, square_sum = 0.0;
  std::int64_t count = 0;

  void add(double value) {
    if (!std::isfinite(value)) return;
    largest = std::max(largest, std::fabs(value));
    sum += value;
    square_sum += value * value;
    ++count;
  }
  double maximum() const { return count > 0 ? largest : Metrics::none; }
  double mean() const { return count > 0 ? sum / static_cast<double>(count) : Metrics::none; }
  double rms() const { return count > 0 ? std::sqrt(square_sum / static_cast<double>(count)) : Metrics::none; }
};

/// The larger of two figures, of which either may be missing.
double larger(double a, double b) { return std::fmax(a, b); }

/// Peak to peak of a column above the corner. One period of the corner at either end of the signal is left out: there
/// the filter has neighbours on one side only.
double ripple_Pa(const std::vector<Row>& rows, RowColumn column, double from_s, double to_s) {
  const EvenSignal signal = even_signal(rows, column);
  const std::vector<double> fast = zero_phase_high_pass(signal.values, signal.period_s, ripple_corner_Hz);
  const double end_s = signal.from_s + static_cast<double>(fast.size()) * signal.period_s - 1.0 / ripple_corner_Hz;
  from_s = std::max(from_s, signal.from_s + 1.0 / ripple_corner_Hz);
  to_s = std::min(to_s, end_s);
  double lowest = Metrics::none, highest = Metrics::none;
  for (std::size_t k = 0; k < fast.size(); ++k) {
    const double t_s = signal.from_s + static_cast<double>(k) * signal.period_s;
    if (t_s < from_s - time_tolerance_s || t_s > to_s + time_tolerance_s) continue;
    lowest = std::fmin(lowest, fast[k]);
    highest = std::fmax(highest, fast[k]);
  }
  return highest - lowest;
}

}  // namespace

EvaluationWindow evaluation_window(const Rig& rig, double run_duration_s) {
  if (rig.evaluation) return {rig.evaluation->from_s, rig.evaluation->to_s};
  if (needs_file(rig.reference)) return {0.0, run_duration_s};  // its end stands in the file alone
  const Reference reference(rig.reference);
  const bool moves = reference.end_s() > reference.start_s();
  if (!reference.is_move() || !moves) return {0.5 * run_duration_s, run_duration_s};
  return {reference.start_s(), reference.end_s() + settling_s};
}

Metrics evaluate(const Rig& rig, const std::vector<Row>& rows, double start_s) {
  Metrics metrics;
  if (rows.size() < 2) return metrics;
  const double last_s = rows.back().t_s - start_s;
  const EvaluationWindow window = evaluation_window(rig, last_s + sampling_period_s(rows));
  metrics.from_s = window.from_s;
  metrics.to_s = std::min(window.to_s, last_s);
  metrics.position_is_true = has_values(rows, &Row::x_true_m);
  const auto position_m = [&](const Row& row) {
    return metrics.position_is_true ? row.x_true_m : corrected(rig.sensor_effects[Signal::x], row.measured[Signal::x]);
  };

  const double from_s = metrics.from_s + start_s, to_s = metrics.to_s + start_s;
  Statistics error, end_error, estimation_1, estimation_2;
  std::array<Statistics, 3> command_step;  // of the one valve, or of either of two
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row& row = rows[k];
    if (row.t_s < from_s - time_tolerance_s || row.t_s > to_s + time_tolerance_s) continue;
    error.add(row.x_ref_m - position_m(row));
    if (row.t_s > to_s - end_stretch_s + time_tolerance_s) end_error.add(row.x_ref_m - position_m(row));
    estimation_1.add(row.p1_estimated_Pa - row.p1_chamber_true_Pa);
    estimation_2.add(row.p2_estimated_Pa - row.p2_chamber_true_Pa);
    for (std::size_t i = 0; i < commands.size() && k > 0; ++i)
      command_step[i].add(commands[i].of(row) - commands[i].of(rows[k - 1]));
  }
  metrics.max_position_error_m = error.maximum();
  metrics.rms_position_error_m = error.rms();
  metrics.end_error_m = end_error.mean();
  metrics.max_estimation_error_Pa = larger(estimation_1.maximum(), estimation_2.maximum());
  metrics.rms_estimation_error_Pa = larger(estimation_1.rms(), estimation_2.rms());
  metrics.command_step_rms_V = larger(command_step[0].rms(), larger(command_step[1].rms(), command_step[2].rms()));
  const bool truth = has_values(rows, &Row::p1_chamber_true_Pa);
  metrics.chamber_pressure_ripple_Pa =
      larger(ripple_Pa(rows, truth ? RowColumn(&Row::p1_chamber_true_Pa) : Signal::p1_chamber, from_s, to_s),
             ripple_Pa(rows, truth ? RowColumn(&Row::p2_chamber_true_Pa) : Signal::p2_chamber, from_s, to_s));
  return metrics;
}

}  // namespace pneuservo
