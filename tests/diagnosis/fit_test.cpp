// Fits: a narrow bent valley is followed to its end, parameters stay in their bounds.
#include <catch2/catch.hpp>

#include <cmath>

#include "diagnosis/closed_form_model.hpp"
#include "diagnosis/search/fit.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

/// Two numbers that nearly stand for each other: residuals of a valley b = a + a^2/8 some 1e-4 wide and 1 long.
namespace bent_valley {
constexpr double across = 3000, along = 12, end = 1.2;
constexpr double floor = 60;  ///< a residual that nothing moves
ClosedFormModel model() {
  return ClosedFormModel([](const Rig& rig) {
    const double a = rig.axis.slider.mass_kg - 2, b = rig.axis.slider.payload_kg - 2;
    return std::vector{across * (b - a - a * a / 8), along * (a - end), floor};
  });
}
}  // namespace bent_valley

Fit valley_fit() {
  Fit fit;
  for (const char* path : {"slider.mass_kg", "slider.payload_kg"}) {
    FreeParameter parameter = free_number(fit.base.rig, path);
    parameter.center = 2;
    parameter.spread = 1;
    parameter.lower = -3;
    parameter.upper = 3;
    fit.parameters.push_back(parameter);
  }
  fit.base.rig.axis.slider.mass_kg = fit.base.rig.axis.slider.payload_kg = 2;
  fit.own_count = 2;
  fit.z.setZero(2);
  return fit;
}

/// Eighty rows that two numbers move, freed from whichever slow error is wanted; the last ten are held out.
class FreedModel final : public ClosedFormModel {
 public:
  FreedModel() : ClosedFormModel(rows_of) {
    for (std::size_t k = 0; k < rows_.size(); ++k) rows_[k].time_s = 0.01 * static_cast<double>(k);
    hold_out_from(70);
  }
  LikeliestErrors likeliest_slow_errors(const Hypothesis&) override { return {{wanted}, 0}; }
  SlowError wanted;

 private:
  static std::vector<double> rows_of(const Rig& rig) {
    std::vector<double> rows;
    for (int k = 0; k < 80; ++k)
      rows.push_back(5 * std::sin(0.2 * k) * (rig.axis.slider.mass_kg - 2.3) + 0.1 * k * rig.axis.slider.payload_kg);
    return rows;
  }
};

}  // namespace

TEST_CASE("derivatives beside one slow error become those beside another, and plain ones again") {
  FreedModel model;
  FittedRows rows(model, {});
  Fit kept = valley_fit();
  linearise(rows, {&kept});
  const Fit plain = kept;
  for (const SlowError& error : {SlowError{0.5, 3.0}, SlowError{0.05, 10.0}}) {
    model.wanted = error;
    rows.take_slow_error(kept.hypothesis());
    bring_to_slow_error(rows, kept);
    Fit anew = valley_fit();
    linearise(rows, {&anew});
    CHECK((kept.jacobian - anew.jacobian).norm() < 1e-8 * anew.jacobian.norm());
    CHECK((kept.residual - anew.residual).norm() < 1e-8 * anew.residual.norm());
    CHECK(kept.objective == Approx(anew.objective));
    CHECK((anew.jacobian - plain.jacobian).norm() > 0.1 * plain.jacobian.norm());
  }
  rows.drop_slow_error();
  bring_to_slow_error(rows, kept);
  CHECK((kept.jacobian - plain.jacobian).norm() < 1e-8 * plain.jacobian.norm());
}

TEST_CASE("a fit that cannot be computed where it begins has failed, and the others go on") {
  ClosedFormModel model([](const Rig& rig) {
    const double a = rig.axis.slider.mass_kg - 2;
    return std::vector{a < -1 ? std::nan("") : 3 * a - 3, 1.0};
  });
  FittedRows rows(model, {});
  Fit lost = valley_fit(), other = valley_fit();
  lost.z(0) = -1.5;
  improve(rows, {&lost, &other}, 4, Columns::all);
  CHECK(lost.failed);
  CHECK_FALSE(other.failed);
  CHECK(other.z(0) == Approx(9.0 / 10));  // (3 a - 3)^2 + a^2
}

TEST_CASE("a fit follows a narrow bent valley to its end") {
  ClosedFormModel model = bent_valley::model();
  FittedRows rows(model, {});
  Fit fit = valley_fit();
  improve(rows, {&fit}, 6, Columns::all);
  // With the residual across the valley at 0 the objective is one of a alone.
  double least = 1e300;
  for (double a = 0.9; a < 1.3; a += 1e-5)
    least =
        std::min(least, std::pow(bent_valley::along * (a - bent_valley::end), 2) + a * a + std::pow(a + a * a / 8, 2));
  CAPTURE(fit.z(0), fit.z(1), fit.objective, least);
  CHECK(fit.objective - bent_valley::floor * bent_valley::floor < least + 0.2);
}

TEST_CASE("a fit that a bound holds ends on it, at the best place there") {
  ClosedFormModel model = bent_valley::model();
  FittedRows rows(model, {});
  Fit fit = valley_fit();
  fit.parameters[0].upper = 0.5;
  improve(rows, {&fit}, 6, Columns::all);
  CHECK(fit.z(0) == Approx(0.5));
  CHECK(fit.z(1) == Approx(0.5 + 0.125 * 0.25).epsilon(1e-4));
}

TEST_CASE("kept derivatives that follow their steps lead to the minimum, kept as they were they do not") {
  // The second number is a nuisance whose derivatives change with both.
  ClosedFormModel model([](const Rig& rig) {
    const double a = rig.axis.slider.mass_kg - 2, b = rig.axis.slider.payload_kg - 2;
    return std::vector{30 * (a - 1.5), 20 * (b + 0.8 * b * b - 2), 12 * (a * b - 2)};
  });
  FittedRows rows(model, {});
  const auto objective = [&](Columns columns) {
    Fit fit = valley_fit();
    fit.own_count = 1;
    improve(rows, {&fit}, 6, columns, 1e-6);
    return fit.objective;
  };
  const double least = objective(Columns::all);
  CHECK(objective(Columns::corrected) == Approx(least).margin(1e-3));
  CHECK(objective(Columns::own) > least + 0.05);
}

TEST_CASE("tolerances are counted at both ends of their range, and neither what has none nor what is sought") {
  Rig owner;
  owner.tolerances = {{"slider.mass_kg", 0.1}, {"slider.payload_kg", 0.1}};
  Fit fit = valley_fit();
  fit.own_count = 0;
  fit.z << 3, -3;
  CHECK(tolerances_at_end(owner, fit) == 2);
  fit.z << 2.9, -3;
  CHECK(tolerances_at_end(owner, fit) == 1);
  fit.own_count = 1;
  fit.z << 3, 0;
  CHECK(tolerances_at_end(owner, fit) == 0);
  fit.own_count = 0;
  owner.tolerances.erase("slider.mass_kg");
  CHECK(tolerances_at_end(owner, fit) == 0);
}
