// Commands that a logger did not write: what they may do to the gas is an error of the model.
#include <array>
#include <cmath>

#include <catch2/catch.hpp>

#include "core/test_seed.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/residuals/command_gaps.hpp"
#include "diagnosis/residuals/imposed_run.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;

namespace {

double rms_difference(const std::vector<double>& a, const std::vector<double>& b, std::size_t from) {
  double squares = 0;
  for (std::size_t k = from; k < a.size(); ++k) squares += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(squares / static_cast<double>(a.size() - from));
}

}  // namespace

TEST_CASE("commands written in every n-th row leave an error as large as theirs, every command leaves none") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  const Rig rig = test::cylinder_rig(2.0);
  const Recording whole = test::simulated_recording(rig, 4.0, seed, {"p1_port_Pa", "p2_port_Pa"});
  const CylinderRecording known = prepare_recording(whole, rig, 4.0);
  const PlantGrid grid = grid_for(rig, 60, known.inputs.step_s());
  CHECK(command_gap_error(known.inputs, rig, grid)[Signal::p1_port].empty());
  for (const std::size_t rows : {std::size_t{4}, std::size_t{8}}) {
    Recording sparse = whole;
    const std::size_t first = seed % rows;
    std::vector<double>& command_V = sparse.column("u_V");
    for (std::size_t k = 0; k < command_V.size(); ++k)
      if (k % rows != first) command_V[k] = no_value;
    const CylinderRecording prepared = prepare_recording(sparse, rig, 4.0);
    CAPTURE(rows, first);
    CHECK(prepared.inputs.command_samples == rows);
    CHECK(prepared.inputs.first_command == first);
    const std::array<ImposedRun, 1> run{{{&rig, {}}}};
    const std::vector<double> truth = run_imposed(known.inputs, run, grid)[0][Signal::p1_port],
                              drawn = run_imposed(prepared.inputs, run, grid)[0][Signal::p1_port],
                              error = command_gap_error(prepared.inputs, rig, grid)[Signal::p1_port];
    REQUIRE(error.size() == truth.size());
    const std::size_t from = known.inputs.release;
    const double made_Pa = rms_difference(truth, drawn, from),
                 told_Pa = rms_difference(error, std::vector<double>(error.size(), 0.0), from);
    CAPTURE(made_Pa, told_Pa);
    CHECK(told_Pa > 0.5 * made_Pa);
    CHECK(told_Pa < 8 * made_Pa);
    // Draws of what was not read move the gas about as much: the filter behind the encoder makes a loop's noise slow,
    // and noise that were white moved it by 0.4 to 0.7.
    double squares = 0;
    const std::vector<GasCourse> draws = unseen_command_changes(prepared.inputs, rig, grid, 4);
    for (const GasCourse& change : draws)
      squares += std::pow(rms_difference(change[Signal::p1_port], std::vector<double>(truth.size(), 0.0), from), 2);
    const double drawn_Pa = std::sqrt(squares / static_cast<double>(draws.size()));
    CAPTURE(drawn_Pa);
    CHECK(drawn_Pa > (rows == 4 ? 0.6 : 0.45) * made_Pa);
    CHECK(drawn_Pa < 2 * made_Pa);
  }
}

TEST_CASE("rows that a logger lost shift no command: they are counted on the even grid") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  const Rig rig = test::cylinder_rig(2.0);
  Recording sparse = test::simulated_recording(rig, 2.0, seed, {"p1_port_Pa", "p2_port_Pa"});
  constexpr std::size_t rows = 8, first = 5, lost = 2;
  std::vector<double>& command_V = sparse.column("u_V");
  for (std::size_t k = 0; k < command_V.size(); ++k)
    if (k % rows != first) command_V[k] = no_value;
  for (auto& values : sparse.values) values.erase(values.begin() + lost);
  const CylinderRecording prepared = prepare_recording(sparse, rig, 2.0);
  CHECK(prepared.inputs.command_samples == rows);
  CHECK(prepared.inputs.first_command == first);
}

TEST_CASE("a play whose command is read in every fourth row is found too narrow, within an error that says so") {
  Rig machine = test::cylinder_rig(2.0);
  machine.axis.effects.valve.valve_hysteresis.width_V = 0.016;
  const Recording whole = test::simulated_recording(machine, 7.0, 5, test::all_pressures);
  Recording sparse = whole;
  sparse.period_s = 4 * whole.period_s;
  for (auto& values : sparse.values) {
    for (std::size_t k = 0; 4 * k < values.size(); ++k) values[k] = values[4 * k];
    values.resize((values.size() + 3) / 4);
  }
  sparse.line_numbers.resize(sparse.values.front().size());
  const Rig owner = test::toleranced_cylinder_rig(2.0, 6.1e-3);
  const Diagnosis of_all = diagnose(owner, {whole}), of_some = diagnose(owner, {sparse});
  CAPTURE(of_all.sentence, of_some.sentence);
  for (const Diagnosis* diagnosis : {&of_all, &of_some}) {
    REQUIRE(diagnosis->answers.size() == 1);
    CHECK(diagnosis->answers[0].effect == "valve_hysteresis");
  }
  const EstimatedParameter &all = of_all.answers[0].parameters.at(0), &some = of_some.answers[0].parameters.at(0);
  CHECK(all.value == Approx(0.016).epsilon(0.02));
  CHECK(some.value < all.value);
  CHECK(some.value == Approx(0.016).margin(3 * some.standard_error));
  CHECK(some.standard_error > 3 * all.standard_error);
}
