// The self-test of a verdict: machines as the answer has them are played and judged by the owner's config, and no
// probability is told above the share that got the same answer.
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "diagnosis/self_test.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

Diagnosis a_leak(double probability) {
  Diagnosis out;
  out.verdict = Verdict::missing_physics;
  out.configured = out.improved = cylinder_rig();
  out.improved.axis.effects.chamber_leak_1.area_m2 = 2e-8;
  out.improved.axis.slider.mass_kg = 2.1;
  out.answers.push_back({"chamber_leak_1", "chamber_1", probability, {}, {}, 1.0, ""});
  return out;
}

RecordedMotion a_motion() { return {"m.csv", {0, 0.5, 1}, {0.01, 0.02, 0.03}, {"t_s", "x_m"}, {}, false}; }

std::optional<Recording> an_empty_run() {
  Recording out;
  out.names = {"t_s", "x_m", "p1_port_Pa"};
  out.values.resize(3);
  return out;
}

}  // namespace

TEST_CASE("a probability is told no higher than the share of machines that got the same answer") {
  Diagnosis found = a_leak(0.97);
  std::set<std::uint64_t> seeds;
  int asked = 0;
  const auto play = [&](const Rig& rig, const RecordedMotion& motion) {
    seeds.insert(rig.seed);
    CHECK(rig.axis.effects.chamber_leak_1.area_m2 == 0.0);  // its owner does not know
    CHECK(rig.concealed.at("effects.chamber_leak_1.area_m2") == 2e-8);
    CHECK(rig.concealed.at("slider.mass_kg") == 2.1);
    CHECK(rig.reference.kind == ReferenceKind::file);
    CHECK(rig.duration_s == 1.0);
    CHECK(rig.initial.position_m == 0.01);
    CHECK(motion.path == "m.csv");
    return an_empty_run();
  };
  const auto again = [&](const std::vector<Recording>& played) {
    REQUIRE(played.size() == 1);
    CHECK(played.front().names == std::vector<std::string>{"t_s", "x_m"});  // as the real one
    Diagnosis out = a_leak(0.9);
    if (++asked == 2) out.answers.front().effect = "line_leak_1";
    return out;
  };
  add_self_test(cylinder_rig(), {a_motion()}, 4, play, again, found);
  REQUIRE(found.self_test.has_value());
  CHECK(found.self_test->machines == 4);
  CHECK(found.self_test->same == 3);
  CHECK(found.self_test->others.size() == 1);
  CHECK(seeds.size() == 4);
  CHECK(found.answers.front().probability == Approx(0.75));
  CHECK(found.sentence.find("0.75") != std::string::npos);

  Diagnosis doubted = a_leak(0.4);  // never raised
  add_self_test(cylinder_rig(), {a_motion()}, 2, play, [](auto) { return a_leak(0.9); }, doubted);
  CHECK(doubted.answers.front().probability == Approx(0.4));
}

TEST_CASE("where no machine can be played there is no self-test, and that is said") {
  const auto again = [](auto) -> Diagnosis { throw std::logic_error("nothing to diagnose"); };
  Diagnosis faulty = a_leak(0.97);
  add_self_test(cylinder_rig(), {a_motion()}, 3, [](auto&&...) { return std::optional<Recording>(); }, again, faulty);
  CHECK_FALSE(faulty.self_test.has_value());
  CHECK(faulty.answers.front().probability == Approx(0.97));
  REQUIRE(faulty.warnings.size() == 1);
  CHECK(faulty.warnings.front().find("does not follow") != std::string::npos);

  Diagnosis unknown = a_leak(0.8);
  unknown.verdict = Verdict::unknown;
  add_self_test(cylinder_rig(), {a_motion()}, 3, [](auto&&...) { return an_empty_run(); }, again, unknown);
  CHECK_FALSE(unknown.self_test.has_value());
  CHECK(unknown.warnings.size() == 1);
}

TEST_CASE("a motion is the reference where it was recorded, else the position without its noise") {
  Recording recording = simulated_recording(cylinder_rig(), 2.0, 3, {"p1_port_Pa", "p2_port_Pa"});
  std::vector<RecordedMotion> motions = motions_of({recording});
  REQUIRE(motions.size() == 1);
  CHECK(motions.front().time_s.front() == 0.0);
  const std::vector<double>& x = recording.column("x_m");
  double off = 0, rough = 0, smooth = 0;
  for (std::size_t i = 150; i + 150 < x.size(); ++i) {  // at its ends a kernel has one side alone
    const std::vector<double>& m = motions.front().position_m;
    off = std::max(off, std::fabs(m[i] - x[i]));
    rough += std::fabs(x[i + 1] - 2 * x[i] + x[i - 1]);
    smooth += std::fabs(m[i + 1] - 2 * m[i] + m[i - 1]);
  }
  CHECK(off < 5e-4);
  CHECK(smooth < 0.2 * rough);
  recording.names.emplace_back("x_ref_m");
  recording.values.emplace_back(x.size(), 0.025);
  motions = motions_of({recording});
  CHECK(motions.front().position_m == std::vector<double>(x.size(), 0.025));
}
