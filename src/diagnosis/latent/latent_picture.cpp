// The picture of what no name explains.
#include "diagnosis/latent/latent_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include <fmt/format.h>

namespace pneuservo {

namespace {

constexpr std::size_t bins = 8;  ///< of equal counts, along each quantity
constexpr double normal_kg_per_m3 = 1.293;  ///< of air at 0 C and 101325 Pa (DIN 1343)
constexpr double told_share = 0.2;  ///< of the variance: a quantity that takes less tells nothing

/// One quantity that the function may go with.
struct Quantity {
  std::string name, unit;
  double factor;
  std::function<double(const PicturePoint&)> of;
  bool against_motion = false;  ///< the function is counted against the motion
};

std::vector<Quantity> quantities(const UnknownPicture& picture) {
  std::vector<Quantity> out{
      {"time", "s", 1, [](const PicturePoint& p) { return p.time_s; }},
      {"position", "mm", 1e3, [](const PicturePoint& p) { return p.position_m; }},
      {"velocity", "mm/s", 1e3, [](const PicturePoint& p) { return p.velocity_mps; }},
      {"p1", "kPa", 1e-3, [](const PicturePoint& p) { return p.p1_Pa; }},
      {"p2", "kPa", 1e-3, [](const PicturePoint& p) { return p.p2_Pa; }},
      {"command", "V", 1, [](const PicturePoint& p) { return p.command_V; }},
  };
  if (picture.element == "motion")
    out.push_back({"speed", "mm/s", 1e3, [](const PicturePoint& p) { return std::abs(p.velocity_mps); }, true});
  return out;
}

struct Binned {
  double from, to, mean;
};
/// Weighted means in bins of equal counts, and the share of the variance that they take beyond what chance gives them.
struct Relation {
  std::vector<Binned> bins;
  double share = 0;
};

Relation relation(const UnknownPicture& picture, const Quantity& quantity) {
  struct Value {
    double x, y, weight;
  };
  std::vector<Value> values;
  for (const PicturePoint& point : picture.points) {
    const double x = quantity.of(point), sign = quantity.against_motion ? (point.velocity_mps > 0 ? -1.0 : 1.0) : 1.0;
    if (std::isfinite(x) && point.deviation > 0)
      values.push_back({x, sign * point.mean, 1 / (point.deviation * point.deviation)});
  }
  if (values.size() < 4 * bins) return {};
  std::sort(values.begin(), values.end(), [](const Value& a, const Value& b) { return a.x < b.x; });
  const auto mean_of = [&](std::size_t first, std::size_t last) {
    double sum = 0, weight = 0;
    for (std::size_t i = first; i < last; ++i) sum += values[i].weight * values[i].y, weight += values[i].weight;
    return sum / weight;
  };
  // Of what counts from zero: a force against the motion that is everywhere the same is no force that changes.
  const double center = quantity.against_motion ? 0.0 : mean_of(0, values.size());
  Relation out;
  double all = 0, left = 0;
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t first = b * values.size() / bins, last = (b + 1) * values.size() / bins;
    const double mean = mean_of(first, last);
    out.bins.push_back({values[first].x, values[last - 1].x, mean});
    for (std::size_t i = first; i < last; ++i) {
      all += values[i].weight * (values[i].y - center) * (values[i].y - center);
      left += values[i].weight * (values[i].y - mean) * (values[i].y - mean);
    }
  }
  const double n = static_cast<double>(values.size()), chance = (n - 1) / (n - static_cast<double>(bins));
  out.share = all > 0 ? 1 - chance * left / all : 0;
  return out;
}

/// Course of the measured pressure of a side, by time; empty where none is measured.
std::map<int, const ResidualCourse*> measured(const std::vector<ResidualChannel>& channels,
                                              const std::vector<ResidualCourse>& courses, const std::string& side) {
  std::map<int, const ResidualCourse*> out;
  for (const ResidualCourse& course : courses) {
    const std::string& name = channels[static_cast<std::size_t>(course.channel)].name;
    if (name == side + "_chamber" || (name == side + "_port" && out.count(course.recording) == 0))
      out[course.recording] = &course;
  }
  return out;
}

double value_at(const std::map<int, const ResidualCourse*>& courses, int recording, double time_s) {
  const auto found = courses.find(recording);
  if (found == courses.end() || found->second->time_s.empty()) return std::nan("");
  const std::vector<double>& times = found->second->time_s;
  const auto next = std::lower_bound(times.begin(), times.end(), time_s);
  return found->second->measured[static_cast<std::size_t>(std::min(next, times.end() - 1) - times.begin())];
}

/// The row of a recording next to a time; nullptr: none within a tenth of a second.
const ResidualRow* row_at(const std::vector<ResidualRow>& rows, int recording, double time_s) {
  const ResidualRow* best = nullptr;
  for (const ResidualRow& row : rows)
    if (row.recording == recording && !row.over_recording &&
        std::abs(row.time_s - time_s) < (best ? std::abs(best->time_s - time_s) : 0.1))
      best = &row;
  return best;
}

}  // namespace

HandyUnit handy_unit_of(const std::string& unit) {
  if (unit == "Pa") return {"kPa", 1e-3};
  if (unit == "V") return {"mV", 1e3};
  if (unit == "s") return {"ms", 1e3};
  if (unit == "kg/s") return {"normal l/min", 60e3 / normal_kg_per_m3};
  return {unit, 1.0};
}

std::string size_text(double value, const std::string& unit) {
  const HandyUnit handy = handy_unit_of(unit);
  const std::string size = fmt::format("{:.2g} {}", handy.factor * value, handy.unit);
  return unit == "kg/s" ? fmt::format("{:.2g} kg/s, {}", value, size) : size;
}

UnknownPicture picture_of(const std::vector<ResidualRow>& rows, const LatentRanking& ranking, const RankedLatent& shown,
                          const std::vector<ResidualChannel>& channels, const std::vector<ResidualCourse>& courses) {
  UnknownPicture out{shown.input.element, shown.input.what, shown.input.unit, shown.gain, shown.fit.level, {}, ""};
  const auto p1 = measured(channels, courses, "p1"), p2 = measured(channels, courses, "p2");
  for (const LatentCourse& course : LatentEvidence(rows, ranking.fit).course(shown.input, shown.fit))
    for (std::size_t i = 0; i < course.time_s.size(); ++i) {
      const ResidualRow* row = row_at(rows, course.recording, course.time_s[i]);
      if (row == nullptr) continue;
      out.points.push_back({course.recording, course.time_s[i], row->position_m, row->velocity_mps, row->command_V,
                            value_at(p1, course.recording, course.time_s[i]),
                            value_at(p2, course.recording, course.time_s[i]), course.mean[i], course.deviation[i]});
    }
  out.words = picture_words(out);
  return out;
}

std::string picture_words(const UnknownPicture& picture) {
  const HandyUnit handy = handy_unit_of(picture.unit);
  const std::string size = fmt::format("{} of some {:.2g} {}", picture.what, handy.factor * picture.level, handy.unit);
  std::optional<Quantity> best;
  Relation most;
  for (const Quantity& quantity : quantities(picture)) {
    const Relation found = relation(picture, quantity);
    if (found.share <= most.share) continue;
    most = found;
    best = quantity;
  }
  if (!best || most.share < told_share) return size + ", which goes with none of time, place, speed, pressure, command";
  const auto by_mean = [](const Binned& a, const Binned& b) { return a.mean < b.mean; };
  const Binned low = *std::min_element(most.bins.begin(), most.bins.end(), by_mean);
  const Binned high = *std::max_element(most.bins.begin(), most.bins.end(), by_mean);
  const auto told = [&](const Binned& bin) {
    return fmt::format("{:+.2g} {} at {:.3g} to {:.3g} {}", handy.factor * bin.mean, handy.unit,
                       best->factor * bin.from, best->factor * bin.to, best->unit);
  };
  return fmt::format("{}{}; {} tells {:.0f} % of it: {}, {}", size, best->against_motion ? ", against the motion" : "",
                     best->name, 100 * most.share, told(high), told(low));
}

}  // namespace pneuservo
