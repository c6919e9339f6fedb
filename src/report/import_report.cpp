// What was understood of a foreign recording, in a table and a page.
#include <report/import_report.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <report/html_page.hpp>

namespace pneuservo {
namespace {

/// First run that has the column.
const std::vector<double>* values_of(const ImportResult& result, const std::string& column) {
  for (const Recording& run : result.runs)
    if (run.has(column)) return &run.column(column);
  return nullptr;
}

std::string range_text(const std::vector<double>* values) {
  double low = infinite, high = -infinite;
  if (values != nullptr)
    for (const double value : *values)
      if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  return low <= high ? fmt::format("{:.5g} to {:.5g}", low, high) : "no value";
}

std::string unit_of(const std::string& column) {
  const std::size_t at = column.rfind('_');
  return at == std::string::npos ? "" : column.substr(at + 1);
}

Tone tone_of_column(const std::string& column) {
  if (column.find("chamber") != std::string::npos) return Tone::chamber;
  if (column.find("supply") != std::string::npos) return Tone::fourth;
  return column.starts_with("p2") ? Tone::estimated : Tone::valve;
}

/// The course of one column with a hole wherever rows are missing.
Curve curve_of(const Recording& run, const std::string& column) {
  Curve curve{column, tone_of_column(column), {}, {}, false, false};
  const std::vector<double>&t = run.t_s(), &y = run.column(column);
  const double longest = 3 * row_interval_s(run);
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (i > 0 && t[i] - t[i - 1] > longest) {
      curve.x.push_back(0.5 * (t[i - 1] + t[i]));
      curve.y.push_back(std::nan(""));
    }
    curve.x.push_back(t[i]);
    curve.y.push_back(y[i]);
  }
  return curve;
}

/// One plot a unit: pressures stand together.
std::vector<Plot> plots_of(const Recording& run, const std::string& group) {
  std::vector<Plot> plots;
  for (const std::string& column : run.names) {
    if (column == "t_s") continue;
    const std::string unit = unit_of(column);
    auto at = std::find_if(plots.begin(), plots.end(), [&](const Plot& plot) { return plot.unit == unit; });
    if (at == plots.end()) {
      plots.push_back({});
      at = plots.end() - 1;
      at->title = unit == "Pa" ? "pressures" : column;
      at->unit = unit;
      at->group = group;
    }
    if (at->curves.size() < 6) at->curves.push_back(curve_of(run, column));
  }
  return plots;
}

std::size_t gap_count(const Recording& run) {
  const std::vector<double>& t = run.t_s();
  std::size_t gaps = 0;
  for (std::size_t i = 1; i < t.size(); ++i) gaps += t[i] - t[i - 1] > 1.5 * run.period_s;
  return gaps;
}

}  // namespace

Table import_table(const ImportResult& result) {
  std::vector<std::string> names, ours, units, ranges, evidence;
  for (const ColumnGuess& guess : result.columns) {
    names.push_back(guess.column);
    ours.push_back(guess.ours.empty() ? "-" : guess.ours);
    units.push_back(guess.unit.empty() ? "-" : guess.unit);
    ranges.push_back(guess.ours.empty() ? "" : range_text(values_of(result, guess.ours)));
    evidence.push_back(guess.evidence);
  }
  return {"Columns",
          {text_column("column", names), text_column("taken for", ours), text_column("unit", units),
           text_column("range in SI", ranges), text_column("evidence", evidence)}};
}

Table runs_table(const ImportResult& result) {
  std::vector<std::int64_t> rows, missing, gaps;
  std::vector<double> from, to, interval;
  for (const Recording& run : result.runs) {
    rows.push_back(static_cast<std::int64_t>(run.rows()));
    from.push_back(run.t_s().front());
    to.push_back(run.t_s().back());
    interval.push_back(1e3 * run.period_s);
    gaps.push_back(static_cast<std::int64_t>(gap_count(run)));
    missing.push_back(static_cast<std::int64_t>(run.missing_rows));
  }
  return {"Runs",
          {count_column("rows", rows), figure_column("from", "s", from), figure_column("to", "s", to),
           figure_column("interval", "ms", interval), count_column("gaps", gaps),
           count_column("rows missing", missing)}};
}

void write_import_report(const ImportResult& result, const std::string& path) {
  const std::string name = std::filesystem::path(result.path).filename().string();
  std::size_t known = 0;
  for (const ColumnGuess& guess : result.columns) known += !guess.ours.empty();
  HtmlPage page(name + " · import", fmt::format("{} · import", name),
                fmt::format("{} of {} columns are understood", known, result.columns.size()));
  for (const std::string& doubt : result.doubts) page.alert(doubt);
  page.section("What was understood");
  page.table(import_table(result));
  page.table(runs_table(result));
  for (const std::string& line : result.understood) page.paragraph(line);
  page.section("Channels over time", "In SI units. A hole is a gap in time.");
  std::vector<std::string> names;
  for (std::size_t r = 0; r < result.runs.size(); ++r) names.push_back(fmt::format("run {}", r + 1));
  page.panels_begin(names, 0);
  for (std::size_t r = 0; r < result.runs.size(); ++r) {
    page.panel(r);
    for (const Plot& plot : plots_of(result.runs[r], names[r])) page.plot(plot);
  }
  page.panels_end();
  page.section("For the config");
  page.details("Section import", result.section);
  page.write(path);
}

}  // namespace pneuservo
