// The table of verbs.
#include "program/verbs.hpp"

#include <algorithm>
#include <array>

namespace pneuservo {

using AddsVerb = void(CommandLine&, int& status);
AddsVerb add_run, add_check, add_device, add_guard, add_latency, add_replay, add_simulate, add_design, add_index,
    add_diagnose, add_keys, add_home, add_zero, add_commission, add_stopping, add_import, add_effects, add_serve,
    add_command, add_new_rig, add_pass, add_improve, add_thesis, add_export, add_identify;

namespace {

/// A verb and what it is for, as the help lists it.
struct VerbEntry {
  AddsVerb* add;
  const char* purpose;
};
constexpr const char *design = "A new axis", *running = "An axis that moves", *recorded = "A recording",
                     *reference = "Reference";
constexpr VerbEntry verbs[] = {
    {add_new_rig, design},    {add_check, design},       {add_design, design},   {add_index, design},
    {add_pass, design},       {add_stopping, design},    {add_run, running},     {add_serve, running},
    {add_command, running},   {add_commission, running}, {add_zero, running},    {add_home, running},
    {add_device, running},    {add_guard, running},      {add_latency, running}, {add_import, recorded},
    {add_diagnose, recorded}, {add_improve, recorded},   {add_replay, recorded}, {add_simulate, recorded},
    {add_identify, recorded}, {add_export, recorded},    {add_keys, reference},  {add_effects, reference},
    {add_thesis, reference},
};

}  // namespace

void add_verbs(CLI::App& app, int& status) {
  for (const VerbEntry& verb : verbs) {
    CommandLine line(app, verb.purpose);
    verb.add(line, status);
  }
}

bool moves_an_axis(std::string_view verb) {
  constexpr std::array<std::string_view, 7> moving{"run", "home", "zero", "commission", "device", "guard", "serve"};
  return std::find(moving.begin(), moving.end(), verb) != moving.end();
}

}  // namespace pneuservo
