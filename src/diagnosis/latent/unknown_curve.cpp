// Tables of the config for what no name explains.
#include "diagnosis/latent/unknown_curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "config/effects_reader.hpp"
#include "config/rig_parameters.hpp"
#include "config/section_reader.hpp"
#include "diagnosis/residuals/known_rows.hpp"
#include "diagnosis/search/candidates.hpp"

namespace pneuservo {

namespace {

constexpr int most_steps = 8;  ///< a fit ends before, where a step gains less than a tenth in chi2

/// Tables that are fitted together, and what their points stand over.
struct TableSet {
  std::vector<std::string> effects;
  std::string over;
};

std::vector<TableSet> tables_at(const Rig& rig, const std::string& element, bool is_whole) {
  std::vector<TableSet> out;
  if (element == "valve") {
    TableSet edges{{}, "command"};
    for (const std::string& name : effect_names(rig))
      if (find_effect(name)->family == "linearity") edges.effects.push_back(name);
    if (!edges.effects.empty()) out.push_back(std::move(edges));
    return out;
  }
  const std::string place = element.starts_with("line_") ? "chamber_" + element.substr(5) : element;
  for (const std::string& name : effect_names(rig)) {
    const EffectEntry* entry = find_effect(name);
    if (entry->role != EffectRole::table || on_side_of(entry->element, name) != place) continue;
    if (entry->over != "time" || is_whole) out.push_back({{name}, std::string(entry->over)});
  }
  return out;
}

/// What a table stands over, at every row that tells something of it, in ascending order.
std::vector<double> places_passed(ResidualModel& model, const Hypothesis& owner, const TableSet& table) {
  std::vector<double> out;
  if (table.over == "pressure") {
    // The chamber's own sensor, else that of its port.
    const std::string side = "p" + std::string(split_effect(table.effects.front()).side);
    for (const std::string& name : {side + "_chamber", side + "_port"}) {
      if (!out.empty()) break;
      for (const ResidualCourse& course : model.courses(owner))
        if (model.channels()[static_cast<std::size_t>(course.channel)].name == name)
          out.insert(out.end(), course.measured.begin(), course.measured.end());
    }
  } else {
    std::map<int, double> begins_s;
    for (const ResidualRow& row : model.rows()) {
      double& begin_s = begins_s.try_emplace(row.recording, row.time_s).first->second;
      begin_s = std::min(begin_s, row.time_s);
    }
    for (const ResidualRow& row : model.rows())
      if (!row.over_recording)
        out.push_back(table.over == "position" ? row.position_m
                      : table.over == "speed"  ? std::abs(row.velocity_mps)
                                               : row.time_s - begins_s[row.recording]);
  }
  std::erase_if(out, [](double value) { return !std::isfinite(value); });
  std::sort(out.begin(), out.end());
  // An end that a two-hundredth of all rows reaches is told by noise: a value there has the prior's error.
  const auto rare = static_cast<std::ptrdiff_t>(out.size() / 200);
  return {out.begin() + rare, out.end() - rare};
}

/// Half by way and half by rows: where a machine rests most rows are, and where it moves between them most of its law.
/// No two lie closer than a fiftieth of all.
std::vector<double> points_over(const std::vector<double>& passed) {
  const double first = passed.front(), range = passed.back() - first;
  const auto last = static_cast<double>(passed.size() - 1);
  const auto share = [&](std::size_t i) {
    return 0.5 * static_cast<double>(i) / last + 0.5 * (passed[i] - first) / range;
  };
  std::vector<double> out{first};
  std::size_t next = 1;
  for (std::size_t i = 1, last_point = PointTable<double>::points - 1; i <= last_point; ++i) {
    const double wanted = static_cast<double>(i) / static_cast<double>(last_point);
    while (next + 1 < passed.size() && share(next) < wanted) ++next;
    const double before = share(next - 1), part = std::clamp((wanted - before) / (share(next) - before), 0.0, 1.0);
    const double least = out.back() + range / 50,
                 most = passed.back() - range / 50 * static_cast<double>(last_point - i);
    out.push_back(std::min(std::max(passed[next - 1] + part * (passed[next] - passed[next - 1]), least), most));
  }
  return out;
}

/// The rig with the points of the table, all values nothing; nothing where no range is passed. A valve's shares have
/// their places.
std::optional<Rig> with_places(const Rig& rig, ResidualModel& model, const Hypothesis& owner, const TableSet& table) {
  if (table.over == "command") return rig;
  const std::vector<double> passed = places_passed(model, owner, table);
  if (passed.size() < 2 || !(passed.back() > passed.front())) return std::nullopt;
  const std::vector<double> points = points_over(passed);
  Rig out = rig;
  visit_effects(rig, [&](const Field& field, const auto& effect) {
    if (field.key != table.effects.front()) return;
    const std::vector<Field> keys = fields_of(effect);  // places first
    for (std::size_t i = 0; i < points.size(); ++i)
      set_parameter(out, fmt::format("effects.{}.{}", field.key, keys[i].key), points[i]);
  });
  return out;
}

/// A fit without a slow error, brought to its minimum there where it had one.
Fit plain(FittedRows& rows, const Fit& fit) {
  Fit out = fit;
  out.freed_from.reset();
  out.known_columns.assign(out.parameters.size(), 0);
  linearise(rows, {&out});
  if (fit.freed_from && !out.failed) improve(rows, {&out}, most_steps, Columns::corrected);
  return out;
}

Fit fit_beside(FittedRows& rows, const Rig& rig, const Fit& beside, const TableSet& table) {
  std::vector<FreeParameter> values;
  for (const std::string& effect : table.effects)
    for (FreeParameter& value : table_values(rig, effect, motion_range(rows.model().rows())))
      values.push_back(std::move(value));
  Fit fit = fit_at_start(rig, rows, std::move(values), beside.parameters);
  fit.base.start_factors = beside.base.start_factors;
  fit.base.swing_Pa = beside.base.swing_Pa;
  fit.base.swing_Hz = beside.base.swing_Hz;
  for (const auto& [i, k] : shared_parameters(fit, beside)) {
    fit.z(i) = beside.z(k);
    fit.jacobian.col(i) = beside.jacobian.col(k);
    fit.known_columns[static_cast<std::size_t>(i)] = static_cast<std::size_t>(i) >= fit.own_count;
  }
  for (std::size_t i = 0; i < fit.own_count; ++i)
    fit.z(static_cast<Eigen::Index>(i)) = std::clamp(0.0, fit.parameters[i].lower, fit.parameters[i].upper);
  linearise(rows, {&fit});
  if (!fit.failed) improve(rows, {&fit}, most_steps, Columns::corrected);
  return fit;
}

/// Its points, with the standard errors of what rows leave above their floors (Birge's ratio).
void add_points(const Fit& fit, const TableSet& table, UnknownCurve& out) {
  const auto rows = static_cast<double>(fit.residual.size());
  const Eigen::MatrixXd covariance = std::max(1.0, fit.chi2() / rows) * fit.covariance();
  const bool is_of_edges = table.over == "command";
  const std::size_t each = fit.own_count / table.effects.size();
  for (std::size_t i = 0; i < fit.own_count; ++i) {
    const FreeParameter& value = fit.parameters[i];
    const auto at = static_cast<Eigen::Index>(i);
    UnknownCurve::Point point{0, value.value(fit.z(at)), value.slope(fit.z(at)) * std::sqrt(covariance(at, at))};
    if (is_of_edges) {
      const double way = ValveLinearity<double>::ways.at(i % each) * fit.base.rig.axis.valve.command_max_V;
      point.place = table.effects[i / each].ends_with("backward") ? -way : way;
    }
    out.points.push_back(point);
  }
  if (!is_of_edges) {
    visit_effects(fit.base.rig, [&](const Field& field, const auto& effect) {
      if (field.key != table.effects.front()) return;
      std::size_t i = 0;
      std::remove_cvref_t<decltype(effect)>::visit(
          [&](const Field&, double place) {
            if (i < out.points.size()) out.points[i].place = place;
            ++i;
          },
          effect);
    });
  }
  std::stable_sort(out.points.begin(), out.points.end(),
                   [](const auto& a, const auto& b) { return a.place < b.place; });
}

/// Units of places and values, as the keys of the table say.
void add_units(const Rig& rig, const TableSet& table, UnknownCurve& out) {
  visit_effects(rig, [&](const Field& field, const auto& effect) {
    if (field.key != table.effects.front()) return;
    const std::vector<Field> keys = fields_of(effect);
    out.over_unit = table.over == "command" ? "V" : std::string(keys.front().unit);
    out.unit = keys.back().unit;
  });
}

std::vector<ChannelFit> channels_of(ResidualModel& model, const Search& search, const Fit& fit) {
  const std::vector<ChannelMisfit> before = misfit_at(model, search.as_configured()), after = misfit_at(model, fit);
  const std::vector<double> floors = floors_of_misfit(model);
  std::vector<ChannelFit> out;
  for (std::size_t c = 0; c < floors.size(); ++c)
    out.push_back({model.channels()[c].column(), floors[c], before[c].fitted, after[c].fitted, before[c].held_out,
                   after[c].held_out, std::numeric_limits<double>::quiet_NaN()});
  return out;
}

/// Mean square of what a fit leaves of held-out samples, in floors; 0: none are held out.
double held_out_square(const std::vector<ChannelFit>& channels) {
  double out = 0;
  for (const ChannelFit& c : channels)
    if (c.noise > 0 && std::isfinite(c.held_out_after)) out += std::pow(c.held_out_after / c.noise, 2);
  return out;
}

}  // namespace

std::optional<UnknownCurve> curve_of_unknown(const Rig& rig, ResidualModel& model, const Search& search,
                                             const CurvePlace& where, const DecisionRules& rules,
                                             const StopQuestion& stop) {
  FittedRows rows(model, stop);
  const Fit beside = plain(rows, where.beside->fit);
  if (beside.failed) return std::nullopt;
  struct Tried {
    Fit fit;
    TableSet table;
  };
  std::vector<Tried> tried;
  for (TableSet& table : tables_at(rig, where.element, where.is_whole)) {
    const std::optional<Rig> placed = with_places(rig, model, beside.hypothesis(), table);
    if (!placed) continue;
    Fit fit = fit_beside(rows, *placed, beside, table);
    if (!fit.failed && fit.log_evidence() - beside.log_evidence() >= rules.alarm_gain)
      tried.push_back({std::move(fit), std::move(table)});
  }
  std::ranges::sort(tried, [](const Tried& a, const Tried& b) { return a.fit.log_evidence() > b.fit.log_evidence(); });
  const double left = held_out_square(channels_of(model, search, beside));
  for (const Tried& one : tried) {
    const std::vector<ChannelFit> channels = channels_of(model, search, one.fit);
    if (left > 0 && held_out_square(channels) >= left) continue;  // it follows what no fit saw no better
    UnknownCurve out;
    out.effects = one.table.effects;
    out.over = one.table.over;
    for (const std::size_t member : where.beside->members) out.beside.push_back(search.candidates()[member].name);
    out.gain = one.fit.log_evidence() - beside.log_evidence();
    out.improved = one.fit.hypothesis().rig;
    out.channels = channels;
    add_points(one.fit, one.table, out);
    add_units(out.improved, one.table, out);
    return out;
  }
  return std::nullopt;
}

}  // namespace pneuservo
