// Estimator, plant and simulated machine, step by step and by arrays; the verbs simulate and run.
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/rig/plant.hpp>

#include "binding.hpp"
#include "config/input_error.hpp"
#include "loop/runner.hpp"
#include "record/import.hpp"
#include "sim/plant_course.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo::python {

const Config& pneumatic(const Config& config, const char* who) {
  if (!config.rig.is_pneumatic())
    throw InputError(config.source + ": rig: found " + std::string(info(config.rig.kind).name) +
                     ", expected a rig with proportional valves: " + who + " works on no other");
  return config;
}

namespace {

/// A second command where there is one valve would be left out without a word.
void require_second_valve(const char* call, std::size_t valves, bool is_given) {
  if (valves != 2 && is_given)
    throw nb::value_error(
        fmt::format("{}: u2_V: found a second command, expected none: the rig has one valve", call).c_str());
}

/// The estimator with the columns of a recording for its results.
class Estimator {
 public:
  explicit Estimator(const Config& config) : valves_(pneumatic(config, "Estimator").rig.valves()) {
    estimator_.configure(estimator_parameters(config.rig));
  }
  EstimatorOutput step(double p1_port_Pa, double p2_port_Pa, double x_m, double v_mps, double u_V, double u2_V) {
    require_second_valve("Estimator.step", valves_, !std::isnan(u2_V));
    const InUse hold(in_use_, "Estimator");
    return estimator_.step({p1_port_Pa, p2_port_Pa, x_m, v_mps, u_V, u2_V});
  }
  void reset() {
    const InUse hold(in_use_, "Estimator");
    estimator_.reset();
  }
  Document run(const ArrayOrNumber& p1, const ArrayOrNumber& p2, const ArrayOrNumber& x, const ArrayOrNumber& v,
               const ArrayOrNumber& u, const ArrayOrNumber& u2);

 private:
  PipelineEstimator estimator_;
  std::size_t valves_;
  std::atomic<bool> in_use_{false};
};

Document Estimator::run(const ArrayOrNumber& p1, const ArrayOrNumber& p2, const ArrayOrNumber& x,
                        const ArrayOrNumber& v, const ArrayOrNumber& u, const ArrayOrNumber& u2) {
  const char* const call = "Estimator.run";
  const Column port_1(p1, call, "p1_port_Pa"), port_2(p2, call, "p2_port_Pa"), position(x, call, "x_m"),
      velocity(v, call, "v_mps"), command(u, call, "u_V"), command_2(u2, call, "u2_V");
  require_second_valve(call, valves_, !command_2.is_number() || !std::isnan(command_2[0]));
  const std::size_t rows = common_rows(call, {&port_1, &port_2, &position, &velocity, &command, &command_2});
  std::array<std::vector<double>, 6> out;
  std::vector<std::uint32_t> health;
  {
    const nb::gil_scoped_release released;
    const InUse hold(in_use_, "Estimator");
    for (auto& column : out) column.resize(rows);
    health.resize(rows);
    for (std::size_t i = 0; i < rows; ++i) {
      const EstimatorOutput e =
          estimator_.step({port_1[i], port_2[i], position[i], velocity[i], command[i], command_2[i]});
      for (std::size_t side = 0; side < 2; ++side) {
        const auto at = static_cast<Eigen::Index>(side);
        out[side][i] = e.chamber_pressure_Pa[at];
        out[2 + side][i] = e.error_bound_Pa[at];
        out[4 + side][i] = e.mass_flow_kgps[at];
      }
      health[i] = e.health;
    }
  }
  Document result;
  const std::array names{"p1_estimated_Pa", "p2_estimated_Pa",  "p1_bound_Pa",
                         "p2_bound_Pa",     "mass_flow_1_kgps", "mass_flow_2_kgps"};
  for (std::size_t i = 0; i < names.size(); ++i) result[names[i]] = array_of(std::move(out[i]));
  result["health"] = array_of(std::move(health));
  return result;
}

void require_commands(const char* call, std::size_t valves, double u1_V, std::optional<double> u2_V) {
  require_second_valve(call, valves, u2_V.has_value());
  require_finite(call, valves == 2 ? "u1_V" : "u_V", u1_V);
  require_finite(call, "u2_V", u2_V.value_or(0.0));
}

/// Values of all channels and the velocity at one time.
struct AxisValues {
  PerSignal<double> measured;
  double v_mps = none;
};

/// The plant behind ideal sensors.
class Plant {
 public:
  explicit Plant(const Config& config)
      : start_(plant_start(pneumatic(config, "Plant").rig)), valves_(config.rig.valves()),
        half_stroke_m_(0.5 * config.rig.axis.cylinder.stroke_m) {
    const Rig& rig = config.rig;
    plant_.configure(rig.axis, rig.period_s, rig.simulation.cells_per_m, valve_arrangement(rig));
    plant_.reset(start_);
  }
  void reset(std::optional<double> x_m, std::optional<double> p1_Pa, std::optional<double> p2_Pa) {
    const PlantStart<double> start{x_m.value_or(start_.position_m), p1_Pa.value_or(start_.pressure_1_Pa),
                                   p2_Pa.value_or(start_.pressure_2_Pa)};
    require_start(start);
    const InUse hold(in_use_, "Plant");
    plant_.reset(start);
  }
  AxisValues step(double u1_V, std::optional<double> u2_V) {
    require_commands("Plant.step", valves_, u1_V, u2_V);
    const InUse hold(in_use_, "Plant");
    plant_.step(u1_V, u2_V.value_or(-u1_V));
    return values();
  }
  AxisValues now() {
    const InUse hold(in_use_, "Plant");
    return values();
  }
  Columns run(const ArrayOrNumber& u1, const std::optional<ArrayOrNumber>& u2);

 private:
  void require_start(const PlantStart<double>& start) const;
  AxisValues values() const { return {true_values(plant_), plant_.velocity()}; }

  AxisPlant<double> plant_;
  PlantStart<double> start_;
  std::size_t valves_;
  double half_stroke_m_;
  std::atomic<bool> in_use_{false};
};

void Plant::require_start(const PlantStart<double>& start) const {
  if (!(std::fabs(start.position_m) <= half_stroke_m_))
    throw nb::value_error(fmt::format("Plant.reset: x_m: found {}, expected a place within the stroke, -{} to {} m",
                                      start.position_m, half_stroke_m_, half_stroke_m_)
                              .c_str());
  for (const auto& [name, pressure_Pa] :
       {std::pair("p1_Pa", start.pressure_1_Pa), std::pair("p2_Pa", start.pressure_2_Pa)})
    if (!(pressure_Pa > 0.0 && std::isfinite(pressure_Pa)))
      throw nb::value_error(
          fmt::format("Plant.reset: {}: found {}, expected an absolute pressure above 0 Pa", name, pressure_Pa)
              .c_str());
}

Columns columns_of(PerSignal<std::vector<double>>& measured, std::vector<double>& velocity) {
  Columns result;
  for (const Signal signal : channel_signals)
    result[nb::cast(std::string(info(signal).column))] = array_of(std::move(measured[signal]));
  result["v_mps"] = array_of(std::move(velocity));
  return result;
}

Columns Plant::run(const ArrayOrNumber& u1, const std::optional<ArrayOrNumber>& u2) {
  const char* const call = "Plant.run";
  const Column command_1(u1, call, valves_ == 2 ? "u1_V" : "u_V");
  require_second_valve(call, valves_, u2.has_value());
  const Column command_2(u2.value_or(u1), call, "u2_V");
  const double sign = u2 ? 1.0 : -1.0;
  const std::size_t rows = common_rows(call, {&command_1, &command_2});
  command_1.require_finite(call);
  command_2.require_finite(call);
  PerSignal<std::vector<double>> measured;
  std::vector<double> velocity;
  {
    const nb::gil_scoped_release released;
    const InUse hold(in_use_, "Plant");
    velocity.resize(rows);
    for (const Signal signal : channel_signals) measured[signal].resize(rows);
    for (std::size_t i = 0; i < rows; ++i) {
      const AxisValues now = values();
      for (const Signal signal : channel_signals) measured[signal][i] = now.measured[signal];
      velocity[i] = now.v_mps;
      plant_.step(command_1[i], sign * command_2[i]);
    }
  }
  return columns_of(measured, velocity);
}

/// The plant with its deviations behind noisy sensors, as the backend `sim`.
class Machine {
 public:
  explicit Machine(const Config& config)
      : period_s_(pneumatic(config, "Machine").rig.period_s), valves_(config.rig.valves()) {
    backend_ = std::make_unique<SimBackend>(config.rig);
    backend_->configure();
    backend_->activate();
  }
  AxisValues read() {
    Measurement in;
    backend_->read(tick_, in);
    AxisValues out;
    for (const Signal signal : channel_signals) out.measured[signal] = in.channel[signal].value;
    return out;
  }
  void write(double u1_V, std::optional<double> u2_V) {
    require_commands("Machine.write", valves_, u1_V, u2_V);
    backend_->write(tick_++, {.valve_V = u1_V, .valve_2_V = u2_V.value_or(-u1_V), .enable = true});
  }
  Truth truth() const { return backend_->truth(); }
  std::int64_t tick() const { return tick_; }
  double time_s() const { return static_cast<double>(tick_) * period_s_; }

 private:
  std::unique_ptr<SimBackend> backend_;
  double period_s_;
  std::size_t valves_;
  std::int64_t tick_ = 0;
};

Columns simulate(const Config& config, const Recording& command) {
  pneumatic(config, "simulate");
  std::optional<PlantCourse> course;
  {
    const nb::gil_scoped_release released;
    course = simulate_plant(config.rig, command);
  }
  Columns result = columns_of(course->measured, course->v_mps);
  const std::vector<std::string> names = command_columns(config.rig);
  result[nb::cast(names.front())] = array_of(std::move(course->u1_V));
  if (names.size() == 2) result[nb::cast(names.back())] = array_of(std::move(course->u2_V));
  return result;
}

/// A run in closed loop: its rows, of which every column is a view.
struct Run {
  RunOutcome outcome;
  std::vector<std::string_view> terms;
};

std::unique_ptr<Run> run(const Config& config, int moves) {
  pneumatic(config, "run");
  if (moves < 1) throw nb::value_error(fmt::format("run: moves: found {}, expected at least 1", moves).c_str());
  const nb::gil_scoped_release released;
  const Rig rig = with_pass_heeded(config);
  SimBackend backend(rig);
  backend.configure();
  RunSettings settings;
  settings.moves = moves;
  settings.load = load_reference_positions;
  const auto terms = law_columns(config.rig.controller.kind);
  auto result = std::make_unique<Run>();
  result->outcome = run_loop(rig, backend, settings);
  result->terms.assign(terms.begin(), terms.end());
  return result;
}

Columns run_columns(const nb::object& self) {
  const Run& run = nb::cast<const Run&>(self);
  const std::vector<Row>& rows = run.outcome.rows;
  Columns out;
  if (rows.empty()) return out;
  static_assert(sizeof(Row) % sizeof(double) == 0);
  constexpr std::ptrdiff_t stride = sizeof(Row) / sizeof(double);
  Row::visit_all(
      run.terms,
      [&]<class T>(std::string_view name, const T& value) {
        if constexpr (std::is_same_v<T, double>)
          out[nb::cast(std::string(name))] = view_of(&value, rows.size(), stride, self);
      },
      rows.front());
  return out;
}

template <class Class> void add_channels(Class& c) {
  const auto add = [&](const char* column, Signal signal, const char* words) {
    c.def_prop_ro(column, [signal](const AxisValues& v) { return v.measured[signal]; }, words);
  };
  for (const Signal signal : channel_signals)
    add(info(signal).column.data(), signal, "In the unit of its name; NaN: no such sensor.");
}

void bind_estimator(nb::module_& m) {
  nb::class_<EstimatorOutput>(m, "Estimate", "Chamber pressures of one tick, absolute, with what they may be wrong by.")
      .def_prop_ro("p1_estimated_Pa", [](const EstimatorOutput& e) { return e.chamber_pressure_Pa[0]; })
      .def_prop_ro("p2_estimated_Pa", [](const EstimatorOutput& e) { return e.chamber_pressure_Pa[1]; })
      .def_prop_ro("p1_bound_Pa", [](const EstimatorOutput& e) { return e.error_bound_Pa[0]; })
      .def_prop_ro("p2_bound_Pa", [](const EstimatorOutput& e) { return e.error_bound_Pa[1]; })
      .def_prop_ro("mass_flow_1_kgps", [](const EstimatorOutput& e) { return e.mass_flow_kgps[0]; })
      .def_prop_ro("mass_flow_2_kgps", [](const EstimatorOutput& e) { return e.mass_flow_kgps[1]; })
      .def_prop_ro("valid", [](const EstimatorOutput& e) { return std::pair(e.valid[0], e.valid[1]); })
      .def_ro("health", &EstimatorOutput::health, "Bits of docs/estimator.md; 0: all inputs were good.");
  nb::class_<Estimator>(m, "Estimator", "Chamber pressures from those at the valve ports and the position.")
      .def(nb::init<const Config&>(), nb::arg("config"))
      .def("step", &Estimator::step, nb::arg("p1_port_Pa"), nb::arg("p2_port_Pa"), nb::arg("x_m"), nb::arg("v_mps"),
           nb::arg("u_V") = none, nb::arg("u2_V") = none,
           "One period. Absolute pressures [Pa], position [m] from mid-stroke, velocity [m/s], command that was held "
           "[V], for a servo table one a valve.")
      .def("run", &Estimator::run, nb::arg("p1_port_Pa"), nb::arg("p2_port_Pa"), nb::arg("x_m"), nb::arg("v_mps"),
           nb::arg("u_V") = none, nb::arg("u2_V") = none,
           "A period a row. Arrays of float64 of shape (rows,), read without a copy, or numbers for all rows.\n\n"
           "Gives columns of a recording, each of shape (rows,): p1_estimated_Pa, p2_estimated_Pa, p1_bound_Pa,\n"
           "p2_bound_Pa, mass_flow_1_kgps, mass_flow_2_kgps, health. Goes on where the last call ended.")
      .def("reset", &Estimator::reset, "Forgets everything.");
}

void bind_plant(nb::module_& m) {
  nb::class_<AxisValues> values(m, "AxisValues", "Channels at one time, by the columns of a recording.");
  add_channels(values);
  values.def_ro("v_mps", &AxisValues::v_mps, "True velocity [m/s]; NaN from sensors.");
  nb::class_<Plant>(m, "Plant", "The simulated axis behind ideal sensors, with the effects of its config.")
      .def(nb::init<const Config&>(), nb::arg("config"))
      .def("reset", &Plant::reset, nb::arg("x_m") = nb::none(), nb::arg("p1_Pa") = nb::none(),
           nb::arg("p2_Pa") = nb::none(), "To rest at a place [m] and chamber pressures [Pa]; else the config's start.")
      .def("step", &Plant::step, nb::arg("u_V"), nb::arg("u2_V") = nb::none(),
           "One period with the command held [V], for a servo table one a valve; gives the values at its end.")
      .def_prop_ro("now", &Plant::now, "Values now.")
      .def("run", &Plant::run, nb::arg("u_V"), nb::arg("u2_V") = nb::none(),
           "A period a row: commands of shape (rows,) [V], read without a copy. Gives columns of shape (rows,), the\n"
           "values as each period begins. Goes on where the last call ended.");
  nb::class_<Machine>(m, "Machine", "The simulated axis with its deviations behind noisy, quantised sensors.")
      .def(nb::init<const Config&>(), nb::arg("config"))
      .def("read", &Machine::read, "What the sensors show in this tick.")
      .def("write", &Machine::write, nb::arg("u_V"), nb::arg("u2_V") = nb::none(),
           "Holds the command [V] for one period; the next tick begins.")
      .def_prop_ro("tick", &Machine::tick, "Periods so far.")
      .def_prop_ro("t_s", &Machine::time_s, "Time so far [s].")
      .def_prop_ro("x_true_m", [](const Machine& s) { return s.truth().x_m; })
      .def_prop_ro("p1_chamber_true_Pa", [](const Machine& s) { return s.truth().p1_chamber_Pa; })
      .def_prop_ro("p2_chamber_true_Pa", [](const Machine& s) { return s.truth().p2_chamber_Pa; });
}

}  // namespace

void bind_axis(nb::module_& m) {
  bind_estimator(m);
  bind_plant(m);
  m.def(
      "simulate", &simulate, nb::arg("config"), nb::arg("command"),
      "The verb simulate: the plant alone on a recording's command, from its first position and pressures at rest.\n\n"
      "Gives columns of shape (rows,), without sensor noise; no copy is made of them.");
  nb::class_<Run>(m, "Run", "A simulated run in closed loop.")
      .def_prop_ro("columns", &run_columns, "Every column of numbers as a view of shape (rows,) on the run's rows.")
      .def_prop_ro(
          "faults", [](const Run& r) { return r.outcome.faults; }, "In words, first cause first; empty: none.")
      .def("__len__", [](const Run& r) { return r.outcome.rows.size(); });
  m.def("run", &run, nb::arg("config"), nb::arg("moves") = 1,
        "The verb run: estimator, law, loop and supervision on the simulated axis along the config's reference.");
}

}  // namespace pneuservo::python
