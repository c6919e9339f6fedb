// The plots of a diagnosis: courses before and after, the residual over time and against what the machine does.
#include <report/diagnosis_plots.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <report/binned_mean.hpp>
#include <report/diagnosis_words.hpp>

#include "diagnosis/latent/latent_picture.hpp"
#include "diagnosis/recordings/held_out.hpp"

namespace pneuservo {
namespace {

/// Points that all curves of a page share; some 14 bytes each keep it near 2 MB.
constexpr std::size_t points_of_page = 110000;
constexpr std::size_t residual_bins = 40;
constexpr Tone measured_tone = Tone::neutral, before_tone = Tone::valve, after_tone = Tone::estimated;

const ResidualCourse* find(const std::vector<ResidualCourse>& courses, std::size_t channel, std::size_t recording) {
  for (const ResidualCourse& course : courses)
    if (course.channel == static_cast<int>(channel) && course.recording == static_cast<int>(recording)) return &course;
  return nullptr;
}

/// Unit that a reader has at hand, and the factor to it.
std::pair<std::string, double> handy_unit(const std::string& unit) {
  if (unit == "Pa") return {"kPa", 1e-3};
  if (unit == "m") return {"mm", 1e3};
  return {unit, 1.0};
}

std::size_t points_of_curve(const Diagnosis& diagnosis) {
  const std::size_t curves = 4 * std::max<std::size_t>(1, diagnosis.courses_before.size());
  return std::clamp<std::size_t>(points_of_page / curves, 400, 2400);
}

Plot time_plot(const Diagnosis& diagnosis, std::size_t channel, std::size_t recording) {
  Plot plot;
  plot.group = fmt::format("recording {}", recording);
  plot.x_step = diagnosis.configured.period_s;
  plot.points_max = points_of_curve(diagnosis);
  plot.title = diagnosis.residual_channels[channel].name;
  plot.unit = handy_unit(diagnosis.residual_channels[channel].unit).first;
  plot.height_px = 210;
  return plot;
}

/// x and y with a gap (NaN) wherever times are further apart than gap_s.
Curve time_curve(std::string name, Tone tone, const std::vector<double>& time, const std::vector<double>& values,
                 double factor, double gap_s) {
  Curve curve{std::move(name), tone, {}, {}, false, false};
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (i > 0 && time[i] - time[i - 1] > gap_s) {
      curve.x.push_back(0.5 * (time[i - 1] + time[i]));
      curve.y.push_back(std::nan(""));
    }
    curve.x.push_back(time[i]);
    curve.y.push_back(values[i] * factor);
  }
  return curve;
}

/// The residual rows of one channel of one recording, in the channel's unit.
struct DifferenceCourse {
  std::vector<double> time, before, after, sigma;
};

DifferenceCourse difference(const Diagnosis& diagnosis, std::size_t channel, std::size_t recording) {
  DifferenceCourse out;
  for (std::size_t i = 0; i < diagnosis.rows.size(); ++i) {
    const ResidualRow& row = diagnosis.rows[i];
    if (row.channel != static_cast<int>(channel) || row.recording != static_cast<int>(recording)) continue;
    out.time.push_back(row.time_s);
    out.before.push_back(diagnosis.residual_before[i] * row.sigma);
    out.after.push_back(diagnosis.residual_after[i] * row.sigma);
    out.sigma.push_back(row.sigma);
  }
  return out;
}

std::vector<std::pair<double, double>> held_out_windows(const Diagnosis& diagnosis, std::size_t channel,
                                                        std::size_t recording) {
  std::vector<std::pair<double, double>> windows;
  bool inside = false;
  for (const ResidualRow& row : diagnosis.rows) {
    if (row.channel != static_cast<int>(channel) || row.recording != static_cast<int>(recording)) continue;
    if (row.over_recording) continue;
    if (row.held_out && !inside) windows.emplace_back(row.time_s, row.time_s);
    if (row.held_out) windows.back().second = row.time_s;
    inside = row.held_out;
  }
  return windows;
}

Band floor_band(const DifferenceCourse& course, double factor) {
  Band band{"noise floor", Tone::neutral, course.time, {}, {}};
  for (const double sigma : course.sigma) {
    band.low.push_back(-factor * sigma);
    band.high.push_back(factor * sigma);
  }
  return band;
}

double root_mean_square(const Diagnosis& diagnosis, const std::vector<double>& residual, std::size_t channel) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < diagnosis.rows.size() && i < residual.size(); ++i)
    if (diagnosis.rows[i].channel == static_cast<int>(channel) && std::isfinite(residual[i])) {
      sum += residual[i] * residual[i];
      ++count;
    }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

void add_binned(Plot& plot, const std::string& name, Tone tone, const std::vector<double>& x,
                const std::vector<double>& y) {
  const BinnedMean binned = binned_mean(x, y, residual_bins);
  if (binned.center.empty()) return;
  plot.curves.push_back({name, tone, binned.center, binned.mean, false, false});
  Band spread{name + ", spread", tone, binned.center, {}, {}};
  for (std::size_t i = 0; i < binned.mean.size(); ++i) {
    spread.low.push_back(binned.mean[i] - binned.deviation[i]);
    spread.high.push_back(binned.mean[i] + binned.deviation[i]);
  }
  plot.bands.push_back(std::move(spread));
}

/// Title, unit and the factor to it.
struct AbscissaWords {
  std::string title, unit;
  double factor;
};

AbscissaWords words_of(ResidualAxis axis, const Rig& rig) {
  if (axis == ResidualAxis::position) return {"position", "mm", 1e3};
  if (axis == ResidualAxis::velocity) return {"speed", "mm/s", 1e3};
  return {"command", std::string(1, rig.is_pneumatic() ? 'V' : 'N'), 1};
}

}  // namespace

std::size_t recording_count(const Diagnosis& diagnosis) {
  std::size_t count = 0;
  for (const ResidualCourse& course : diagnosis.courses_before)
    count = std::max(count, static_cast<std::size_t>(course.recording) + 1);
  return count;
}

std::vector<std::size_t> channels_by_mismatch(const Diagnosis& diagnosis) {
  std::vector<std::pair<double, std::size_t>> sized;
  for (std::size_t c = 0; c < diagnosis.residual_channels.size(); ++c)
    sized.emplace_back(-root_mean_square(diagnosis, diagnosis.residual_before, c), c);
  std::stable_sort(sized.begin(), sized.end());
  std::vector<std::size_t> out;
  for (const auto& [size, channel] : sized) out.push_back(channel);
  return out;
}

Plot course_plot(const Diagnosis& diagnosis, std::size_t channel, std::size_t recording) {
  Plot plot = time_plot(diagnosis, channel, recording);
  const double factor = handy_unit(diagnosis.residual_channels[channel].unit).second;
  const ResidualCourse* before = find(diagnosis.courses_before, channel, recording);
  const ResidualCourse* after = find(diagnosis.courses_after, channel, recording);
  if (before == nullptr || before->time_s.empty()) return plot;
  const double gap_s = 30 * diagnosis.configured.period_s;
  const auto add = [&](const char* name, Tone tone, const ResidualCourse& course, const std::vector<double>& values) {
    plot.curves.push_back(time_curve(name, tone, course.time_s, values, factor, gap_s));
  };
  add("simulated, before", before_tone, *before, before->simulated);
  add("measured", measured_tone, *before, before->measured);
  if (after != nullptr) add("simulated, after", after_tone, *after, after->simulated);
  plot.curves.back().dashed = after != nullptr;  // what lies below shows between the dashes
  plot.windows = held_out_windows(diagnosis, channel, recording);
  return plot;
}

Plot difference_plot(const Diagnosis& diagnosis, std::size_t channel, std::size_t recording) {
  Plot plot = time_plot(diagnosis, channel, recording);
  plot.title += ", simulated − measured";
  const double factor = handy_unit(diagnosis.residual_channels[channel].unit).second;
  const DifferenceCourse course = difference(diagnosis, channel, recording);
  if (course.time.empty()) return plot;
  const double gap_s = 3 * residual_bin_s;
  plot.curves.push_back(time_curve("before", before_tone, course.time, course.before, factor, gap_s));
  plot.curves.push_back(time_curve("after", after_tone, course.time, course.after, factor, gap_s));
  plot.bands.push_back(floor_band(course, factor));
  plot.windows = held_out_windows(diagnosis, channel, recording);
  return plot;
}

Plot residual_plot(const Diagnosis& diagnosis, std::size_t channel, ResidualAxis axis) {
  const AbscissaWords words = words_of(axis, diagnosis.configured);
  const double factor = words.factor;
  Plot plot;
  plot.group.clear();
  plot.title = diagnosis.residual_channels[channel].name + " against ";
  plot.unit = "floors";
  plot.height_px = 220;
  plot.x_title = words.title;
  plot.x_unit = words.unit;
  plot.title += plot.x_title;
  std::vector<double> x, before, after;
  for (std::size_t i = 0; i < diagnosis.rows.size(); ++i) {
    const ResidualRow& row = diagnosis.rows[i];
    if (row.channel != static_cast<int>(channel)) continue;
    const double value = axis == ResidualAxis::position   ? row.position_m
                         : axis == ResidualAxis::velocity ? row.velocity_mps
                                                          : row.command_V;
    x.push_back(value * factor);
    before.push_back(diagnosis.residual_before[i]);
    after.push_back(diagnosis.residual_after[i]);
  }
  add_binned(plot, "before", before_tone, x, before);
  add_binned(plot, "after", after_tone, x, after);
  return plot;
}

Plot unknown_course_plot(const UnknownPicture& picture, int recording) {
  const HandyUnit handy = handy_unit_of(picture.unit);
  Plot plot;
  plot.title = fmt::format("{}, recording {}", picture.what, recording + 1);
  plot.unit = handy.unit;
  Curve course{"what is missing", after_tone, {}, {}, false, false};
  Band band{"two standard deviations", after_tone, {}, {}, {}};
  for (const PicturePoint& point : picture.points) {
    if (point.recording != recording) continue;
    const double value = handy.factor * point.mean, width = 2 * handy.factor * point.deviation;
    course.x.push_back(point.time_s);
    course.y.push_back(value);
    band.x.push_back(point.time_s);
    band.low.push_back(value - width);
    band.high.push_back(value + width);
  }
  plot.curves.push_back(std::move(course));
  plot.bands.push_back(std::move(band));
  return plot;
}

std::vector<Plot> unknown_plots(const UnknownPicture& picture) {
  struct Abscissa {
    const char *title, *unit;
    double factor;
    double PicturePoint::* member;
  };
  constexpr std::array abscissas{Abscissa{"position", "mm", 1e3, &PicturePoint::position_m},
                                 Abscissa{"velocity", "mm/s", 1e3, &PicturePoint::velocity_mps},
                                 Abscissa{"pressure of side 1", "kPa", 1e-3, &PicturePoint::p1_Pa},
                                 Abscissa{"pressure of side 2", "kPa", 1e-3, &PicturePoint::p2_Pa},
                                 Abscissa{"command", "V", 1, &PicturePoint::command_V}};
  const HandyUnit handy = handy_unit_of(picture.unit);
  std::vector<Plot> out;
  for (const Abscissa& abscissa : abscissas) {
    Plot plot;
    plot.group.clear();
    plot.title = fmt::format("against {}", abscissa.title);
    plot.unit = handy.unit;
    plot.x_title = abscissa.title;
    plot.x_unit = abscissa.unit;
    plot.height_px = 220;
    std::vector<double> x, y;
    for (const PicturePoint& point : picture.points)
      if (std::isfinite(point.*abscissa.member)) {
        x.push_back(abscissa.factor * point.*abscissa.member);
        y.push_back(handy.factor * point.mean);
      }
    add_binned(plot, "what is missing", after_tone, x, y);
    if (!plot.curves.empty()) out.push_back(std::move(plot));
  }
  return out;
}

Plot curve_plot(const UnknownCurve& curve) {
  const HandyUnit handy = handy_unit_of(curve.unit);
  Plot plot;
  plot.title = fmt::format("against {}", curve.over);
  plot.unit = handy.unit;
  const bool is_length = curve.over_unit.starts_with("m");  // m, m/s
  const HandyUnit over = is_length ? HandyUnit{"m" + curve.over_unit, 1e3} : handy_unit_of(curve.over_unit);
  const bool is_pressure = curve.over_unit == "Pa";
  plot.x_title = curve.over;
  plot.x_unit = is_length || is_pressure ? over.unit : curve.over_unit;
  const double factor = is_length || is_pressure ? over.factor : 1.0;
  Curve points{"table", after_tone, {}, {}, false, false};
  Band band{"two standard errors", after_tone, {}, {}, {}};
  for (const UnknownCurve::Point& point : curve.points) {
    const double value = handy.factor * point.value, width = 2 * handy.factor * point.standard_error;
    points.x.push_back(factor * point.place);
    points.y.push_back(value);
    band.x.push_back(factor * point.place);
    band.low.push_back(value - width);
    band.high.push_back(value + width);
  }
  plot.curves.push_back(std::move(points));
  plot.bands.push_back(std::move(band));
  return plot;
}

}  // namespace pneuservo
