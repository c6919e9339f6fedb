// Screening: standard errors of a candidate beside a parameter at its bound, against the closed form.
#include <catch2/catch.hpp>

#include <cmath>

#include "diagnosis/closed_form_model.hpp"
#include "diagnosis/search/screening.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

FreeParameter number_about_two(const Rig& rig, const char* path, double lower) {
  FreeParameter parameter = free_number(rig, path);
  parameter.center = 2;
  parameter.lower = lower;
  return parameter;
}

}  // namespace

TEST_CASE(
    "a parameter that pushes against its bound stays there for what rows say, and follows for what they may say") {
  // Columns (10, 8, 0) of the mass and (0, 6, 6) of the payload, which the constant ones push below its bound.
  ClosedFormModel model([](const Rig& rig) {
    const double mass = rig.axis.slider.mass_kg - 2, payload = rig.axis.slider.payload_kg - 2;
    return std::vector{10 * mass + 1, 8 * mass + 6 * payload + 1, 6 * payload + 1};
  });
  FittedRows rows(model, {});
  Rig rig;
  rig.axis.slider.mass_kg = rig.axis.slider.payload_kg = 2;
  Fit base = fit_at_start(rig, rows, {}, {number_about_two(rig, "slider.payload_kg", 0)});
  linearise(rows, {&base});
  Candidate mass{.name = "mass", .element = "motion"};
  mass.parameters = {number_about_two(rig, "slider.mass_kg", -3)};
  mass.negligible = {0};
  mass.neutral = {2};
  mass.starts = {{0}};
  mass.amplitude = {1};
  const auto error = [&](AtBound at_bound) {
    const std::vector<Candidate> candidates{mass};
    return Screening(rows, base, candidates, {0}, at_bound).singles().front().standard_error.front();
  };
  // Curvature c'c + 1, with the prior; less (c's)^2 / (s's + 1) where the payload follows.
  CHECK(error(AtBound::held) == Approx(1 / std::sqrt(164.0 + 1)));
  CHECK(error(AtBound::follows) == Approx(1 / std::sqrt(164.0 + 1 - 48.0 * 48 / 73)));
}
