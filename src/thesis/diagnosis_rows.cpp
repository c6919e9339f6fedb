// Rows of 2.4: what diagnose says of a recording of our table whose config is a linear model of each order.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "diagnosis/diagnose.hpp"
#include "loop/runner.hpp"
#include "record/row_recording.hpp"
#include "sim/sim_backend.hpp"
#include "thesis/groups.hpp"

namespace pneuservo {
namespace {

struct LinearModel {
  const char* place;
  int order;
  const char* name;
  Ppd2Gains gains;  ///< of the text of 2.4
  std::array<const char*, 3> misfit_held;  ///< of both ports [kPa] and the force [N]
};
constexpr LinearModel model_3{"Fig 2.21", 3, "3rd", {1000, 54.9, 1.57}, {"39.67", "41.52", "0.3557"}},
    model_7{"Fig 2.23", 7, "7th", {1000, 64.8, 1.50}, {"38.82", "40.6", "0.3465"}},
    model_5{"Fig 2.25", 5, "5th", {1100, 49.6, 1.10}, {"42.38", "44.19", "0.3932"}};
constexpr std::array<const char*, 3> misfit_channels{"p1_port", "p2_port", "F"};

/// What is recorded: our nonlinear table, or the linear model of seventh order in its place.
enum class Machine { table, seventh_order };

/// The printed move and back, by the printed law without feedforward.
ThesisRig machine_of(const LinearModel& model, Machine machine) {
  ThesisRig out{table_4mm.config, {"controller.feedforward=none"}, 2};
  if (machine == Machine::seventh_order) out.sets = linear_model_sets(7);
  for (const std::string& set : gain_sets(model.gains)) out.sets.push_back(set);
  return out;
}

Recording recorded(ThesisBench& bench, const ThesisRig& which) {
  const Rig rig = bench.rig(which);
  SimBackend backend(rig);
  backend.configure();
  RunSettings settings;
  settings.moves = which.moves;
  return recording_of(run_loop(rig, backend, settings).rows, rig.name, rig.period_s, rig.valves());
}

Rig model_rig(ThesisBench& bench, const LinearModel& model) {
  return bench.rig({table_4mm.config, linear_model_sets(model.order)});
}

/// Simulation less recording of each channel, root mean square, nothing fitted [kPa, N].
std::array<double, misfit_channels.size()> misfits(ThesisBench& bench, const LinearModel& model) {
  DiagnoseOptions options;
  options.jobs = 1;
  PreparedDiagnosis prepared = prepare_diagnosis(
      model_rig(bench, model), {recorded(bench, machine_of(model, Machine::table))}, "thesis", options);
  const auto& channels = prepared.model->channels();
  const auto found = prepared.model->sample_misfit({prepared.rig, {}});
  std::array<double, misfit_channels.size()> out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto at = std::ranges::find(channels, misfit_channels[i], &ResidualChannel::name);
    const double unit = i + 1 < out.size() ? 1e-3 : 1.0;
    out[i] = at == channels.end() ? std::nan("") : unit * found[static_cast<std::size_t>(at - channels.begin())].fitted;
  }
  return out;
}

/// Of one channel; the first that is asked for computes all.
double misfit(ThesisBench& bench, const LinearModel& model, std::size_t channel) {
  const auto name = [&](std::size_t of) { return fmt::format("misfit {} {}", model.name, of); };
  const double first = bench.shared(name(0), [&] {
    const auto all = misfits(bench, model);
    for (std::size_t of = 1; of < all.size(); ++of) bench.shared(name(of), [&] { return all[of]; });
    return all[0];
  });
  return channel == 0 ? first : bench.shared(name(channel), [] { return std::nan(""); });
}

std::string commands_of(const LinearModel& model, Machine machine) {
  return thesis_verb("run", machine_of(model, machine)) + " --record machine.csv.gz && " +
         thesis_verb("diagnose", {table_4mm.config, linear_model_sets(model.order)}) + " machine.csv.gz";
}

std::string verdict_words(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const DiagnosisAnswer& answer : diagnosis.answers) {
    std::string name = "at " + answer.element;
    if (diagnosis.verdict != Verdict::unknown) name = answer.effect + " " + name;
    for (const EstimatedParameter& parameter : answer.parameters)
      if (diagnosis.verdict != Verdict::unknown) name += fmt::format(", {} {:.2g}", parameter.name, parameter.value);
    names.push_back(name);
  }
  const std::string words(verdict_names[static_cast<std::size_t>(diagnosis.verdict)]);
  return names.empty() ? words : fmt::format("{}: {}", words, fmt::join(names, "; "));
}

ThesisRow verdict_row(const LinearModel& model, Machine machine, const char* held, const char* why) {
  return {.place = model.place,
          .what = fmt::format("{} order model as config, recording of {}: verdict of diagnose", model.name,
                              machine == Machine::table ? "our nonlinear table" : "the 7th order"),
          .printed = "no figure",
          .plant = machine == Machine::table ? ThesisPlant::nonlinear : ThesisPlant::linear,
          .ours =
              [=](ThesisBench& bench) {
                DiagnoseOptions options;
                options.jobs = 1;
                return ThesisValue(verdict_words(
                    diagnose(model_rig(bench, model), {recorded(bench, machine_of(model, machine))}, options)));
              },
          .held = held,
          .why = why,
          .command = commands_of(model, machine)};
}

constexpr const char* misfit_why =
    "charging passes 4.6 times what discharging does whatever the pressures are: nothing brings a linear side's mean "
    "pressure back";
constexpr const char* valve_why =
    "what every order lacks first is a valve whose flow goes with the pressures; no name stands for that, and the "
    "nearest, unlike edges of the valve, takes a third of the mismatch";
constexpr const char* lags_why = "the lags of valve and line by their first order, 2 zeta/w: 2.23 + 0.20 ms";
constexpr const char* nothing_why = "the matched lag leaves nothing that 6 s of these sensors show";

}  // namespace

std::vector<ThesisRow> model_misfit_rows() {
  std::vector<ThesisRow> rows;
  for (const LinearModel& model : {model_3, model_7, model_5})
    for (std::size_t channel = 0; channel < misfit_channels.size(); ++channel)
      rows.push_back({.place = model.place,
                      .what = fmt::format("{} order model as config, recording of our nonlinear table: {} off, rms",
                                          model.name, misfit_channels[channel]),
                      .unit = channel + 1 < misfit_channels.size() ? "kPa" : "N",
                      .printed = "no figure",
                      .plant = ThesisPlant::linear,
                      .ours = [=](ThesisBench& bench) { return misfit(bench, model, channel); },
                      .held = model.misfit_held[channel],
                      .held_within = simulated_within,
                      .why = misfit_why,
                      .command = commands_of(model, Machine::table)});
  return rows;
}

ThesisGroup thesis_diagnosis_group() {
  return {"2.4 What diagnose says that each order lacks",
          {verdict_row(model_3, Machine::seventh_order, "missing_physics: command_delay at timing, delay_s 0.0024",
                       lags_why),
           verdict_row(model_5, Machine::seventh_order, "consistent", nothing_why),
           verdict_row(model_3, Machine::table, "unknown: at valve", valve_why),
           verdict_row(model_7, Machine::table, "unknown: at valve", valve_why),
           verdict_row(model_5, Machine::table, "unknown: at valve", valve_why)}};
}

}  // namespace pneuservo
