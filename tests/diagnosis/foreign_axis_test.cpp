// Axes unlike ours with planted physics: slow creeps, one short stroke, a lever with a weight, rows far apart.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/slider.hpp>

#include "config/read_rig.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/result_text.hpp"
#include "diagnosis/search/candidates.hpp"
#include "diagnosis/search/shown_candidates.hpp"
#include "diagnosis/verdict/left_over.hpp"

using namespace pneuservo;

namespace {

/// An owner who believes the axis to be a mass alone.
Rig plain_axis(double mass_kg, double period_s, double force_max_N, double stroke_m, double noise_m) {
  Rig rig = parse_rig(R"(
format: pneuservo-rig/1
name: plain
rig: driven_axis
period_s: 0.001
slider:   {mass_kg: 1.0, viscous_friction_Ns_per_m: 0.0, stroke_m: 0.6, force_max_N: 300.0}
sensors:
  position: {quantum_m: 0.0, noise_m: 1.0e-6}
  force:    {quantum_N: 0.0, noise_N: 0.0}
controller: {kind: pd_force, position_gain_N_per_m: 1.0, velocity_gain_Ns_per_m: 1.0, velocity_filter_s: 0.0}
reference: {kind: sine, amplitude_m: 0.12, frequency_Hz: 0.8}
tolerances: {slider.mass_kg: 0.02}
)",
                      "plain axis");
  rig.axis.slider.mass_kg = mass_kg;
  rig.period_s = period_s;
  rig.drive.force_max_N = force_max_N;
  rig.axis.cylinder.stroke_m = stroke_m;
  rig.sensors.position.noise_m = noise_m;
  return rig;
}

struct Course {
  std::function<double(double)> wanted;
  double duration_s, stiffness_N_per_m, damping_Ns_per_m;
};

/// Rows of the machine under a spring and a damper that pull it along the course; the force is the mean of a row.
Recording recorded(const Rig& machine, const Course& course, std::uint64_t seed) {
  Slider<double> slider;
  slider.configure(machine.axis.slider, machine.axis.effects.motion, machine.axis.cylinder.stroke_m, 0.0);
  slider.reset(course.wanted(0), 0);
  Random random(seed);
  Recording out;
  out.path = "made here";
  out.period_s = machine.period_s;
  out.names = {"t_s", "x_m", "F_N"};
  out.values.resize(3);
  const int substeps = static_cast<int>(std::ceil(machine.period_s / 5e-5));
  const double h = machine.period_s / substeps;
  for (double t = 0; t < course.duration_s; t += machine.period_s) {
    out.values[0].push_back(t);
    out.values[1].push_back(slider.position() + machine.sensors.position.noise_m * random.normal());
    double sum = 0;
    for (int i = 0; i < substeps; ++i) {
      const double force = course.stiffness_N_per_m * (course.wanted(t + i * h) - slider.position()) -
                           course.damping_Ns_per_m * slider.velocity();
      sum += force;
      slider.step(h, force, {});
    }
    out.values[2].push_back(sum / substeps);
    out.line_numbers.push_back(out.line_numbers.size() + 2);
  }
  return out;
}

/// There and back at one speed.
double sawtooth(double t, double way, double speed) {
  const double lap = std::fmod(t, 2 * way / speed) * speed;
  return lap < way ? lap : 2 * way - lap;
}

double size_of(const Diagnosis& found, const std::string& effect, const std::string& key) {
  for (const DiagnosisAnswer& answer : found.answers)
    for (const EstimatedParameter& p : answer.parameters)
      if (answer.effect == effect && p.name == key) return p.value;
  return std::nan("");
}

}  // namespace

TEST_CASE("a creep of half a millimetre a second is motion where the position is known to a micrometre") {
  const Rig owner = plain_axis(0.232, 0.02, 20, 0.2, 1e-6);
  Rig machine = owner;
  machine.axis.effects.motion.coulomb_friction.force_N = 0.4;
  const Diagnosis found =
      diagnose(owner, {recorded(machine, {[](double t) { return sawtooth(t, 4e-3, 5e-4); }, 64, 2000, 30}, 3)});
  INFO(diagnosis_text(found));
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers[0].effect == "coulomb_friction");
  CHECK(size_of(found, "coulomb_friction", "force_N") == Approx(0.4).epsilon(0.02));
  CHECK(found.admitted_s + found.held_out_s == Approx(63).epsilon(0.03));  // rows of 100 ms, told as such
}

TEST_CASE("one stroke of two thirds of a second tells dry and viscous friction, and nothing of the way back") {
  const Rig owner = plain_axis(25, 1.0 / 1500, 1000, 0.5, 1e-6);
  Rig machine = owner;
  machine.axis.effects.motion.coulomb_friction.force_N = 17;
  machine.axis.effects.motion.viscous_friction.coefficient_Ns_per_m = 44;
  const auto stroke = [](double t) {
    const double s = std::clamp((t - 0.05) / 0.5, 0.0, 1.0);
    return 0.15 * s * s * s * (10 - 15 * s + 6 * s * s);
  };
  const Diagnosis found = diagnose(owner, {recorded(machine, {stroke, 0.68, 4e5, 5e3}, 5)});
  INFO(diagnosis_text(found));
  REQUIRE(found.answers.size() == 2);
  CHECK(size_of(found, "coulomb_friction", "force_N") == Approx(17).epsilon(0.05));
  CHECK(size_of(found, "viscous_friction", "coefficient_Ns_per_m") == Approx(44).epsilon(0.05));
  for (const RankedExplanation& tried : found.candidates)
    for (const std::string& effect : tried.effects) CHECK_FALSE(effect.starts_with("direction_dependent_"));
}

TEST_CASE("a weight on a lever is told from a spring by rows of 15 ms over more than a right angle") {
  const Rig owner = plain_axis(2.4, 0.015, 200, 8, 2e-5);
  Rig machine = owner;
  machine.axis.effects.motion.coulomb_friction.force_N = 12;
  machine.axis.effects.motion.gravity_load = {38, 9};
  std::vector<Recording> recordings;
  for (const double speed : {0.1, 0.3, 0.7})
    recordings.push_back(
        recorded(machine, {[=](double t) { return sawtooth(t, 2.2, speed) - 0.6; }, 25, 3000, 150}, 7));
  const Diagnosis found = diagnose(owner, recordings);
  INFO(diagnosis_text(found));
  REQUIRE(found.answers.size() == 2);
  CHECK(size_of(found, "coulomb_friction", "force_N") == Approx(12).epsilon(0.05));
  CHECK(size_of(found, "gravity_load", "sine_N") == Approx(38).epsilon(0.03));
  CHECK(size_of(found, "gravity_load", "cosine_N") == Approx(9).epsilon(0.06));
}

/// Rows of one recording that goes at these speeds, one after the other, half a second each.
std::vector<ResidualRow> rows_of(const std::vector<double>& speeds_mps) {
  std::vector<ResidualRow> rows;
  double x_m = 0;
  for (const double speed : speeds_mps)
    for (int i = 0; i < 50; ++i) {
      ResidualRow row{};
      row.position_m = x_m += 0.01 * speed;
      row.velocity_mps = speed;
      rows.push_back(row);
    }
  return rows;
}

TEST_CASE("names that a motion does not show, or that an owner has stated, are not offered") {
  const auto has = [](const Rig& rig, const std::vector<double>& speeds_mps, const std::string& name) {
    const std::vector<ResidualRow> rows = rows_of(speeds_mps);
    const std::vector<Candidate> all =
        shown_candidates(all_candidates(rig, {{"F", "N", 0, 1}}, motion_range(rows)), rows);
    return std::any_of(all.begin(), all.end(), [&](const Candidate& c) { return c.name == name; });
  };
  Rig rig = plain_axis(2, 0.001, 100, 4, 1e-6);
  const std::vector<double> rich{0.5, -0.5, 0.1, -0.1}, wide{1.5, -1.5, 3, -3}, one_way{0.1, 0.3, 0.5},
      one_speed{0.3, -0.3, 0.3, -0.3};
  for (const char* name : {"viscous_friction", "direction_dependent_friction", "direction_dependent_viscous_friction",
                           "stribeck_friction", "quadratic_drag", "friction_zone", "elastic_friction"}) {
    INFO(name);
    CHECK(has(rig, rich, name));
  }
  CHECK_FALSE(has(rig, rich, "gravity_load"));
  CHECK(has(rig, wide, "gravity_load"));
  for (const char* name :
       {"direction_dependent_friction", "direction_dependent_viscous_friction", "friction_zone", "elastic_friction"})
    CHECK_FALSE(has(rig, one_way, name));
  for (const char* name : {"viscous_friction", "coulomb_friction", "stribeck_friction"}) CHECK(has(rig, one_way, name));
  for (const char* name :
       {"viscous_friction", "direction_dependent_viscous_friction", "stribeck_friction", "quadratic_drag"})
    CHECK_FALSE(has(rig, one_speed, name));
  CHECK(has(rig, one_speed, "direction_dependent_friction"));
  rig.axis.slider.viscous_friction_Ns_per_m = 30;
  rig.tolerances["slider.viscous_friction_Ns_per_m"] = 0.1;
  CHECK_FALSE(has(rig, rich, "viscous_friction"));
}

TEST_CASE(
    "physical ranges bound what is tried: friction takes energy, a gain stays near one, gas warms by its charging") {
  const auto bounds = [](const Rig& rig, const std::string& name, std::size_t parameter) {
    for (const Candidate& c : all_candidates(rig, {{"F", "N", 0, 1}, {"p1_chamber", "Pa", 0, 1}}, {0, 0.2, 0.2}))
      if (c.name == name) {
        const FreeParameter& p = c.parameters[parameter];
        return std::pair(p.value(p.lower), p.value(p.upper));
      }
    FAIL("no candidate " << name);
    return std::pair(0.0, 0.0);
  };
  Rig rig = plain_axis(2, 0.001, 100, 0.6, 1e-6);
  rig.axis.slider.viscous_friction_Ns_per_m = 30;
  CHECK(bounds(rig, "direction_dependent_viscous_friction", 1).first == Approx(-30));
  CHECK(bounds(rig, "sensor_gain:F", 0).first == Approx(0.5));
  CHECK(bounds(rig, "sensor_gain:F", 0).second == Approx(2.0));
  const Rig tank = parse_rig(R"(format: pneuservo-rig/1
name: tank
rig: vessel
period_s: 0.1
air: {temperature_K: 300}
supply: {pressure_Pa: 202650}
valve: {exhaust_area_m2: 2.0e-6}
vessel: {volume_m3: 0.1}
sensors: {pressure: {quantum_Pa: 10.0, noise_Pa: 200.0}}
program: {times_s: [0.0], commands: [-1.0]}
)",
                             "tank");
  // To half its pressure gas of 300 K cools to 300 0.5^((kappa - 1)/kappa) = 246.1 K without heat.
  CHECK(bounds(tank, "charging_heat", 0).second == Approx(53.90).epsilon(1e-3));
  CHECK(bounds(tank, "charging_heat", 0).first == 0);  // charging warms
  const auto has_charging_heat = [&](double first_Pa) {
    const std::vector<Candidate> all = all_candidates(tank, {{"p1_chamber", "Pa", 0, 1}}, {.first_Pa = first_Pa});
    return std::any_of(all.begin(), all.end(), [](const Candidate& c) { return c.name == "charging_heat"; });
  };
  CHECK(has_charging_heat(150e3));
  CHECK_FALSE(has_charging_heat(101325));  // nothing has charged it
}

TEST_CASE("periodic parts are sought below half the rate of the rows alone: a mean is no sine of that rate") {
  std::vector<ResidualRow> rows;
  Eigen::VectorXd mean(600), sine(600);
  for (int i = 0; i < 600; ++i) {
    ResidualRow row;
    row.time_s = 0.075 * i;
    row.velocity_mps = 0.2;
    rows.push_back(row);
    mean(i) = 5.0 + (i % 7 == 0 ? 0.1 : 0.0);
    sine(i) = 3.0 * std::sin(2 * M_PI * 4.2 * row.time_s);
  }
  const auto of_mean = line_in_motion(rows, mean, 0);
  CHECK((!of_mean || of_mean->ratio < 0.01));  // 13.33 Hz on rows of 75 ms would take all of it
  const auto of_sine = line_in_motion(rows, sine, 0);
  REQUIRE(of_sine);
  CHECK(of_sine->frequency_Hz == Approx(4.2).margin(0.02));
  const auto line = strongest_line(rows, sine);
  REQUIRE(line);
  CHECK(line->frequency_Hz == Approx(4.2).margin(0.02));
}
