// The verification cases of references (V15) and of the velocity filter (V16).
#include <catch2/catch.hpp>

#include <yaml-cpp/yaml.h>

#include <pneuservo/control/pd_force.hpp>
#include <pneuservo/control/smoothstep.hpp>

#include "control/reference_kinds.hpp"
#include "control/test_axis.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {
YAML::Node checks_of(const std::string& id) {
  for (const YAML::Node& one : YAML::LoadFile(PNEUSERVO_SOURCE_DIR "/tests/data/verification/cases.yaml")["cases"])
    if (one["id"].as<std::string>() == id) return one["checks"];
  FAIL("no case " << id);
  return {};
}
void compare(const YAML::Node& check, const std::vector<double>& got) {
  const auto expected = check["value"].IsSequence() ? check["value"].as<std::vector<double>>()
                                                    : std::vector<double>{check["value"].as<double>()};
  const std::string kind = check["tolerance_kind"].as<std::string>();
  const double tolerance = check["tol_10"].as<double>();
  REQUIRE(got.size() == expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    const double scale = kind == "scaled"     ? check["scale"][i].as<double>()
                         : kind == "relative" ? std::fabs(expected[i])
                                              : 1.0;
    INFO(check["id"].as<std::string>() << " [" << i << "]: got " << got[i] << ", expected " << expected[i]
                                       << ", tolerance " << tolerance * scale);
    CHECK(std::fabs(got[i] - expected[i]) <= tolerance * scale);
  }
}
ReferenceSpec move_of(int degree) {
  ReferenceSpec s;
  s.kind = ReferenceKind::minimum_jerk;
  s.end_m = 0.1;
  s.duration_s = 0.5;
  s.smoothness = degree;
  return s;
}
double peak(const Reference& r, int order) {
  const ReferenceExtremes e = r.extremes(order, 0.5 * (1.0 - 1e-15));
  return std::max(std::fabs(e.minimum), std::fabs(e.maximum));
}
}  // namespace

TEST_CASE("V15: every check of the polynomials and the ramped sine") {
  const YAML::Node checks = checks_of("V15");
  int done = 0;
  for (const YAML::Node& check : checks) {
    const std::string quantity = check["quantity"].as<std::string>();
    const YAML::Node at = check["at"];
    if (quantity == "coefficients_of_s_ascending") {
      const int degree = at["degree"].as<int>();
      const auto c = smoothstep_coefficients(degree);
      compare(check, std::vector<double>(c.begin(), c.begin() + degree + 1));
    } else if (quantity == "position_and_derivatives_1_to_5") {
      const ReferenceSpec spec = at["degree"]
                                     ? move_of(at["degree"].as<int>())
                                     : sine_spec(at["amplitude_m"].as<double>(), at["frequency_Hz"].as<double>());
      const ReferencePoint p = Reference(spec).at(at["t_s"].as<double>());
      compare(check, std::vector<double>(p.d.begin(), p.d.begin() + 6));
    } else if (quantity == "peak_of_derivatives_1_to_5") {
      std::vector<double> got;
      for (int order = 1; order <= 5; ++order) got.push_back(peak(Reference(move_of(at["degree"].as<int>())), order));
      compare(check, got);
    } else {
      const int order = quantity == "peak_velocity_factor"       ? 1
                        : quantity == "peak_acceleration_factor" ? 2
                        : quantity == "peak_jerk_factor"         ? 3
                                                                 : 0;
      CAPTURE(quantity);
      REQUIRE(order > 0);
      compare(check, {peak(Reference(move_of(at["degree"].as<int>())), order) / 0.1 * std::pow(0.5, order)});
    }
    ++done;
  }
  REQUIRE(done >= 44);
}

TEST_CASE("V16: every check of the velocity filter") {
  const YAML::Node checks = checks_of("V16");
  const auto step = [](PdForce& control, double x) {
    const ReferencePoint r{};
    control.step(x, 470e3, 540e3, r, r);
    return control.state().v_mps;
  };
  int done = 0;
  for (const YAML::Node& check : checks) {
    const std::string quantity = check["quantity"].as<std::string>();
    PdForce control(nominal_gains(), nominal_axis(), 0.001);
    step(control, 0.0);
    if (quantity == "velocity_filter_a") {
      compare(check, {step(control, 0.001)});
    } else if (quantity == "velocity_after_unit_ramp") {
      double v = 0.0;
      for (int i = 1; i <= check["at"]["samples"].as<int>(); ++i) v = step(control, 0.001 * i);
      compare(check, {v});
    } else if (quantity == "velocity_gain" || quantity == "velocity_phase") {
      // Velocity of a position sine of amplitude 1/w, once settled, against cos(w t).
      const double w = 2.0 * M_PI * check["at"]["frequency_Hz"].as<double>();
      double in_phase = 0.0, quadrature = 0.0;
      for (int i = 1; i <= 4000; ++i) {
        const double v = step(control, std::sin(w * 0.001 * i) / w);
        if (i <= 2000) continue;
        in_phase += v * std::cos(w * 0.001 * i) / 1000.0;
        quadrature += v * -std::sin(w * 0.001 * i) / 1000.0;
      }
      const double gain = std::hypot(in_phase, quadrature), phase = std::atan2(quadrature, in_phase) * 180.0 / M_PI;
      compare(check, {quantity == "velocity_gain" ? gain : phase});
    } else if (quantity == "velocity_noise_gain") {
      double squares = 0.0, v = step(control, 1.0);  // impulse response: white noise adds its squares
      for (int i = 0; i < 200; ++i) {
        squares += v * v;
        v = step(control, 0.0);
      }
      compare(check, {std::sqrt(squares)});
    } else {
      continue;  // the observer of the servo table has its own test
    }
    ++done;
  }
  REQUIRE(done == 16);
}
