// References: known answers, derivatives against differences, joints, rest outside the motion, errors.
#include <catch2/catch.hpp>

#include <random>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/control/smoothstep.hpp>

#include "control/reference_kinds.hpp"
#include "core/test_seed.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {
ReferenceSpec move(double start_m, double end_m, double duration_s, int degree) {
  ReferenceSpec s;
  s.kind = ReferenceKind::waypoints;
  s.times_s = {0.0, duration_s};
  s.positions_m = {start_m, end_m};
  s.smoothness = degree;
  return s;
}
/// Breakpoints of all references above lie on this list; differences across them are not taken.
bool near_joint(const NamedReference& r, double t, double h) {
  std::vector<double> joints{0.0};
  switch (r.spec.kind) {
    case ReferenceKind::sine: joints = {0.25, 0.25 + 1.0 / 1.3}; break;
    case ReferenceKind::multisine: joints = {0.1, 1.0}; break;
    case ReferenceKind::waypoints: joints = {0.2, 0.7, 1.0, 1.9}; break;
    case ReferenceKind::cruise: {
      const double t2 = 0.2 + 0.1 / 0.0597;
      joints = {0.2, 0.356, t2, t2 + 0.156};
      break;
    }
    case ReferenceKind::minimum_jerk: joints = {0.3, 1.1}; break;
    case ReferenceKind::sum: joints = {0.0, 0.3, 0.5, 1.1}; break;
    case ReferenceKind::file: joints = load_samples("").first; break;
    case ReferenceKind::live: break;  // what it plays is a sum of cruises
  }
  for (const double joint : joints)
    if (std::fabs(t - joint) < h) return true;
  return false;
}
}  // namespace

TEST_CASE("smoothstep coefficients are the printed integers") {
  using C = std::array<double, 12>;
  REQUIRE(smoothstep_coefficients(3) == C{0, 0, 3, -2});
  REQUIRE(smoothstep_coefficients(5) == C{0, 0, 0, 10, -15, 6});
  REQUIRE(smoothstep_coefficients(9) == C{0, 0, 0, 0, 0, 126, -420, 540, -315, 70});
  REQUIRE(smoothstep_coefficients(11) == C{0, 0, 0, 0, 0, 0, 462, -1980, 3465, -3080, 1386, -252});
}

TEST_CASE("moves and the ramped sine give known values") {
  const ReferencePoint five = Reference(move(0.0, 0.1, 0.5, 5)).at(0.2);
  const std::array<double, 6> five_expected{0.031744, 0.3456, 1.152, -21.12, -115.2, 2304.0};
  const ReferencePoint eleven = Reference(move(0.0, 0.1, 0.5, 11)).at(0.4);
  const std::array<double, 6> eleven_expected{0.09883457945602, 0.05813305343977, -2.179989504003,
                                              50.86642176001,   -163.4992128004,  -28067.36486401};
  const ReferencePoint sine = Reference(sine_spec(0.08, 1.0)).at(0.7);
  const std::array<double, 6> sine_expected{-0.06367665756942, -0.2306576705271, 2.486319441868,
                                            20.58927203839,    -158.8871194133,  -1931.276182432};
  for (std::size_t i = 0; i < 6; ++i) {
    CAPTURE(i);
    CHECK(five.d[i] == Approx(five_expected[i]).epsilon(1e-10));
    CHECK(eleven.d[i] == Approx(eleven_expected[i]).epsilon(1e-10));
    CHECK(sine.d[i] == Approx(sine_expected[i]).epsilon(1e-10));
  }
}

TEST_CASE("every derivative is the slope of the one below, for every kind") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> time(-0.1, 2.6);
  constexpr double h = 1e-4;
  for (const NamedReference& named : all_references()) {
    const Reference r(named.spec, load_samples);
    std::array<double, 8> scale{};
    for (double t = 0.0; t < 2.5; t += 0.003)
      for (std::size_t i = 0; i < 8; ++i) scale[i] = std::max(scale[i], std::fabs(r.at(t).d[i]));
    for (int sample = 0; sample < 300; ++sample) {
      const double t = time(random);
      if (near_joint(named, t, 3.0 * h)) continue;
      // Five-point difference: error h^4/30 d[i+5], and rounding.
      const auto low2 = r.at(t - 2.0 * h).d, low = r.at(t - h).d, high = r.at(t + h).d, high2 = r.at(t + 2.0 * h).d;
      const auto here = r.at(t).d;
      for (std::size_t i = 0; i + 1 < 8; ++i) {
        const double slope = (low2[i] - 8.0 * low[i] + 8.0 * high[i] - high2[i]) / (12.0 * h);
        CAPTURE(named.name, t, i);
        REQUIRE(std::fabs(here[i + 1] - slope) <= 1e-4 * scale[i + 1] + 1e-11 * scale[i] / h);
      }
    }
  }
}

TEST_CASE("joints are as smooth as the degree promises, and no smoother at the ends of a move") {
  for (const NamedReference& named : all_references()) {
    const Reference r(named.spec, load_samples);
    std::array<double, 8> scale{}, worst{};
    for (double t = 0.0; t < 2.5; t += 0.003)
      for (std::size_t i = 0; i < 8; ++i) scale[i] = std::max(scale[i], std::fabs(r.at(t).d[i]));
    constexpr double h = 1e-9;
    std::vector<double> joints{
        0.1, 0.2, 0.25, 0.25 + 1.0 / 1.3, 0.356, 0.5, 0.7, 1.0, 1.1, 1.9, 0.2 + 0.1 / 0.0597, 0.356 + 0.1 / 0.0597};
    if (named.spec.kind == ReferenceKind::file) {
      const auto samples = load_samples("").first;
      joints.assign(samples.begin() + 1, samples.end() - 1);
    } else {
      joints.push_back(0.3);
    }
    for (const double joint : joints)
      for (std::size_t i = 0; i < 8; ++i)
        worst[i] = std::max(worst[i], std::fabs(r.at(joint + h).d[i] - r.at(joint - h).d[i]));
    for (int i = 0; i <= named.continuous; ++i) {
      const auto n = static_cast<std::size_t>(i);
      const double drift = n + 1 < 8 ? 4.0 * h * scale[n + 1] : 0.0;
      CAPTURE(named.name, i);
      CHECK(worst[n] <= 1e-9 * scale[n] + drift);
    }
    if (named.spec.kind != ReferenceKind::sum && named.continuous < 7) {
      CAPTURE(named.name);
      CHECK(worst[static_cast<std::size_t>(named.continuous) + 1] >
            1e-6 * scale[static_cast<std::size_t>(named.continuous) + 1]);
    }
  }
}

TEST_CASE("a reference rests exactly before its start and after its end") {
  for (const NamedReference& named : all_references()) {
    const Reference r(named.spec, load_samples);
    CAPTURE(named.name);
    const ReferencePoint before = r.at(-1.0), earlier = r.at(-100.0);
    REQUIRE(before.d == earlier.d);
    for (std::size_t i = 1; i < 8; ++i) REQUIRE(before.d[i] == 0.0);
    if (!r.is_move()) continue;
    const ReferencePoint after = r.at(r.end_s() + 1e-12), later = r.at(1e6);
    REQUIRE(after.d == later.d);
    for (std::size_t i = 1; i < 8; ++i) REQUIRE(after.d[i] == 0.0);
  }
  const Reference r(move(-0.03, 0.07, 0.5, 9));
  REQUIRE(r.at(-1.0).d[0] == -0.03);
  REQUIRE(r.at(0.5).d[0] == 0.07);
  REQUIRE(Reference().at(3.0).d == ReferencePoint{}.d);
}

TEST_CASE("the trial motion of a live reference reaches its limits and stays within") {
  ReferenceSpec live;
  live.kind = ReferenceKind::live;
  live.lowest_m = -0.1;
  live.highest_m = 0.12;
  live.speed_mps = 0.4;
  live.acceleration_mps2 = 3.0;
  live.smoothness = 11;
  const Reference r(live);
  REQUIRE(r.is_move());
  const ReferenceExtremes x = r.extremes(0, r.end_s()), v = r.extremes(1, r.end_s()), a = r.extremes(2, r.end_s());
  CHECK(x.minimum == Approx(-0.1).margin(1e-12));
  CHECK(x.maximum == Approx(0.12).margin(1e-12));
  CHECK(v.maximum == Approx(0.4));
  CHECK(v.minimum == Approx(-0.4));
  CHECK(a.maximum == Approx(3.0));
  CHECK(a.minimum == Approx(-3.0));
  live.highest_m = -0.05;
  CHECK_THROWS_WITH(Reference(live), Catch::Contains("speed_mps 0.4 is not reached"));
  live.highest_m = 0.12;
  live.acceleration_mps2 = 0.0;
  CHECK_THROWS_AS(Reference(live), std::invalid_argument);
}

TEST_CASE("start, end and kind of motion") {
  ReferenceSpec way = move(0.0, 0.0, 1.0, 5);
  REQUIRE(Reference(way).end_s() == 0.0);
  way.times_s = {0.5, 1.0, 2.0, 3.0};
  way.positions_m = {0.0, 0.0, 0.1, 0.1};
  REQUIRE(Reference(way).start_s() == 1.0);
  REQUIRE(Reference(way).end_s() == 2.0);
  REQUIRE(Reference(way).is_move());
  REQUIRE_FALSE(Reference(sine_spec(0.08, 1.0)).is_move());
  ReferenceSpec sum;
  sum.kind = ReferenceKind::sum;
  sum.parts = {way, sine_spec(0.01, 1.0)};
  REQUIRE_FALSE(Reference(sum).is_move());
  REQUIRE(Reference(sum).start_s() == 0.0);
}

TEST_CASE("the cruise of the servo table reaches its speed and lasts |end - start|/speed + ramp") {
  ReferenceSpec s;
  s.kind = ReferenceKind::cruise;
  s.speed_mps = 0.0597;
  s.ramp_s = 0.156;
  s.start_s = 0.2;
  s.smoothness = 9;
  s.start_m = -0.05;
  s.end_m = 0.05;
  const Reference forward(s);
  REQUIRE(forward.end_s() == Approx(0.2 + 0.1 / 0.0597 + 0.156).epsilon(1e-14));
  REQUIRE(forward.at(1.0).d[1] == Approx(0.0597).epsilon(1e-14));
  REQUIRE(forward.at(0.2 + 0.078).d[1] == Approx(0.5 * 0.0597).epsilon(1e-13));
  REQUIRE(forward.extremes(1, 3.0).maximum == Approx(0.0597).epsilon(1e-13));
  std::swap(s.start_m, s.end_m);
  const Reference backward(s);
  for (const double t : {0.1, 0.25, 0.31, 1.0, 1.9, 1.95, 2.0, 3.0})
    for (std::size_t i = 0; i < 8; ++i) REQUIRE(forward.at(t).d[i] == -backward.at(t).d[i]);
}

TEST_CASE("a sampled polynomial of degree 6 comes back exactly, with its derivatives") {
  const auto polynomial = [](double t) { return 0.02 * t * t * t * t * t * t - 0.05 * t * t * t + 0.3 * t - 0.1; };
  ReferenceSpec s;
  s.kind = ReferenceKind::file;
  s.path = "polynomial";
  const Reference r(s, [&](const std::string&) {
    std::pair<std::vector<double>, std::vector<double>> samples;
    for (int i = 0; i <= 40; ++i) {
      const double t = 0.05 * i + (i % 2) * 0.01;
      samples.first.push_back(t);
      samples.second.push_back(polynomial(t));
    }
    return samples;
  });
  for (const double t : {0.003, 0.3, 0.777, 1.234, 1.93}) {
    CHECK(r.at(t).d[0] == Approx(polynomial(t)).epsilon(1e-12));
    CHECK(r.at(t).d[1] == Approx(0.12 * std::pow(t, 5) - 0.15 * t * t + 0.3).epsilon(1e-9));
    CHECK(r.at(t).d[2] == Approx(0.6 * std::pow(t, 4) - 0.3 * t).margin(1e-8));
    CHECK(r.at(t).d[3] == Approx(2.4 * t * t * t - 0.3).margin(1e-6));
  }
}

TEST_CASE("extremes find the turning points") {
  ReferenceSpec s = sine_spec(0.08, 1.0);
  s.center_m = 0.01;
  const ReferenceExtremes range = reference_range_m(s, 5.0);
  REQUIRE(range.maximum == Approx(0.09).epsilon(1e-13));
  REQUIRE(range.minimum == Approx(-0.07).epsilon(1e-13));
  REQUIRE(reference_peak_speed_mps(s, 5.0) == Approx(0.16 * M_PI).epsilon(1e-13));
  REQUIRE(reference_range_m(move(-0.02, 0.1, 0.5, 7), 0.25).maximum == Approx(0.04).epsilon(1e-13));
  REQUIRE(reference_peak_speed_mps(move(0.0, 0.1, 0.5, 7), 5.0) == Approx(0.4375).epsilon(1e-13));
}

TEST_CASE("a run of days asks for no more than its motion until it repeats") {
  ReferenceSpec sum;
  sum.kind = ReferenceKind::sum;
  sum.parts = {sine_spec(0.05, 5.0), sine_spec(0.03, 7.0), sine_spec(0.02, 7.5)};
  const Reference r(sum);
  for (const int order : {0, 1, 2}) {
    const ReferenceExtremes day = r.extremes(order, 1e6), seconds = r.extremes(order, 10.0);
    CHECK(day.maximum == Approx(seconds.maximum).epsilon(1e-12));
    CHECK(day.minimum == Approx(seconds.minimum).epsilon(1e-12));
  }
  const Reference stops_hard(move(0.0, 0.1, 0.5, 3));
  CHECK(stops_hard.extremes(2, 1e6).minimum == Approx(-2.4).epsilon(1e-12));
  CHECK(stops_hard.extremes(2, 1e6).maximum == Approx(2.4).epsilon(1e-12));
  sum.parts.pop_back();
  const double two_m = Reference(sum).extremes(0, 1e6).maximum;
  sum.parts.push_back(sine_spec(0.02, M_PI));  // no common period: in time its peak meets that of the others
  CHECK(Reference(sum).extremes(0, 1000.0).maximum == Approx(two_m + 0.02).epsilon(1e-3));
}

TEST_CASE("unusable references say which key and what is expected") {
  const auto message = [](const ReferenceSpec& s) -> std::string {
    try {
      Reference{s};
    } catch (const std::invalid_argument& e) { return e.what(); }
    return "accepted";
  };
  ReferenceSpec s = sine_spec(0.08, 0.0);
  CHECK(message(s).find("frequency_Hz is 0") != std::string::npos);
  s = sine_spec(0.08, 1.0, 4);
  CHECK(message(s).find("smoothness is 4") != std::string::npos);
  s = move(0.0, 0.1, 1.0, 5);
  s.times_s = {1.0, 1.0};
  CHECK(message(s).find("increasing times") != std::string::npos);
  s.times_s = {1.0};
  CHECK(message(s).find("1 times and 2 positions") != std::string::npos);
  s = ReferenceSpec{};
  s.kind = ReferenceKind::cruise;
  s.end_m = 0.005;
  s.speed_mps = 0.06;
  s.ramp_s = 0.156;
  CHECK(message(s).find("never reached") != std::string::npos);
  s.kind = ReferenceKind::file;
  s.path = "move.csv.gz";
  CHECK(message(s).find("move.csv.gz") != std::string::npos);
  s.kind = ReferenceKind::sum;
  CHECK(message(s).find("parts is empty") != std::string::npos);
  s.kind = ReferenceKind::multisine;
  CHECK(message(s).find("components is empty") != std::string::npos);
  s = sine_spec(std::nan(""), 1.0);
  CHECK(message(s).find("amplitude_m is nan") != std::string::npos);
}
