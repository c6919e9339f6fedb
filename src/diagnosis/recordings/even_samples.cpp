// Columns of a recording on an even grid of its own interval.
#include "diagnosis/recordings/even_samples.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "record/drawn_value.hpp"

namespace pneuservo {

namespace {

/// Of an interval: rows this close to their sample are taken as they stand. At 1 m/s and 1 ms that is a micrometre.
constexpr double same_place = 1e-3;
/// A gap of 20 ms is drawn through, between rows 0.2 ms apart by 100 samples: a grid with more is none of its rows'.
constexpr double most_samples_a_row = 100;

/// The power of ten that all times are multiples of; 0: finer than a tenth of a microsecond.
double decimal_of(const std::vector<double>& time_s, std::size_t count) {
  double step_s = 1.0;
  for (std::size_t i = 1; i < count; ++i) {
    const double since_s = time_s[i] - time_s[0];
    while (std::abs(since_s / step_s - std::round(since_s / step_s)) > 1e-2) {
      step_s /= 10;
      if (step_s < 1e-7) return 0;
    }
  }
  return step_s;
}

}  // namespace

double longest_drawn_s(double interval_s) { return std::max(0.02, 3.5 * interval_s); }

EvenSamples::EvenSamples(const std::vector<double>& time_s, double interval_s, double longest_s)
    : interval_s_(interval_s) {
  for (std::size_t i = 0; i < time_s.size() && time_s[i] - time_s[0] <= longest_s; ++i) {
    place_.push_back((time_s[i] - time_s[0]) / interval_s);
    const double whole = std::round(place_.back());
    if (std::abs(place_.back() - whole) <= same_place) place_.back() = whole;
    else is_even_ = false;
  }
  if (place_.empty()) return;
  if (!is_even_) take_rounded_places(decimal_of(time_s, place_.size()) / interval_s);
  const double count = std::floor(place_.back() + same_place) + 1;
  if (!(count <= most_samples_a_row * static_cast<double>(place_.size())))
    throw InputError(
        fmt::format("found {} rows in {:.4g} s, whose interval is taken for {:.4g} s: expected a row for one "
                    "of {:.0f} samples at least",
                    place_.size(), time_s[place_.size() - 1] - time_s[0], interval_s, most_samples_a_row));
  count_ = static_cast<std::size_t>(count);
}

/// Between the earliest and the latest of rounded stamps lies no more than the rounding.
void EvenSamples::take_rounded_places(double rounding) {
  double early = 0, late = 0;
  for (const double place : place_) {
    early = std::min(early, place - std::round(place));
    late = std::max(late, place - std::round(place));
  }
  if (rounding >= 0.5 || late - early > rounding + 2 * same_place) return;
  for (double& place : place_) place = std::round(place);
  is_even_ = true;
}

std::vector<double> EvenSamples::placed(const std::vector<double>& values) const {
  if (is_even_) {
    std::vector<double> out(count_, no_value);
    for (std::size_t i = 0; i < place_.size(); ++i) out[static_cast<std::size_t>(place_[i])] = values[i];
    return out;
  }
  return straight(values);
}

std::vector<double> EvenSamples::drawn(const std::vector<double>& values, bool is_cubic, double later) const {
  std::vector<double> place, known, steps, out(count_, no_value);
  for (std::size_t i = 0; i < place_.size(); ++i)
    if (std::isfinite(values[i])) {
      const double at = place_[i] - later;
      if (!place.empty()) steps.push_back(at - place.back());
      place.push_back(at);
      known.push_back(values[i]);
    }
  if (place.empty()) return out;
  double own = 1;  // a column that is written every n-th row has steps of n
  if (!steps.empty()) {
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    own = *middle;
  }
  const double longest = longest_drawn_s(own * interval_s_) / interval_s_;
  for (std::size_t i = 0; i + 1 < place.size(); ++i) {
    if (place[i + 1] - place[i] > longest) continue;
    const double from = std::max(0.0, std::ceil(place[i]));
    for (auto k = static_cast<std::size_t>(from); static_cast<double>(k) < place[i + 1] && k < count_; ++k)
      out[k] = drawn_value(place, known, i, static_cast<double>(k), is_cubic ? longest : 0);
  }
  for (std::size_t i = 0; i < place.size(); ++i)  // a row at its place stands as it is
    if (place[i] >= 0 && place[i] == std::round(place[i]) && place[i] < static_cast<double>(count_))
      out[static_cast<std::size_t>(place[i])] = known[i];
  return out;
}

double drawing_error(const std::vector<double>& time_s, const std::vector<double>& values, double interval_s) {
  double squares = 0, count = 0;
  for (std::size_t i = 2; i + 2 < values.size(); ++i) {
    if (std::abs(time_s[i + 2] - time_s[i - 2] - 4 * interval_s) > 0.2 * interval_s) continue;
    const double error = (4 * (values[i - 1] + values[i + 1]) - values[i - 2] - values[i + 2]) / 6 - values[i];
    if (!std::isfinite(error)) continue;
    squares += error * error;
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : 0;
}

}  // namespace pneuservo
