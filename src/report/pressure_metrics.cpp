// Figures of a run that controls a pressure.
#include <report/pressure_metrics.hpp>

#include <algorithm>
#include <cmath>

namespace pneuservo {
namespace {

constexpr double time_slack_s = 1e-9;

struct Errors {
  double largest = 0.0, square_sum = 0.0;
  std::size_t count = 0;
  void add(double value) {
    if (!std::isfinite(value)) return;
    largest = std::max(largest, std::fabs(value));
    square_sum += value * value;
    ++count;
  }
  double maximum() const { return count > 0 ? largest : PressureMetrics::none; }
  double rms() const { return count > 0 ? std::sqrt(square_sum / static_cast<double>(count)) : PressureMetrics::none; }
};

/// Where the volume's pressure is taken from.
RowColumn pressure_of(const std::vector<Row>& rows, std::string& name) {
  const auto has = [&](RowColumn column) {
    return std::ranges::any_of(rows, [&](const Row& row) { return std::isfinite(column.of(row)); });
  };
  name = "true";
  if (has(&Row::p1_chamber_true_Pa)) return &Row::p1_chamber_true_Pa;
  name = "measured";
  if (has(Signal::p1_chamber)) return Signal::p1_chamber;
  name = "estimated";
  return &Row::p1_estimated_Pa;
}

/// Stretches of rows in which the reference keeps one value, at least `fewest` rows long.
struct Rest {
  std::size_t begin = 0, end = 0;
};
std::vector<Rest> rests_of(const std::vector<Row>& rows, std::size_t fewest) {
  std::vector<Rest> rests;
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i + 1;
    while (end < rows.size() && rows[end].p_ref_Pa == rows[i].p_ref_Pa) ++end;
    if (end - i >= fewest) rests.push_back({i, end});
    i = end;
  }
  return rests;
}

PressureStep step_of(const std::vector<Row>& rows, RowColumn pressure, const Rest& before, const Rest& after,
                     double start_s) {
  PressureStep step;
  const double from_Pa = rows[before.begin].p_ref_Pa, to_Pa = rows[after.begin].p_ref_Pa;
  const double height_Pa = to_Pa - from_Pa, sign = height_Pa > 0.0 ? 1.0 : -1.0;
  step.start_s = rows[before.end - 1].t_s - start_s;
  step.end_s = rows[after.end - 1].t_s - start_s;
  step.from_Pa = from_Pa;
  step.to_Pa = to_Pa;
  step.settling_s = 0.0;
  for (std::size_t i = before.end; i < after.end; ++i) {
    const double off_Pa = pressure.of(rows[i]) - to_Pa;
    step.overshoot_share = std::max(step.overshoot_share, sign * off_Pa / std::fabs(height_Pa));
    const double t_s = rows[i].t_s - start_s;
    if (t_s >= 0.5 * (step.start_s + step.end_s))
      step.settled_error_Pa = std::max(step.settled_error_Pa, std::fabs(off_Pa));
    if (std::fabs(off_Pa) <= settled_share * std::fabs(height_Pa)) continue;
    step.settling_s = i + 1 == after.end ? PressureMetrics::none : t_s - step.start_s;
  }
  return step;
}

}  // namespace

PressureMetrics evaluate_pressure(const Rig& rig, const std::vector<Row>& all, double start_s) {
  constexpr double shortest_rest_s = 0.05;
  PressureMetrics out;
  std::vector<Row> rows;
  const double from_s = rig.evaluation ? rig.evaluation->from_s : 0.0;
  const double to_s = rig.evaluation ? rig.evaluation->to_s : rig.duration_s;
  for (const Row& row : all)
    if (const double t_s = row.t_s - start_s;
        row.fault == 0 && std::isfinite(row.p_ref_Pa) && t_s >= from_s - time_slack_s && t_s <= to_s + time_slack_s)
      rows.push_back(row);
  if (rows.size() < 2) return out;
  out.from_s = rows.front().t_s - start_s;
  out.to_s = rows.back().t_s - start_s;
  const RowColumn pressure = pressure_of(rows, out.pressure);
  const RowColumn judge = out.pressure == "true" ? RowColumn(&Row::p1_chamber_true_Pa) : Signal::p1_chamber;
  Errors error, estimation, command;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    error.add(rows[i].p_ref_Pa - pressure.of(rows[i]));
    estimation.add(rows[i].p1_estimated_Pa - judge.of(rows[i]));
    if (i > 0) command.add(rows[i].u_V - rows[i - 1].u_V);
  }
  out.max_error_Pa = error.maximum();
  out.rms_error_Pa = error.rms();
  out.max_estimation_error_Pa = estimation.maximum();
  out.rms_estimation_error_Pa = estimation.rms();
  out.command_step_rms_V = command.rms();
  const auto rests = rests_of(rows, static_cast<std::size_t>(std::ceil(shortest_rest_s / rig.period_s)));
  for (std::size_t i = 1; i < rests.size(); ++i)
    if (rows[rests[i].begin].p_ref_Pa != rows[rests[i - 1].begin].p_ref_Pa)
      out.steps.push_back(step_of(rows, pressure, rests[i - 1], rests[i], start_s));
  for (const PressureStep& step : out.steps) {
    out.max_overshoot_share = std::fmax(out.max_overshoot_share, step.overshoot_share);
    out.max_settling_s = std::fmax(out.max_settling_s, step.settling_s);
    out.max_settled_error_Pa = std::fmax(out.max_settled_error_Pa, step.settled_error_Pa);
  }
  if (std::ranges::any_of(out.steps, [](const PressureStep& step) { return std::isnan(step.settling_s); }))
    out.max_settling_s = PressureMetrics::none;
  return out;
}

}  // namespace pneuservo
