// The smallest program that shows what an addition does: its keys, and a recording of a simulated run.
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "config/config_manual.hpp"
#include "config/read_rig.hpp"
#include "elements/effect_entry.hpp"
#include "loop/runner.hpp"
#include "record/writer.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

/// keys | words EFFECT | run CONFIG FILE.csv.gz [PATH=VALUE]...
int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "keys") return std::puts(config_manual_text().c_str()) < 0 ? 1 : 0;
  if (argc == 3 && std::string_view(argv[1]) == "words")
    return std::puts(std::string(find_effect(argv[2])->words).c_str()) < 0 ? 1 : 0;
  if (argc < 4) return 2;
  const Rig rig = read_rig(argv[2], std::vector<std::string>(argv + 4, argv + argc));
  SimBackend backend(rig);
  backend.configure();
  RecordingWriter writer(argv[3], RecordingHeader(rig.name, rig.period_s), {});
  RunSettings settings;
  settings.writer = &writer;
  const RunOutcome outcome = run_loop(rig, backend, settings);
  for (const std::string& fault : outcome.faults) std::fprintf(stderr, "%s\n", fault.c_str());
  return writer.close().error.empty() && outcome.faults.empty() ? 0 : 1;
}
