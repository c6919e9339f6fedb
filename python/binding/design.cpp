// The design of a config's axis: models, gains, poles, margins.
#include <complex>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "binding.hpp"
#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "design/axis_design.hpp"
#include "design/state_space.hpp"
#include "record/import.hpp"
#include "report/design_json.hpp"

namespace pneuservo::python {
namespace {

struct Design {
  Rig rig;
  AxisDesign design;
};

DesignMethod method_named(const std::string& name) {
  for (std::size_t i = 0; i < design_method_names.size(); ++i)
    if (name == design_method_names[i]) return static_cast<DesignMethod>(i);
  throw nb::value_error(
      fmt::format("design: method: found '{}', expected one of {}", name, fmt::join(design_method_names, ", "))
          .c_str());
}

std::unique_ptr<Design> design(const Config& config, const std::string& method,
                               std::optional<double> position_gain_V_per_m, double alpha, double beta, double c6,
                               double c5) {
  DesignRequest request{.method = method_named(method),
                        .position_gain_V_per_m = position_gain_V_per_m,
                        .alpha = alpha,
                        .beta = beta,
                        .c_1 = c6,
                        .c_2 = c5};
  pneumatic(config, "design");
  const nb::gil_scoped_release released;
  try {
    return std::unique_ptr<Design>(new Design{config.rig, design_axis(config.rig, request, load_reference_positions)});
  } catch (const std::invalid_argument& error) { throw InputError(config.source + ": " + error.what()); }
}

FloatArray matrix(const Eigen::MatrixXd& from, std::size_t rows, std::size_t columns) {
  auto* const values = new std::vector<double>(rows * columns, 0.0);
  const nb::capsule owner(values, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  for (Eigen::Index r = 0; r < from.rows(); ++r)
    for (Eigen::Index c = 0; c < from.cols(); ++c)
      (*values)[static_cast<std::size_t>(r) * columns + static_cast<std::size_t>(c)] = from(r, c);
  return nb::borrow<FloatArray>(
      nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<2>>(values->data(), {rows, columns}, owner)));
}

/// A, B, C, D of the axis of that order, without its delay.
Matrices matrices(const Design& self, std::optional<int> order) {
  const ModelFigures* found = order ? nullptr : &self.design.models.back();
  for (const ModelFigures& model : self.design.models)
    if (order && model.axis.order() == *order) found = &model;
  if (found == nullptr) {
    std::vector<int> orders;
    for (const ModelFigures& model : self.design.models) orders.push_back(model.axis.order());
    throw nb::value_error(
        fmt::format("state_space: order: found {}, expected one of {}", *order, fmt::join(orders, ", ")).c_str());
  }
  const StateSpace s = continuous_axis(found->axis);
  const auto n = static_cast<std::size_t>(s.A.rows()), inputs = static_cast<std::size_t>(s.B.cols()),
             outputs = static_cast<std::size_t>(s.C.rows());
  return nb::borrow<Matrices>(
      nb::make_tuple(matrix(s.A, n, n), matrix(s.B, n, inputs), matrix(s.C, outputs, n), matrix(s.D, outputs, inputs)));
}

}  // namespace

void bind_design(nb::module_& m) {
  nb::class_<Design>(m, "Design", "Linear models of an axis, its gains, poles and margins.")
      .def(
          "json", [](const Design& d) { return design_json(d.rig, d.design, false).dump(); }, "As the verb's --json.")
      .def("matrices", &matrices, nb::arg("order") = nb::none(),
           "A (n, n), B (n, 1), C (3, n), D (3, 1) of the axis from command [V] to position [m], velocity [m/s] and\n"
           "acceleration [m/s2] in continuous time, without its delay. order: 3, 5, ...; default: the full one.")
      .def_prop_ro(
          "delay_s", [](const Design& d) { return d.design.delay_s; }, "From the command to the valve [s].")
      .def_prop_ro("is_stable", [](const Design& d) { return d.design.is_stable; })
      .def_prop_ro("warnings", [](const Design& d) { return d.design.warnings; })
      .def_prop_ro(
          "config",
          [](const Design& d) {
            Rig designed = d.rig;
            designed.controller = d.design.controller;
            return Config{designed, d.rig.name + ", designed"};
          },
          "The config with the design's gains.");
  m.def("design", &design, nb::arg("config"), nb::arg("method") = "config",
        nb::arg("position_gain_V_per_m") = nb::none(), nb::arg("alpha") = 2.0, nb::arg("beta") = 2.0,
        nb::arg("c6") = 11.0, nb::arg("c5") = 45.0,
        "The verb design: method config, alpha_beta, itae_7, itae_min or margins.");
}

}  // namespace pneuservo::python
