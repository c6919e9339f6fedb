// Learning over repeated moves: on a linear plant, on drawn machines, its end, and its file.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "loop/loop_rigs.hpp"
#include "loop/recorded_run.hpp"
#include "loop/runner.hpp"
#include "pass/command_pass.hpp"
#include "pass/learned_move.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

namespace {

constexpr std::size_t move_ticks = 3000;
constexpr double tick_s = 1e-3;

/// x_{k+1} = 0.98 x_k + 0.02 u_{k-5}: a slow loop with a dead time.
std::vector<double> slow_answer(const std::vector<double>& u) {
  std::vector<double> x(u.size());
  for (std::size_t k = 6; k < u.size(); ++k) x[k] = 0.98 * x[k - 1] + 0.02 * u[k - 6];
  return x;
}

std::vector<double> slow_response(double gain) {
  std::vector<double> pulse(1500);
  pulse[0] = gain;
  return slow_answer(pulse);
}

/// The error of one move of the slow plant: a disturbance less what is learned.
std::vector<double> error_of(const RepeatedMove& move, double amplitude) {
  const std::vector<double> given = slow_answer(move.learned_V());
  std::vector<double> error(move_ticks);
  for (std::size_t k = 0; k < error.size(); ++k) {
    const double t = tick_s * static_cast<double>(k);
    error[k] = amplitude * std::pow(std::sin(M_PI * t / 3.0), 2.0) * std::sin(2.0 * M_PI * 1.5 * t) - given[k];
  }
  return error;
}

void play(RepeatedMove& move, const std::vector<double>& error, std::size_t every = 1) {
  for (std::size_t k = 0; k < error.size(); k += every) move.note(static_cast<std::int64_t>(k), error[k]);
  move.learn();
}

RepeatedMove slow_move(double most_V, double gain = 1.0) {
  return {slow_response(gain), std::vector<double>(move_ticks, 1.0), tick_s, most_V, 7};
}

/// A move forth and back on a machine that is not its config.
Rig repeated_rig(const std::string& config) {
  return config_rig(config,
                    {"controller.flow_feedforward=pass", "controller.learning=command", "duration_s=1.9",
                     "reference={kind: waypoints, times_s: [0.1, 0.8, 1.0, 1.7], positions_m: [0.0, 0.08, 0.08, 0.0], "
                     "smoothness: 7}",
                     "deviations={valve.area_per_volt_m2_per_V: 0.04, slider.viscous_friction_Ns_per_m: 0.15}"});
}

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("what is left of an error falls by what a move learns of it") {
  RepeatedMove move = slow_move(5.0, 1.25);  // the model's answer is a quarter too large: a move learns 0.6/1.25
  for (int i = 0; i < 8; ++i) play(move, error_of(move, 0.01));
  const auto& errors_m = move.progress().error_rms_m;
  REQUIRE(errors_m.size() == 8);
  for (std::size_t i = 1; i < 5; ++i) CHECK(errors_m[i] / errors_m[i - 1] == Approx(1.0 - 0.6 / 1.25).margin(0.02));
  CHECK_FALSE(move.progress().has_stopped);
  CHECK(move.command_V(-1) == 0.0);
  CHECK(move.command_V(move_ticks) == 0.0);
}

TEST_CASE("the learned command stays within its bound, and learning that does not help ends") {
  RepeatedMove bounded = slow_move(1e-3);
  for (int i = 0; i < 10; ++i) play(bounded, error_of(bounded, 0.05));
  for (const double value : bounded.learned_V()) REQUIRE(std::fabs(value) <= 1e-3);

  // A model of the wrong sign: the second move is worse, the first one's command (none) stays.
  RepeatedMove reversed = slow_move(5.0, -1.0);
  for (int i = 0; i < 4; ++i) play(reversed, error_of(reversed, 0.01));
  CHECK(reversed.progress().has_stopped);
  CHECK(reversed.progress().error_rms_m.size() == 2);
  for (const double value : reversed.learned_V()) REQUIRE(value == 0.0);
  CHECK(learning_words(reversed.progress()).find("worse than the first") != std::string::npos);

  // Nothing to learn from: three moves without a new best.
  RepeatedMove idle = slow_move(5.0);
  const std::vector<double> same = error_of(idle, 0.01);
  for (int i = 0; i < 9; ++i) play(idle, same);
  CHECK(idle.progress().has_stopped);
}

TEST_CASE("a move with skipped slots teaches nothing") {
  RepeatedMove move = slow_move(5.0);
  play(move, error_of(move, 0.01), 2);
  CHECK(move.progress().moves_not_learned == 1);
  CHECK(move.progress().error_rms_m.empty());
  play(move, error_of(move, 0.01));
  CHECK(move.progress().error_rms_m.size() == 1);
}

TEST_CASE("five moves on a machine that differs from its config") {
  const auto [config, most_mm] = GENERATE(std::pair{"cylinder-2m-7.65mm", 0.1}, std::pair{"cylinder-10m-7.65mm", 0.2});
  CAPTURE(config);
  const Rig rig = repeated_rig(config);
  SimBackend backend(rig);
  backend.configure();
  RunSettings settings;
  settings.moves = 5;
  const RunOutcome out = run_loop(rig, backend, settings);
  REQUIRE(out.faults.empty());
  REQUIRE(out.moves.size() == 5);
  std::vector<double> most_m;
  for (const MoveSpan& span : out.moves) {
    most_m.push_back(0.0);
    for (std::size_t i = span.begin; i < span.end; ++i)
      if (out.rows[i].t_s >= span.start_s)
        most_m.back() = std::max(most_m.back(), std::fabs(out.rows[i].x_ref_m - out.rows[i].x_true_m));
  }
  CAPTURE(most_m);
  CHECK(most_m.back() < 0.4 * most_m.front());
  CHECK(1e3 * most_m.back() < most_mm);
  REQUIRE(out.repeated_move);
  CHECK(out.repeated_move->progress().error_rms_m.size() == 5);
  // What was learned is recorded, and no more than its bound; the first move has learned nothing.
  const auto names = law_columns(rig.controller.kind);
  const auto term = static_cast<std::size_t>(std::ranges::find(names, "u_learned_V") - names.begin());
  const auto most_V = [&](const MoveSpan& span) {
    double most = 0.0;
    for (std::size_t i = span.begin; i < span.end; ++i) most = std::max(most, std::fabs(out.rows[i].terms[term]));
    return most;
  };
  CHECK(most_V(out.moves.front()) == 0.0);
  CHECK(most_V(out.moves.back()) > 0.0);
  CHECK(most_V(out.moves.back()) <= rig.controller.of<PdForce>().learned_command_max_V);
}

TEST_CASE("a run that learns is replayed bit for bit, and its moves begin a later one") {
  const Rig rig = repeated_rig("cylinder-2m-7.65mm");
  const std::string path = (std::filesystem::temp_directory_path() / "pneuservo-learned.csv.gz").string();
  SimBackend backend(rig);
  recorded_run(rig, backend, path, 2);
  CHECK(replayed(rig, read_recording(path), 2).identical());
  std::filesystem::remove(path);

  RunSettings first;
  first.moves = 2;
  SimBackend again(rig);
  again.configure();
  const RunOutcome learned = run_loop(rig, again, first);
  RunSettings later;
  later.learned = [&](const RepeatedMove&) { return learned.repeated_move->learned_V(); };
  SimBackend third(rig);
  third.configure();
  const RunOutcome out = run_loop(rig, third, later);
  CHECK(out.repeated_move->progress().error_rms_m.front() <
        0.5 * learned.repeated_move->progress().error_rms_m.front());
}

TEST_CASE("a learned move is kept as it is, and refused beside another pass") {
  const std::string path = (std::filesystem::temp_directory_path() / "pneuservo-learned.txt").string();
  RepeatedMove move = slow_move(5.0);
  play(move, error_of(move, 0.01));
  std::ofstream(path) << learned_move_text("axis", move);
  CHECK(read_learned_move(path, move) == move.learned_V());
  const RepeatedMove other(slow_response(1.0), std::vector<double>(move_ticks, 1.0), tick_s, 5.0, 8);
  CHECK_THROWS_WITH(read_learned_move(path, other), Catch::Contains("another reference or beside another pass"));
  const std::string whole = text_of(path);
  std::ofstream(path) << whole.substr(0, whole.size() / 2);
  CHECK_THROWS(read_learned_move(path, move));
  std::ofstream(path) << "t_s,x\n0,1\n";
  CHECK_THROWS_WITH(read_learned_move(path, move), Catch::Contains(":1: found 't_s,x'"));
  std::filesystem::remove(path);
}
