// Runs designs, axes and linear models for the rows of the thesis, each once.
#include "thesis/bench.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <pneuservo/control/ppd2.hpp>

#include "config/read_rig.hpp"
#include "control/linear_trial.hpp"
#include "design/axis_design.hpp"
#include "loop/runner.hpp"
#include "report/evaluation.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {
namespace {

/// The thesis' law behind lines has no feedforward; the shipped configs have one.
std::vector<std::string> sets_of(const ThesisRig& which) {
  constexpr std::string_view key = "controller.flow_feedforward=";
  std::vector<std::string> sets = which.sets;
  const bool is_asked = std::ranges::any_of(sets, [&](const std::string& set) { return set.starts_with(key); });
  if (which.config.starts_with("cylinder-") && !is_asked) sets.push_back(std::string(key) + "off");
  return sets;
}

std::string name_of(const ThesisRig& which) {
  std::string name = which.config;
  for (const std::string& set : which.sets) name += "\n" + set;
  return name + fmt::format("\n{}", which.moves);
}

void add_row(ThesisCourse& course, const Row& row, double start_s) {
  course.t_s.push_back(row.t_s - start_s);
  course.x_ref_m.push_back(row.x_ref_m);
  course.x_m.push_back(row.x_true_m);
  course.u_V.push_back(std::isnan(row.u_V) ? row.u1_V : row.u_V);
  course.port_Pa[0].push_back(row.measured[Signal::p1_port]);
  course.port_Pa[1].push_back(row.measured[Signal::p2_port]);
  course.chamber_Pa[0].push_back(row.p1_chamber_true_Pa);
  course.chamber_Pa[1].push_back(row.p2_chamber_true_Pa);
  course.estimated_Pa[0].push_back(row.p1_estimated_Pa);
  course.estimated_Pa[1].push_back(row.p2_estimated_Pa);
}

ThesisCourse run_axis(const Rig& rig, int moves) {
  SimBackend backend(rig);
  backend.configure();
  RunSettings settings;
  settings.moves = moves;
  RunOutcome outcome = run_loop(rig, backend, settings);
  ThesisCourse course;
  if (outcome.moves.empty()) throw std::invalid_argument(rig.name + ": the run has no move");
  const MoveSpan& span = outcome.moves.back();
  const auto first = outcome.rows.begin() + static_cast<std::ptrdiff_t>(span.begin);
  const std::vector<Row> rows(first, outcome.rows.begin() + static_cast<std::ptrdiff_t>(span.end));
  for (const Row& row : rows) add_row(course, row, span.start_s);
  const Metrics metrics = evaluate(rig, rows, span.start_s);
  course.from_s = metrics.from_s;
  course.to_s = metrics.to_s;
  course.max_error_m = metrics.max_position_error_m;
  course.end_error_m = metrics.end_error_m;
  course.max_estimation_error_Pa = metrics.max_estimation_error_Pa;
  course.ripple_Pa = metrics.chamber_pressure_ripple_Pa;
  course.mean_pressure_Pa = 0.5 * (course.chamber_Pa[0].back() + course.chamber_Pa[1].back());
  if (!outcome.faults.empty()) course.fault = outcome.faults.front();
  return course;
}

ThesisCourse simulate_plant(const Rig& rig, const ThesisCourse& experiment) {
  AxisPlant<double> plant;
  plant.configure(rig.axis, rig.period_s, rig.simulation.cells_per_m, valve_arrangement(rig));
  plant.reset({experiment.x_m.front(), experiment.chamber_Pa[0].front(), experiment.chamber_Pa[1].front()});
  ThesisCourse course;
  course.from_s = experiment.from_s;
  course.to_s = experiment.to_s;
  course.t_s = experiment.t_s;
  course.x_ref_m = experiment.x_ref_m;
  course.u_V = experiment.u_V;
  for (const double command_V : experiment.u_V) {
    const auto now = true_values(plant);
    course.x_m.push_back(now[Signal::x]);
    course.port_Pa[0].push_back(now[Signal::p1_port]);
    course.port_Pa[1].push_back(now[Signal::p2_port]);
    course.chamber_Pa[0].push_back(now[Signal::p1_chamber]);
    course.chamber_Pa[1].push_back(now[Signal::p2_chamber]);
    plant.step(command_V, command_V);
  }
  return course;
}

/// The plant of that order, from the config's axis and the lag of its line.
LinearServoTable plant_of(const LinearRun& which, const Rig& rig) {
  constexpr double rad_per_cycle = 6.283185307179586;
  const SecondOrderLag line{rad_per_cycle * rig.axis.line_1.natural_frequency_Hz, rig.axis.line_1.damping_ratio};
  LinearServoTable table = linear_servo_table(rig.axis, rig.controller.of<Ppd2>().equilibrium_pressure_Pa, line);
  if (which.plant_order == 5) table.valve = low_frequency_match(table.line, table.valve);
  if (which.plant_order == 3) table.valve = {};
  if (which.plant_order < 7) table.line = {};
  return table;
}

/// u = Kp (r - x) - Kv v - Ka a on the plant's own state.
TrialController ideal_law(const LinearRun& which, const LinearServoTable& model, const Reference& reference) {
  const auto c = feedforward_coefficients(model, which.gains, which.feedforward_order);
  return [=, &reference](double t_s, const LinearTablePlant& plant) {
    const ReferencePoint r = reference.at(t_s);
    double aim = r.d[0];
    for (std::size_t i = 1; i < c.size() && which.feedforward_order > 0; ++i) aim += c[i] * r.d[i];
    return which.gains.position_V_per_m * (aim - plant.position_m()) -
           which.gains.velocity_Vs_per_m * plant.velocity_mps() -
           which.gains.acceleration_Vs2_per_m * plant.acceleration_mps2();
  };
}

/// The law of the config, with the printed gains.
TrialController config_law(const LinearRun& which, const Rig& rig, const Reference& reference) {
  Ppd2Parameters parameters = rig.controller.of<Ppd2>();
  parameters.position_gain_V_per_m = which.gains.position_V_per_m;
  parameters.velocity_gain_Vs_per_m = which.gains.velocity_Vs_per_m;
  parameters.acceleration_gain_Vs2_per_m = which.gains.acceleration_Vs2_per_m;
  auto law = std::make_shared<Ppd2>();
  law->configure(parameters, rig.axis, rig.period_s, reference, rig.duration_s);
  return [law, &reference](double t_s, const LinearTablePlant& plant) {
    const ReferencePoint now = reference.at(t_s), ahead = reference.at(t_s + law->lead_s());
    return law->step({.x_m = plant.position_m(), .now = now, .ahead = ahead}).command_V[0];
  };
}

ThesisCourse run_linear(const LinearRun& which, const Rig& rig) {
  const Reference reference(rig.reference);
  const LinearServoTable plant = plant_of(which, rig), full = plant_of({which.rig, {}, 0, 7}, rig);
  const TrialController law =
      which.law == LinearRun::Law::ideal ? ideal_law(which, full, reference) : config_law(which, rig, reference);
  ThesisCourse course;
  course.from_s = reference.start_s();
  course.to_s = reference.end_s() + settling_s;
  course.max_error_m =
      linear_trial_error_m(plant, reference, rig.period_s, [&](double t_s, const LinearTablePlant& state) {
        const double command_V = law(t_s, state);
        course.t_s.push_back(t_s);
        course.x_ref_m.push_back(reference.at(t_s).d[0]);
        course.x_m.push_back(state.position_m());
        course.u_V.push_back(command_V);
        return command_V;
      });
  return course;
}

}  // namespace

template <class T>
const T& ThesisBench::Memory<T>::once(const std::string& name, const std::function<T()>& make) {
  std::promise<std::shared_ptr<const T>> promise;
  std::shared_future<std::shared_ptr<const T>> found;
  bool mine = false;
  {
    const std::lock_guard lock(mutex_);
    const auto [place, is_new] = known_.try_emplace(name);
    if (is_new) place->second = promise.get_future().share();
    found = place->second;
    mine = is_new;
  }
  if (mine) {
    try {
      promise.set_value(std::make_shared<const T>(make()));
    } catch (...) { promise.set_exception(std::current_exception()); }
  }
  return *found.get();
}

Rig ThesisBench::rig(const ThesisRig& which) const {
  return read_rig(folder_ / (which.config + ".yaml"), sets_of(which), ConfigUse::simulation);
}

const ThesisCourse& ThesisBench::run(const ThesisRig& which) {
  return courses_.once(name_of(which), [&] { return run_axis(rig(which), which.moves); });
}

const ThesisCourse& ThesisBench::run(const LinearRun& which) {
  const std::string name =
      fmt::format("{}\n{} {} {} ff {} plant {} law {}", name_of(which.rig), which.gains.position_V_per_m,
                  which.gains.velocity_Vs_per_m, which.gains.acceleration_Vs2_per_m, which.feedforward_order,
                  which.plant_order, static_cast<int>(which.law));
  return courses_.once(name, [&] { return run_linear(which, rig(which.rig)); });
}

const ThesisCourse& ThesisBench::simulate(const ThesisRig& which, const ThesisRig& commanded) {
  return courses_.once(name_of(which) + " simulated under " + name_of(commanded),
                       [&] { return simulate_plant(rig(which), run(commanded)); });
}

const AxisDesign& ThesisBench::design(const ThesisRig& which) {
  return designs_.once(name_of(which), [&] {
    DesignRequest request;
    request.needs_mean_pressure = false;
    return design_axis(rig(which), request);
  });
}

double ThesisBench::shared(const std::string& name, const std::function<double()>& make) {
  return figures_.once(name, make);
}

std::string thesis_verb(const char* verb, const ThesisRig& which) {
  std::string text = fmt::format("pneuservo {} config/{}.yaml", verb, which.config);
  for (const std::string& set : sets_of(which))
    text += set.find_first_of(" {[") == std::string::npos ? " --set " + set : fmt::format(" --set '{}'", set);
  if (which.moves > 1) text += fmt::format(" --moves {}", which.moves);
  return text;
}

double largest_apart_m(const ThesisCourse& a, const ThesisCourse& b) {
  // Both on one grid in time, though one may begin earlier.
  std::size_t shift = 0;
  while (shift < b.t_s.size() && b.t_s[shift] < a.t_s.front() - 1e-9) ++shift;
  double largest = 0.0;
  for (std::size_t i = 0; i < a.x_m.size() && i + shift < b.x_m.size(); ++i) {
    if (std::fabs(a.t_s[i] - b.t_s[i + shift]) > 1e-9) throw std::invalid_argument("two courses are not on one grid");
    if (a.t_s[i] >= a.from_s - 1e-9 && a.t_s[i] <= a.to_s + 1e-9)
      largest = std::max(largest, std::fabs(a.x_m[i] - b.x_m[i + shift]));
  }
  return largest;
}

double largest_loss_Pa(const ThesisCourse& course, int side) {
  double largest = 0.0;
  for (std::size_t s = 0; s < 2; ++s)
    for (std::size_t i = 0; i < course.t_s.size() && (side < 0 || side == static_cast<int>(s)); ++i)
      if (course.t_s[i] >= course.from_s - 1e-9 && course.t_s[i] <= course.to_s + 1e-9)
        largest = std::max(largest, std::fabs(course.port_Pa[s][i] - course.chamber_Pa[s][i]));
  return largest;
}

}  // namespace pneuservo
