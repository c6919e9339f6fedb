// Reads the verification cases (known answers computed apart from the product), runs a case and keeps its account.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <iomanip>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

namespace verification {

/// normal: as the product runs (10 cells a line, 1 ms period); fine: grid and step refined until nothing changes.
enum class Resolution { normal, fine };

/// The long run, and the table of all checks.
inline bool is_whole() {
  return std::getenv("PNEUSERVO_LONG") != nullptr || std::getenv("PNEUSERVO_VERIFICATION_OUT") != nullptr;
}

/// Limit of a number (real or complex) under refinement: three grids, each twice as fine as the one before, with the
/// order of convergence measured from them (Richardson extrapolation). Where the two changes are not in the ratio of an
/// order between 0.6 and 3 (rounding, or a change of sign), the finest grid's own number stands.
template <class T> T limit_of(const T& coarse, const T& middle, const T& fine) {
  const double ratio = std::abs(middle - coarse) / std::abs(fine - middle);
  return ratio > 1.5 && ratio < 8.0 ? fine + (fine - middle) / (ratio - 1.0) : fine;
}

/// One expected number (or list) with its conditions.
struct Check {
  std::string id, quantity, unit, kind, needs;
  YAML::Node at;
  std::vector<double> value, scale;
  std::optional<double> tolerance_normal, tolerance_fine;

  bool has(const char* key) const { return at.IsMap() && at[key]; }
  double number(const char* key) const { return at[key].as<double>(); }
  std::string text(const char* key) const { return at[key].as<std::string>(); }
  bool is(const char* key, const char* expected) const { return has(key) && text(key) == expected; }
};

/// Whether a check is of one of the nine lines and of none of the three that span their range.
inline bool is_within_the_range(const Check& check) {
  if (!check.has("L_m") || !check.has("D_mm")) return false;
  const std::pair line{check.number("L_m"), check.number("D_mm")};
  const auto is_one_of = [&](std::initializer_list<std::pair<double, double>> lines) {
    return std::find(lines.begin(), lines.end(), line) != lines.end();
  };
  return is_one_of({{2, 4.15}, {2, 6.1}, {5, 4.15}, {5, 7.65}, {10, 6.1}, {10, 7.65}});
}

/// What the product gives for a check: a number, a list, or why it is not asked.
struct Answer {
  std::vector<double> got;
  std::string skipped;
  Answer(double number) : got{number} {}
  Answer(std::vector<double> numbers) : got(std::move(numbers)) {}
  static Answer skip(std::string why) {
    Answer answer(std::vector<double>{});
    answer.skipped = std::move(why);
    return answer;
  }
};

inline constexpr const char* cases_file = PNEUSERVO_SOURCE_DIR "/tests/data/verification/cases.yaml";

inline std::vector<double> numbers(const YAML::Node& node) {
  if (node.IsSequence()) return node.as<std::vector<double>>();
  return {node.as<double>()};
}
inline std::optional<double> tolerance(const YAML::Node& node) {
  if (!node || node.IsNull()) return std::nullopt;
  return node.as<double>();
}
inline Check read_check(const YAML::Node& node) {
  Check check;
  check.id = node["id"].as<std::string>();
  check.quantity = node["quantity"].as<std::string>();
  check.unit = node["unit"].as<std::string>("");
  check.kind = node["tolerance_kind"].as<std::string>();
  check.needs = node["needs"].as<std::string>("");
  if (node["at"]) check.at.reset(node["at"]);
  check.value = numbers(node["value"]);
  if (node["scale"]) check.scale = numbers(node["scale"]);
  check.tolerance_normal = tolerance(node["tol_10"]);
  check.tolerance_fine = tolerance(node["tol_fine"]);
  return check;
}

/// Error of an answer over its tolerance: at most 1 is met; a tolerance of 0 asks for equality.
inline double error_over_tolerance(const Check& check, const std::vector<double>& got, double tol) {
  if (got.size() != check.value.size()) return INFINITY;
  double worst = 0.0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    const double error = std::fabs(got[i] - check.value[i]);
    const double allowed = tol * (check.kind == "relative" ? std::fabs(check.value[i])
                                  : check.kind == "scaled" ? check.scale.at(i)
                                                           : 1.0);
    const double ratio = error == 0.0 ? 0.0 : allowed > 0.0 ? error / allowed : INFINITY;
    worst = std::max(worst, std::isfinite(ratio) ? ratio : INFINITY);
  }
  return worst;
}

/// Checks that the product is known not to meet: id -> reason, from tests/verification/not_met.yaml. They are reported
/// as `not met`; one that has come to be met must be struck off the list, or the case fails.
using NotMet = std::map<std::string, std::string>;
inline NotMet known_not_met(Resolution resolution) {
  NotMet out;
  const YAML::Node file = YAML::LoadFile(PNEUSERVO_SOURCE_DIR "/tests/verification/not_met.yaml");
  for (const auto& group : file[resolution == Resolution::normal ? "normal" : "fine"])
    for (const auto& id : group["checks"]) out[id.as<std::string>()] = group["reason"].as<std::string>();
  return out;
}

/// Runs all checks of one case at one resolution. Where PNEUSERVO_VERIFICATION_OUT names a file, one JSON line a check
/// is appended to it: tools/verification-table makes the table of them.
class Case {
 public:
  /// `has`: what a check may need beyond the plain model and is asked all the same.
  explicit Case(const std::string& id, std::set<std::string> has = {}) : id_(id), has_(std::move(has)) {
    const YAML::Node file = YAML::LoadFile(cases_file);
    for (const auto& node : file["cases"]) {
      if (node["id"].as<std::string>() != id) continue;
      title_ = node["title"].as<std::string>();
      for (const auto& check : node["checks"]) checks_.push_back(read_check(check));
    }
    REQUIRE(!checks_.empty());
  }
  const std::vector<Check>& checks() const { return checks_; }

  /// Refined, the short run asks three of the nine lines.
  void run(Resolution resolution, const std::function<Answer(const Check&)>& answer) {
    const NotMet not_met = known_not_met(resolution);
    int met = 0, skipped = 0, known = 0, failed = 0;
    for (const Check& check : checks_) {
      const auto tol = resolution == Resolution::normal ? check.tolerance_normal : check.tolerance_fine;
      if (!tol) continue;
      if (resolution == Resolution::fine && !is_whole() && is_within_the_range(check)) {
        ++skipped;
        continue;
      }
      if (!check.needs.empty() && has_.count(check.needs) == 0) {
        ++skipped;
        record(check, resolution, "skipped", {}, *tol, "needs " + check.needs);
        continue;
      }
      Answer got(0.0);
      try {
        got = answer(check);
      } catch (const std::exception& error) {
        FAIL_CHECK(check.id << " " << check.quantity << ": " << error.what());
        continue;
      }
      if (!got.skipped.empty()) {
        ++skipped;
        record(check, resolution, "skipped", {}, *tol, got.skipped);
        continue;
      }
      const double error = error_over_tolerance(check, got.got, *tol);
      const auto reason = not_met.find(check.id);
      const bool listed = reason != not_met.end();
      if (error <= 1.0) {
        ++met;
        record(check, resolution, "met", got.got, *tol, "", error);
        if (listed) FAIL_CHECK(check.id << " is met now: strike it off the list of those not met");
      } else if (listed) {
        ++known;
        record(check, resolution, "not met", got.got, *tol, reason->second, error);
      } else {
        ++failed;
        record(check, resolution, "not met", got.got, *tol, "", error);
        FAIL_CHECK(describe(check, got.got, *tol, error));
      }
    }
    WARN(id_ << (resolution == Resolution::normal ? " as it runs" : " converged") << ": " << met << " met, " << skipped
             << " not asked (need what this model does not have, or are of the long run), " << known
             << " known not to be met, " << failed << " failed");
    CHECK(met + skipped > 0);
  }

 private:
  static std::string list(const std::vector<double>& v) {
    std::ostringstream out;
    out << std::setprecision(12);
    for (std::size_t i = 0; i < v.size(); ++i) out << (i ? ", " : "") << v[i];
    return out.str();
  }
  static std::string describe(const Check& check, const std::vector<double>& got, double tol, double error) {
    std::ostringstream out;
    out << check.id << " " << check.quantity;
    if (check.at.IsMap()) out << " " << YAML::Dump(check.at);
    out << ": got " << list(got) << ", expected " << list(check.value) << " " << check.unit << ", " << check.kind
        << " tolerance " << tol << ", error is " << error << " tolerances";
    return out.str();
  }
  void record(const Check& check, Resolution resolution, const std::string& status, const std::vector<double>& got,
              double tol, const std::string& reason, double error = 0.0) const {
    const char* path = std::getenv("PNEUSERVO_VERIFICATION_OUT");
    if (!path) return;
    const nlohmann::json line{{"case", id_},
                              {"title", title_},
                              {"check", check.id},
                              {"quantity", check.quantity},
                              {"resolution", resolution == Resolution::normal ? "normal" : "fine"},
                              {"status", status},
                              {"got", got},
                              {"expected", check.value},
                              {"tolerance", tol},
                              {"reason", reason},
                              {"error_over_tolerance", std::isfinite(error) ? error : 1e9}};
    std::ofstream(path, std::ios::app) << line.dump() << '\n';
  }
  std::string id_, title_;
  std::set<std::string> has_;
  std::vector<Check> checks_;
};

}  // namespace verification
