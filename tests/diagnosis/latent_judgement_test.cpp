// What free functions say of a verdict, on hand-made evidences.
#include <catch2/catch.hpp>

#include "diagnosis/latent/latent_judgement.hpp"
#include "diagnosis/latent/latent_picture.hpp"

using namespace pneuservo;

namespace {

RankedLatent ranked(const std::string& element, double gain) {
  RankedLatent out;
  out.input.element = element;
  out.gain = gain;
  return out;
}

LatentJudgement judgement(double names_ahead, double names_bring) {
  LatentJudgement out;
  out.owner.inputs = {ranked("motion", 300)};
  out.named.emplace();
  out.names_ahead = names_ahead;
  out.names_bring = names_bring;
  return out;
}

/// A force against the motion that is 12 N below 20 mm/s and 2 N above.
UnknownPicture friction_picture() {
  UnknownPicture out{"motion", "force on the slider with the motion", "N", 0, 6, {}, ""};
  for (int i = 0; i < 200; ++i) {
    const double speed = 0.5e-3 * (i + 1), v = i % 2 == 0 ? speed : -speed, against_N = speed < 0.02 ? 12 : 2;
    out.points.push_back(
        {0, 0.01 * i, 0.001 * (i % 7), v, 0.1 * (i % 5), 4e5, 4e5, v > 0 ? -against_N : against_N, 0.5});
  }
  return out;
}

}  // namespace

TEST_CASE("latent judgement: a name goes where a function is clearly better and it adds nothing to one") {
  const DecisionRules rules;
  const auto is_refuted = [&](double ahead, double bring) { return judgement(ahead, bring).refutes_names(1, rules); };
  CHECK(is_refuted(-189, -3));       // a spring that stands for a payload which changes
  CHECK_FALSE(is_refuted(15, 15));   // a leak: a steady law is hardly ahead of its function
  CHECK_FALSE(is_refuted(-66, 400)); // a right name beside a background
  CHECK_FALSE(is_refuted(-10, -10)); // no clear difference
  CHECK_FALSE(LatentJudgement{}.refutes_names(1, rules));
}

TEST_CASE("latent judgement: two names are more causes than a function, and have to bring what a second name has to") {
  const DecisionRules rules;
  const auto is_refuted = [&](double ahead, double bring) { return judgement(ahead, bring).refutes_names(2, rules); };
  CHECK(is_refuted(6, 6));           // two leaks and an offset for one leak that is not tried
  CHECK(is_refuted(-35, 37));
  CHECK_FALSE(is_refuted(900, 900)); // at two elements no single function stands for both
  CHECK_FALSE(is_refuted(-50, 400)); // beside a background
}

TEST_CASE("latent judgement: an element is as likely as the best of its functions") {
  LatentRanking ranking;
  ranking.inputs = {ranked("valve", 100), ranked("valve", 99), ranked("line_1", 97)};
  const std::vector<ElementShare> shares = element_probabilities(ranking, 3);
  REQUIRE(shares.size() == 2);
  CHECK(shares[0].element == "valve");
  CHECK(shares[0].share / shares[1].share == Approx(std::exp(1.0)));
}

TEST_CASE("latent picture: a friction that falls with speed is told as one, in newtons against the motion") {
  const std::string words = picture_words(friction_picture());
  CHECK(words.find("against the motion") != std::string::npos);
  CHECK(words.find("speed tells") != std::string::npos);
  CHECK(words.find("+12 N") != std::string::npos);
  CHECK(words.find("+2 N") != std::string::npos);
}

TEST_CASE("latent picture: sizes in the units that a reader has at hand") {
  CHECK(size_text(1500, "Pa") == "1.5 kPa");
  CHECK(size_text(0.002, "V") == "2 mV");
  CHECK(size_text(1.293e-3 / 60, "kg/s") == "2.2e-05 kg/s, 1 normal l/min");
}
