// Verb export: recordings and configs as files of other programs, by the Python package.
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "config/input_error.hpp"
#include "program/output_files.hpp"
#include "program/verbs.hpp"

namespace pneuservo {
namespace {

// A module of the package in place of this program; where there is none, one sentence.
constexpr const char* in_python = R"py(import runpy, sys
module = sys.argv.pop(1)
try:
    import pneuservo
except ImportError as error:
    sys.exit(f"export: found no Python package of this program for {sys.executable} ({error}), expected it in the environment that "
             "is active: activate the one that has it, or pip install '.[files]' in this program's folder (docs/python.md)")
sys.argv[0] = module
runpy.run_module(module, run_name="__main__", alter_sys=True)
)py";

struct ExportOptions {
  std::vector<std::string> sources, set;
  std::string out, fmu, model, fmi;
  bool parquet = false, mat = false, mcap = false, csv = false, force = false;
};

// An option that has no effect would be a wish that nobody grants.
void refuse_without_effect(const ExportOptions& options) {
  const bool is_fmu = !options.fmu.empty();
  const auto refuse = [&](const char* name, bool given) {
    if (given)
      throw InputError(std::string(name) + (is_fmu ? ": found with --fmu, expected for recordings alone: leave it out"
                                                   : ": found without --fmu, expected --fmu FILE beside it"));
  };
  if (is_fmu) {
    refuse("--parquet", options.parquet);
    refuse("--mat", options.mat);
    refuse("--mcap", options.mcap);
    refuse("--csv", options.csv);
    refuse("--out", !options.out.empty());
    refuse("--force", options.force);
  } else {
    refuse("--model", !options.model.empty());
    refuse("--fmi", !options.fmi.empty());
    refuse("--set", !options.set.empty());
  }
}

std::vector<std::string> arguments_of(const ExportOptions& options) {
  refuse_without_effect(options);
  std::vector<std::string> out{"python3", "-c", in_python};
  const auto with_value = [&](const char* name, const std::string& value) {
    if (!value.empty()) out.insert(out.end(), {name, value});
  };
  if (!options.fmu.empty()) {
    if (options.sources.size() != 1)
      throw InputError("--fmu: found several files, expected one CONFIG whose plant or estimator it is");
    OutputFiles().reads("CONFIG", options.sources.front()).writes("--fmu", options.fmu, ResultKind::fmu);
    out.insert(out.end(), {"pneuservo.fmu", options.sources.front(), options.fmu, "--force"});
    with_value("--model", options.model);
    with_value("--fmi", options.fmi);
    for (const std::string& one : options.set) with_value("--set", one);
    return out;
  }
  if (!options.parquet && !options.mat && !options.mcap && !options.csv)
    throw InputError("export: found nothing to write, expected --parquet, --mat, --mcap, --csv or --fmu FILE");
  out.emplace_back("pneuservo.export");
  out.insert(out.end(), options.sources.begin(), options.sources.end());
  for (const auto& [name, wanted] :
       {std::pair("--parquet", options.parquet), std::pair("--mat", options.mat), std::pair("--mcap", options.mcap),
        std::pair("--csv", options.csv), std::pair("--force", options.force)})
    if (wanted) out.emplace_back(name);
  with_value("--out", options.out);
  return out;
}

void become_python(const ExportOptions& options) {
  std::vector<std::string> arguments = arguments_of(options);
  std::vector<char*> pointers;
  for (std::string& one : arguments) pointers.push_back(one.data());
  pointers.push_back(nullptr);
  ::execvp("python3", pointers.data());
  throw InputError(std::string("export: python3 cannot be run: ") + std::strerror(errno) +
                   ": install Debian's python3 and the package of docs/python.md");
}

}  // namespace

void add_export(CommandLine& app, int&) {
  auto options = std::make_shared<ExportOptions>();
  Verb verb = app.add_verb("export", "recordings for other programs; plant or estimator as an FMU");
  verb.add_option("RECORDING", options->sources, "recordings, also .parquet, .mat, .mcap; or with --fmu one config")
      .required();
  verb.add_flag("--parquet", options->parquet, "each as NAME.parquet (pandas, Arrow)");
  verb.add_flag("--mat", options->mat, "each as NAME.mat (MATLAB, Octave)");
  verb.add_flag("--mcap", options->mcap, "each as NAME.mcap (Foxglove, PlotJuggler)");
  verb.add_flag("--csv", options->csv, "each as NAME.csv.gz, of .parquet, .mat and .mcap: what the other verbs read");
  verb.add_option("--out", options->out, "folder of these files; default: here");
  verb.add_flag("--force", options->force, "replaces these files where they are there");
  verb.add_option("--fmu", options->fmu, "FMU for co-simulation to write; replaces an older one");
  verb.add_option("--model", options->model, "what the FMU computes (plant)").among({"plant", "estimator"});
  verb.add_option("--fmi", options->fmi, "version of the FMU's interface (2)").among({"2", "3"});
  verb.add_option("--set", options->set, "PATH=VALUE: overrides a key of the FMU's config; may stand several times");
  verb.footer("Uses the Python package (docs/python.md), with the python3 that comes first in PATH.");
  verb.callback([options] { become_python(*options); });
}

}  // namespace pneuservo
