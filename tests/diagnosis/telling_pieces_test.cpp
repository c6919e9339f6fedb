// Pieces of long recordings: as much as is bounded, those that tell most, and what is said of it.
#include "diagnosis/recordings/telling_pieces.hpp"

#include <cmath>

#include <catch2/catch.hpp>

#include <pneuservo/core/random.hpp>

#include "core/test_seed.hpp"

#include "diagnosis/simulated_recording.hpp"

namespace pneuservo {
namespace {

using Catch::Matchers::Contains;

/// Rows every 10 ms with x and u as functions of time.
template <class X, class U> Recording recording_of(double seconds, const X& x, const U& u) {
  Recording r;
  r.path = "long";
  r.period_s = 0.01;
  r.names = {"t_s", "x_m", "u_V"};
  r.values.resize(3);
  for (int i = 0; 0.01 * i < seconds; ++i) {
    const double t = 0.01 * i;
    r.values[0].push_back(t);
    r.values[1].push_back(x(t));
    r.values[2].push_back(u(t));
    r.line_numbers.push_back(static_cast<std::size_t>(i));
  }
  return r;
}

double length_of(const Recording& r) { return r.t_s().back() - r.t_s().front(); }

TEST_CASE("of an hour half a minute is compared, with the motion that is hidden in it") {
  const auto motion = [](double t) { return t > 1000 && t < 1050 ? 1.0 : 0.01; };
  const Recording hour = recording_of(
      3600, [&](double t) { return 0.05 * motion(t) * std::sin(6 * t); },
      [&](double t) { return motion(t) * std::cos(6 * t); });
  const TellingPieces chosen = telling_pieces(test::cylinder_rig(), {hour});
  double seconds = 0, moving_s = 0;
  for (const Recording& piece : chosen.recordings) {
    seconds += length_of(piece);
    if (piece.t_s().front() > 993 && piece.t_s().back() < 1057) moving_s += length_of(piece);
  }
  CHECK(seconds <= 30.1);
  CHECK(moving_s > 17.5);
  CHECK(chosen.coverage.recorded_s == Approx(3600).margin(0.02));
  REQUIRE(chosen.coverage.spans.size() == chosen.recordings.size());
  for (std::size_t i = 0; i < chosen.recordings.size(); ++i) {
    CHECK(chosen.coverage.spans[i].recording == "long");
    CHECK(chosen.coverage.spans[i].from_s == chosen.recordings[i].t_s().front());
    CHECK(chosen.coverage.spans[i].to_s == chosen.recordings[i].t_s().back());
    if (i > 0) CHECK(chosen.coverage.spans[i].from_s > chosen.coverage.spans[i - 1].to_s);
  }
  CHECK_THAT(chosen.coverage.choice, Contains("6 s") && Contains("D-optimal"));
}

TEST_CASE("pieces that move most alone do not crowd out another place and the other direction of the valve") {
  // Fast about the middle nearly always; once slowly at an end of the stroke, with the valve one way.
  const auto seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  const double aside_s = Random(seed).uniform(20, 560);
  const auto is_aside = [&](double t) { return t > aside_s && t < aside_s + 12; };
  const Recording r = recording_of(
      600, [&](double t) { return is_aside(t) ? 0.12 + 0.01 * std::sin(t) : 0.02 * std::sin(6 * t); },
      [&](double t) { return is_aside(t) ? 1.5 : 0.5 * std::cos(6 * t); });
  const TellingPieces chosen = telling_pieces(test::cylinder_rig(), {r});
  bool has_aside = false;
  for (const ComparedSpan& span : chosen.coverage.spans)
    has_aside = has_aside || (span.from_s < aside_s + 9 && span.to_s > aside_s + 3);
  CHECK(has_aside);
}

TEST_CASE("short recordings stay whole, held-out ones are bounded for themselves") {
  const auto x = [](double t) { return 0.05 * std::sin(6 * t); };
  const auto u = [](double t) { return std::cos(6 * t); };
  const Rig rig = test::cylinder_rig();
  const TellingPieces whole = telling_pieces(rig, {recording_of(9, x, u), recording_of(18, x, u)});
  REQUIRE(whole.recordings.size() == 2);
  CHECK(whole.coverage.choice.empty());
  CHECK(length_of(whole.recordings[1]) == Approx(18).margin(0.02));
  Recording proof = recording_of(300, x, u);
  proof.is_held_out = true;
  const TellingPieces both = telling_pieces(rig, {recording_of(20, x, u), proof});
  double held_out_s = 0;
  for (const Recording& piece : both.recordings)
    if (piece.is_held_out) held_out_s += length_of(piece);
  CHECK(length_of(both.recordings.front()) == Approx(20).margin(0.02));
  CHECK(held_out_s > 23);
  CHECK(held_out_s <= 30.1);
}

}  // namespace
}  // namespace pneuservo
