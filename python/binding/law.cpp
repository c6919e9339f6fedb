// The reference and the control law of a config, step by step and by arrays.
#include <memory>

#include <pneuservo/control/axis_controller.hpp>

#include "binding.hpp"
#include "config/input_error.hpp"
#include "pass/command_pass.hpp"
#include "record/import.hpp"

namespace pneuservo::python {
namespace {

/// The law along the config's reference, whose time 0 is the first step.
class Law {
 public:
  explicit Law(const Config& config)
      : reference_(pneumatic(config, "Law").rig.reference, load_reference_positions), period_s_(config.rig.period_s),
        valves_(config.rig.valves()), terms_(law_columns(config.rig.controller.kind)) {
    const Rig rig = with_pass_heeded(config);
    controller_.configure(rig.controller, rig.axis, rig.period_s, reference_, rig.duration_s,
                          pass_tables(rig, reference_).law);
    reset();
  }
  void reset() {
    const InUse hold(in_use_, "Law");
    controller_.reset({});
    tick_ = 0;
    out_ = {};
  }
  Anything step(double x_m, double p1_Pa, double p2_Pa, std::optional<double> p1_port_Pa,
                std::optional<double> p2_port_Pa, double p_supply_Pa) {
    const InUse hold(in_use_, "Law");
    advance({.x_m = x_m,
             .pressure_Pa = {p1_Pa, p2_Pa},
             .port_Pa = {p1_port_Pa.value_or(p1_Pa), p2_port_Pa.value_or(p2_Pa)},
             .supply_Pa = p_supply_Pa});
    if (valves_ == 1) return nb::borrow<Anything>(nb::cast(out_.command_V[0]));
    return nb::borrow<Anything>(nb::make_tuple(out_.command_V[0], out_.command_V[1]));
  }
  Columns run(const ArrayOrNumber& x, const ArrayOrNumber& p1, const ArrayOrNumber& p2,
              const std::optional<ArrayOrNumber>& port_1, const std::optional<ArrayOrNumber>& port_2,
              const ArrayOrNumber& supply);
  Document terms() {
    const InUse hold(in_use_, "Law");
    std::array<double, 16> values{};
    controller_.write_terms(tick_ > 0, std::span(values).first(terms_.size()));
    Document out;
    for (std::size_t i = 0; i < terms_.size(); ++i) out[nb::cast(std::string(terms_[i]))] = values[i];
    return out;
  }
  FloatArray reference_at(const ArrayOrNumber& t_s) const;
  double speed_mps() { return alone(out_.speed_mps); }
  bool limited() { return alone(out_.limited); }
  double lead_s() const { return controller_.lead_s(); }
  std::int64_t tick() { return alone(tick_); }

 private:
  /// A value that no other thread changes while it is read.
  template <class T> T alone(const T& value) {
    const InUse hold(in_use_, "Law");
    return value;
  }
  void advance(ControlInput in) noexcept {
    const double t_s = static_cast<double>(tick_) * period_s_, lead_s = controller_.lead_s();
    in.now = reference_.at(t_s);
    in.ahead = lead_s > 0.0 ? reference_.at(t_s + lead_s) : in.now;
    in.tick = tick_++;
    out_ = controller_.step(in);
  }

  Reference reference_;
  AxisController controller_;
  double period_s_;
  std::size_t valves_;
  std::span<const std::string_view> terms_;
  std::int64_t tick_ = 0;
  ControlOutput out_;
  std::atomic<bool> in_use_{false};
};

Columns Law::run(const ArrayOrNumber& x, const ArrayOrNumber& p1, const ArrayOrNumber& p2,
                 const std::optional<ArrayOrNumber>& port_1, const std::optional<ArrayOrNumber>& port_2,
                 const ArrayOrNumber& supply) {
  const char* const call = "Law.run";
  const Column position(x, call, "x_m"), pressure_1(p1, call, "p1_Pa"), pressure_2(p2, call, "p2_Pa"),
      at_port_1(port_1.value_or(p1), call, "p1_port_Pa"), at_port_2(port_2.value_or(p2), call, "p2_port_Pa"),
      fed(supply, call, "p_supply_Pa");
  const std::size_t rows = common_rows(call, {&position, &pressure_1, &pressure_2, &at_port_1, &at_port_2, &fed});
  std::vector<double> u1(rows), u2(valves_ == 2 ? rows : 0), speed(rows);
  {
    const nb::gil_scoped_release released;
    const InUse hold(in_use_, "Law");
    for (std::size_t i = 0; i < rows; ++i) {
      advance({.x_m = position[i],
               .pressure_Pa = {pressure_1[i], pressure_2[i]},
               .port_Pa = {at_port_1[i], at_port_2[i]},
               .supply_Pa = fed[i]});
      u1[i] = out_.command_V[0], speed[i] = out_.speed_mps;
      if (valves_ == 2) u2[i] = out_.command_V[1];
    }
  }
  Columns out;
  out[valves_ == 2 ? "u1_V" : "u_V"] = array_of(std::move(u1));
  if (valves_ == 2) out["u2_V"] = array_of(std::move(u2));
  out["v_mps"] = array_of(std::move(speed));
  return out;
}

FloatArray Law::reference_at(const ArrayOrNumber& t_s) const {
  const Column times(t_s, "Law.reference", "t_s");
  const std::size_t rows = times.is_number() ? 1 : times.rows();
  auto* const values = new std::vector<double>(rows * 8);
  const nb::capsule owner(values, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  for (std::size_t i = 0; i < rows; ++i)
    std::ranges::copy(reference_.at(times[i]).d, values->begin() + static_cast<std::ptrdiff_t>(8 * i));
  return nb::borrow<FloatArray>(
      nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<2>>(values->data(), {rows, std::size_t{8}}, owner)));
}

}  // namespace

Rig with_pass_heeded(const Config& config) {
  Rig rig = config.rig;
  heed_missing_pass(config.source, rig, load_reference_positions);
  return rig;
}

void bind_law(nb::module_& m) {
  nb::class_<Law>(m, "Law", "The control law of a config along its reference, whose time 0 is the first step.")
      .def(nb::init<const Config&>(), nb::arg("config"))
      .def("step", &Law::step, nb::arg("x_m"), nb::arg("p1_Pa"), nb::arg("p2_Pa"), nb::arg("p1_port_Pa") = nb::none(),
           nb::arg("p2_port_Pa") = nb::none(), nb::arg("p_supply_Pa") = none,
           "One period: position [m], absolute pressures that close the force loop, at the ports and of the supply "
           "[Pa].\n"
           "Gives the command [V], for a servo table one a valve.")
      .def("run", &Law::run, nb::arg("x_m"), nb::arg("p1_Pa"), nb::arg("p2_Pa"), nb::arg("p1_port_Pa") = nb::none(),
           nb::arg("p2_port_Pa") = nb::none(), nb::arg("p_supply_Pa") = none,
           "A period a row, arrays of shape (rows,). Gives u_V (u1_V and u2_V of a servo table) and v_mps, the law's\n"
           "filtered velocity, each of shape (rows,).")
      .def("reset", &Law::reset, "To the reference's time 0; integral and filters are forgotten.")
      .def("reference", &Law::reference_at, nb::arg("t_s"),
           "Position and its derivatives 1 to 7 [m, m/s, ...] at times [s]: shape (rows, 8).")
      .def_prop_ro("terms", &Law::terms, "What the law records of the last step, by the columns of a recording.")
      .def_prop_ro("v_mps", &Law::speed_mps, "Velocity as the law filtered it [m/s]; an estimator takes it.")
      .def_prop_ro("limited", &Law::limited, "Whether the last command was limited.")
      .def_prop_ro("lead_s", &Law::lead_s, "How far ahead the law looks along the reference [s].")
      .def_prop_ro("tick", &Law::tick, "Periods so far.");
}

}  // namespace pneuservo::python
