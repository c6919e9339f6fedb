// The diagnosis from Python, and the config that is improved by it.
#include <filesystem>
#include <memory>
#include <utility>

#include "binding.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/refit.hpp"
#include "diagnosis/result_json.hpp"
#include "diagnosis/result_text.hpp"
#include "improve/improve.hpp"
#include "report/diagnosis_report.hpp"
#include "work.hpp"

namespace pneuservo::python {
namespace {

/// What errors state of a config that a result holds.
std::string improved_name(const std::string& rig) { return rig + ", improved"; }

/// Copies of all, the second ones held out of fits.
std::vector<Recording> taken(const Recordings& recordings, const Recordings& held_out) {
  std::vector<Recording> out;
  for (const bool is_held_out : {false, true})
    for (const nb::handle one : is_held_out ? held_out : recordings) {
      out.push_back(nb::cast<const Recording&>(one));
      out.back().is_held_out = is_held_out;
    }
  return out;
}

DiagnoseOptions options_of(int jobs, const StopQuestion& stop, const Progress& tell) {
  DiagnoseOptions options;
  options.jobs = jobs;
  options.stop = stop;
  options.progress = tell;
  return options;
}

std::unique_ptr<Diagnosis> run_diagnosis(const Config& config, const Recordings& recordings, const Recordings& held_out,
                                         int jobs, bool as_curve, const nb::object& progress,
                                         const nb::object& cancel) {
  std::vector<Recording> all = taken(recordings, held_out);
  std::unique_ptr<Diagnosis> result;
  const bool interrupted = watched("diagnose", {progress, cancel}, [&](const StopQuestion& stop, const Progress& tell) {
    DiagnoseOptions options = options_of(jobs, stop, tell);
    options.with_curve = as_curve;
    result = std::make_unique<Diagnosis>(diagnose(config.rig, std::move(all), options));
  });
  if (interrupted && !result->stopped) raise_interrupt("diagnose");
  return result;
}

std::unique_ptr<Improvement> run_improvement(const Config& config, const Recordings& recordings,
                                             const Recordings& held_out, int jobs, const nb::object& progress,
                                             const nb::object& cancel) {
  const std::vector<Recording> all = taken(recordings, held_out);
  std::unique_ptr<Improvement> result;
  const bool interrupted = watched("improve", {progress, cancel}, [&](const StopQuestion& stop, const Progress& tell) {
    result = std::make_unique<Improvement>(improve(config.source, config.rig, all, {jobs, tell, stop}));
    judge_improved_config(*result, improved_config_text(*result), improved_name(config.rig.name));
  });
  if (interrupted && !result->stopped) raise_interrupt("improve");
  return result;
}

std::unique_ptr<Refit> run_refit(const Config& config, const Recordings& recordings,
                                 const std::vector<std::string>& effects, int jobs, const nb::object& progress,
                                 const nb::object& cancel) {
  const std::vector<Recording> all = taken(recordings, Recordings());
  std::unique_ptr<Refit> result;
  const bool interrupted = watched("refit", {progress, cancel}, [&](const StopQuestion& stop, const Progress& tell) {
    result = std::make_unique<Refit>(refit(config.rig, all, effects, options_of(jobs, stop, tell)));
  });
  if (interrupted) raise_interrupt("refit");
  return result;
}

FloatArray plain_array(const Eigen::MatrixXd& values) {
  return array_of(std::vector<double>(values.data(), values.data() + values.size()));
}

void bind_refit(nb::module_& m) {
  nb::class_<Refit>(m, "Refit", "Sizes of stated effects, fitted together.")
      .def_ro("paths", &Refit::paths, "Of the sizes, by the config: effects.coulomb_friction.force_N.")
      .def_prop_ro(
          "values", [](const Refit& r) { return plain_array(r.values); }, "Shape (sizes,), in SI units.")
      .def_prop_ro(
          "covariance",
          [](const Refit& r) {
            return nb::borrow<FloatArray>(
                nb::object(plain_array(r.covariance).attr("reshape")(r.values.size(), r.values.size())));
          },
          "Shape (sizes, sizes): what noise, tolerances and starts leave open.")
      .def_ro("misfit", &Refit::misfit,
              "Squared mismatch a row in its floor: well below 1 where the model lacks nothing, since floors hold its "
              "own error.")
      .def_ro("warnings", &Refit::warnings)
      .def_prop_ro(
          "refitted", [](const Refit& r) { return Config{r.refitted, improved_name(r.refitted.name)}; },
          "The config with these sizes.");
  m.def("refit", &run_refit, nb::arg("config"), nb::arg("recordings"), nb::arg("effects"), nb::arg("jobs"),
        nb::arg("progress").none(), nb::arg("cancel").none(), "See pneuservo.refit.");
}

void bind_improvement(nb::module_& m) {
  nb::class_<Improvement>(m, "Improvement", "What improve() found and predicts.")
      .def(
          "json", [](const Improvement& i) { return improvement_json(i).dump(); }, "As the verb's --json.")
      .def("text", &improvement_text, "As the program prints it.")
      .def(
          "write_report",
          [](const Improvement& i, const std::filesystem::path& path) { write_improvement_report(i, path.string()); },
          nb::arg("path"), "The self-contained HTML page with before and after.")
      .def("to_yaml", &improved_config_text, "The improved config as the verb writes it, with what was found on top.")
      .def_prop_ro("sentence", &improvement_headline, "What came of it, for a reader.")
      .def_prop_ro(
          "improved", [](const Improvement& i) { return Config{i.improved, improved_name(i.configured.name)}; },
          "The config with what was found and, where there is one, its command pass.")
      .def_prop_ro(
          "error_before_m", [](const Improvement& i) { return i.before.metrics.max_position_error_m; },
          "Largest position error of the config as it stood, on the improved model [m]; NaN where it was not run.")
      .def_prop_ro(
          "error_after_m", [](const Improvement& i) { return i.after.metrics.max_position_error_m; },
          "The same of the improved config [m].")
      .def_ro("without_pass", &Improvement::without_pass, "Why there is no command pass; empty: there is one.")
      .def_ro("is_refused", &Improvement::is_refused,
              "A number is beyond what a config may say: the written config would not be read.")
      .def_ro("stopped", &Improvement::stopped, "Ended early: the calls of the diagnosis that were done by then.")
      .def_ro("warnings", &Improvement::warnings)
      .def("__repr__", [](const Improvement& i) { return "<pneuservo.Improvement: " + improvement_headline(i) + ">"; });
  m.def("improve", &run_improvement, nb::arg("config"), nb::arg("recordings"), nb::arg("held_out"), nb::arg("jobs"),
        nb::arg("progress").none(), nb::arg("cancel").none(), "See pneuservo.improve.");
}

}  // namespace

void bind_diagnosis(nb::module_& m) {
  nb::class_<Diagnosis>(m, "Diagnosis", "What a diagnosis found.")
      .def(
          "json", [](const Diagnosis& d) { return diagnosis_json(d).dump(); },
          "As the verb's --json (docs/diagnosis-results.md).")
      .def("text", &diagnosis_text, "As the program prints it.")
      .def(
          "write_report",
          [](const Diagnosis& d, const std::filesystem::path& path) { write_diagnosis_report(d, path.string()); },
          nb::arg("path"), "The self-contained HTML page.")
      .def_prop_ro("verdict",
                   [](const Diagnosis& d) { return std::string(verdict_names[static_cast<std::size_t>(d.verdict)]); })
      .def_ro("sentence", &Diagnosis::sentence, "The verdict for a reader.")
      .def_ro("stopped", &Diagnosis::stopped, "Ended early: this is what was known by then.")
      .def_ro("warnings", &Diagnosis::warnings)
      .def_prop_ro(
          "improved", [](const Diagnosis& d) { return Config{d.improved, improved_name(d.rig)}; },
          "The config with what was found.")
      .def("__repr__", [](const Diagnosis& d) { return "<pneuservo.Diagnosis: " + d.sentence + ">"; });
  m.def("diagnose", &run_diagnosis, nb::arg("config"), nb::arg("recordings"), nb::arg("held_out"), nb::arg("jobs"),
        nb::arg("as_curve"), nb::arg("progress").none(), nb::arg("cancel").none(), "See pneuservo.diagnose.");
  bind_improvement(m);
  bind_refit(m);
}

}  // namespace pneuservo::python
