// What the verb `improve` found and predicts: one result for text, JSON and page.
#pragma once
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <pneuservo/rig/rig.hpp>
#include <report/run_result.hpp>

#include "diagnosis/diagnosis.hpp"

namespace pneuservo {

/// One call of the diagnosis, begun at what the calls before it found.
struct ImprovementCall {
  Verdict verdict = Verdict::consistent;
  std::string sentence;
  std::vector<DiagnosisAnswer> answers, unsaid;  ///< unsaid: of the best name, where the verdict is `unknown`
  double floors_left = 1.0;  ///< misfit after it, in noise floors
};

/// A number of the config that is another one now.
struct ChangedNumber {
  std::string path;
  double before = 0.0, after = 0.0;
};

struct Improvement {
  Rig configured, improved;
  std::vector<ImprovementCall> calls;
  std::vector<ChangedNumber> changes;
  /// The reference on the improved model, with the config's law and with the improved one; no rows where none was run.
  RunResult before, after;
  std::string without_pass;  ///< why the improved config asks for no pass; empty: it does
  bool is_refused = false;  ///< the improved config does not read: a number is beyond what a config may say
  bool stopped = false;  ///< ended early: the calls that were done by then, without what was not come to
  std::vector<std::string> warnings;
  std::string written;  ///< path of the improved config; empty: no file was written

  /// By what the largest error changes; NaN where one of them is not known.
  double error_ratio() const { return after.metrics.max_position_error_m / before.metrics.max_position_error_m; }
};

/// Numbers of the plant and its effects that differ, in the order of the config.
std::vector<ChangedNumber> changed_numbers(const Rig& before, const Rig& after);

/// "The largest error falls from 11.8 to 0.24 mm on the improved model."
std::string improvement_headline(const Improvement& improvement);
std::string improvement_text(const Improvement& improvement);
nlohmann::ordered_json improvement_json(const Improvement& improvement);
/// Throws InputError naming the path where it cannot be written.
void write_improvement_report(const Improvement& improvement, const std::string& path);

}  // namespace pneuservo
