// The list of laws: names and numbers agree, terms are those of the last step, and a law is found for each kind of rig.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>

#include <pneuservo/control/axis_controller.hpp>
#include <pneuservo/rig/rig.hpp>

#include "control/test_axis.hpp"
#include "core/test_seed.hpp"

using namespace pneuservo;

namespace {

double recorded(const AxisController& controller, ControllerKind law, bool stepped, std::string_view name) {
  std::array<double, 16> terms{};
  controller.write_terms(stepped, terms);
  const auto names = law_columns(law);
  const auto at = std::find(names.begin(), names.end(), name);
  REQUIRE(at != names.end());
  return terms[static_cast<std::size_t>(at - names.begin())];
}

/// Ends of column names by unit.
std::string suffix_of(std::string_view unit) {
  std::string out = unit == "m s" ? "m_s" : unit == "V/(m s)" ? "V_per_m_s" : std::string(unit);
  if (const std::size_t at = out.find("m/s"); at == 0) out = "mps" + out.substr(3);
  if (out == "kg/s") out = "kgps";
  if (const std::size_t at = out.find('/'); at != std::string::npos) out.replace(at, 1, "_per_");
  std::erase(out, ' ');
  return out;
}

}  // namespace

TEST_CASE("each law has a name, keys and terms of its own, and each rig with a controller a law") {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < law_count; ++i) {
    const auto law = static_cast<ControllerKind>(i);
    CHECK(names.insert(name_of(law)).second);
    std::set<std::string_view> columns;
    for (const LawTerm& term : law_terms(law)) {
      INFO(name_of(law) << ", " << term.name);
      CHECK(columns.insert(term.name).second);
      CHECK_FALSE(term.help.empty());
      if (!term.unit.empty()) CHECK(term.name.ends_with(std::string(1, '_').append(suffix_of(term.unit))));
    }
  }
  CHECK(name_of(kind_of<PdForce>) == "pd_force");
  CHECK(name_of(kind_of<Ppd2>) == "ppd2");
  CHECK(laws_of(RigKind::cylinder) == std::vector{kind_of<PdForce>});
  CHECK(laws_of(RigKind::servo_table) == std::vector{kind_of<Ppd2>});
  CHECK(laws_of(RigKind::driven_axis) == std::vector{kind_of<PdForce>});
  CHECK(laws_of(RigKind::vessel).empty());
  CHECK(laws_of(RigKind::pressure) == std::vector{kind_of<PressurePi>});
}

TEST_CASE("the recorded terms of pd_force add up to its command") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  ControllerParameters parameters;
  PdForceParameters& p = parameters.of<PdForce>();
  p = test::nominal_gains();
  p.force_integral_V_per_Ns = 0.05;
  const AxisParameters<double> axis = test::nominal_axis();
  AxisController controller;
  controller.configure(parameters, axis, 0.001, {}, 1.0);
  const auto term = [&](std::string_view name) { return recorded(controller, kind_of<PdForce>, true, name); };
  for (int k = 0; k < 200; ++k) {
    ControlInput in;
    in.x_m = 0.1 * share(generator);
    in.pressure_Pa = {470e3 + 5e4 * share(generator), 540e3 + 5e4 * share(generator)};
    in.now.d[0] = 0.1 * share(generator);
    in.now.d[1] = 0.1 * share(generator);
    const ControlOutput out = controller.step(in);
    CHECK(term("position_error_m") == in.now.d[0] - in.x_m);
    CHECK(term("chamber_force_N") ==
          Approx(axis.cylinder.area_1_m2 * in.pressure_Pa[0] - axis.cylinder.area_2_m2 * in.pressure_Pa[1] -
                 (axis.cylinder.area_1_m2 - axis.cylinder.area_2_m2) * axis.air.atmosphere_Pa));
    CHECK(term("force_reference_N") == Approx(p.position_gain_N_per_m * (in.now.d[0] - in.x_m) +
                                              p.velocity_gain_Ns_per_m * (in.now.d[1] - out.speed_mps)));
    CHECK(term("force_error_N") == term("force_reference_N") - term("chamber_force_N"));
    CHECK(term("u_unlimited_V") ==
          Approx(p.force_gain_V_per_N * term("force_error_N") +
                 p.force_integral_V_per_Ns * term("force_error_integral_Ns") + term("u_feedforward_V")));
    CHECK((term("command_limit") != 0.0) == (out.command_V[0] != term("u_unlimited_V")));
    CHECK(out.limited == (term("command_limit") != 0.0));
  }
}

TEST_CASE("without a step a law records its gains and nothing else") {
  ControllerParameters parameters;
  parameters.kind = kind_of<Ppd2>;
  parameters.of<Ppd2>().position_gain_V_per_m = 1200.0;
  AxisController controller;
  controller.configure(parameters, test::symmetric_axis(), 0.0002, {}, 1.0);
  std::array<double, 16> terms{};
  controller.write_terms(false, terms);
  for (std::size_t i = 0; i < law_terms(parameters.kind).size(); ++i) {
    INFO(law_columns(parameters.kind)[i]);
    CHECK(std::isfinite(terms[i]) == law_terms(parameters.kind)[i].is_standing);
  }
  CHECK(recorded(controller, parameters.kind, false, "position_gain_V_per_m") == 1200.0);
  controller.change_gains({1500.0, 2.0, 3.0, 4.0});
  controller.step({});
  CHECK(recorded(controller, parameters.kind, false, "position_gain_V_per_m") == 1500.0);
  CHECK(recorded(controller, parameters.kind, true, "integral_gain_V_per_m_s") == 4.0);
}
