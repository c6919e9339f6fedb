// A motion as any logger writes it, and what is understood of the file.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "record/files.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/import.hpp"

namespace pneuservo {

inline constexpr int row_count = 3000;
inline constexpr double interval_s = 0.001;

inline double x_m_at(int i) { return std::round(1e7 * 0.1 * std::sin(0.005 * i + 0.2)) * 1e-7; }
inline double u_V_at(int i) { return std::round(1e4 * 2 * std::cos(0.007 * i)) * 1e-4; }

/// Rows written by a function of number, time, position [m] and command [V].
inline std::string rows(const std::function<std::string(int, double, double, double)>& row) {
  std::string out;
  for (int i = 0; i < row_count; ++i) out += row(i, i * interval_s, x_m_at(i), u_V_at(i)) + "\n";
  return out;
}

inline std::string with_comma(std::string text) {
  std::replace(text.begin(), text.end(), '.', ',');
  return text;
}

struct Understood {
  std::vector<ColumnGuess> columns;
  Recording run;
  std::string told;
};

inline Understood understood(const std::string& bytes) {
  const TemporaryFolder folder;
  const CsvTable table = read_table(put_plain(folder.file("f.csv"), bytes));
  Understood out;
  out.columns = guess_columns(table);
  std::vector<Recording> runs = recordings_in(table, import_map(out.columns), 0.001);
  REQUIRE(runs.size() == 1);
  out.run = std::move(runs.front());
  for (const std::string& line : problem_lines(out.run)) out.told += line + "\n";
  return out;
}

/// All rows with the motion's values; what was told.
inline std::string check_motion(const std::string& bytes) {
  CAPTURE(bytes.substr(0, 300));
  const Understood found = understood(bytes);
  const Recording& run = found.run;
  REQUIRE(run.rows() == row_count);
  REQUIRE(run.has("x_m"));
  REQUIRE(run.has("u_V"));
  CHECK(run.period_s == Catch::Detail::Approx(interval_s).epsilon(1e-3));
  for (int i = 0; i < row_count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    REQUIRE(run.t_s()[at] - run.t_s()[0] == Catch::Detail::Approx(i * interval_s).margin(1e-6));
    REQUIRE(run.column("x_m")[at] == Catch::Detail::Approx(x_m_at(i)).margin(1e-9));
    REQUIRE(run.column("u_V")[at] == Catch::Detail::Approx(u_V_at(i)).margin(1e-9));
  }
  return found.told;
}

}  // namespace pneuservo
