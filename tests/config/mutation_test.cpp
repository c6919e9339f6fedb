// Random damage to a config: it reads or is refused in one sentence with its line, and never anything else.
#include <catch2/catch.hpp>

#include <cstdlib>
#include <random>
#include <sstream>

#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "config/same_rig.hpp"
#include "config/test_rigs.hpp"
#include "core/test_seed.hpp"

using namespace pneuservo;

namespace {

std::string damaged(std::string text, std::mt19937& random) {
  const std::string alphabet = "{}[]:,#&*!|>'\"%@`-?~ \n\t.0123456789eE+abcxyz_/\\\x01\xff";
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  for (std::size_t change = 0, changes = 1 + below(3); change < changes && !text.empty(); ++change) {
    const std::size_t place = below(text.size());
    switch (below(8)) {
      case 5:
      case 6:
      case 7:  // another digit, which most configs survive
        if (const std::size_t digit = text.find_first_of("0123456789", place); digit != std::string::npos)
          text[digit] = static_cast<char>('0' + below(10));
        break;
      case 0: text[place] = alphabet[below(alphabet.size())]; break;
      case 1: text.insert(place, 1, alphabet[below(alphabet.size())]); break;
      case 2: text.erase(place, 1 + below(10)); break;
      case 3: text.insert(below(text.size()), text.substr(place, 1 + below(40))); break;
      default: text.resize(place + 1); break;
    }
  }
  return text;
}

}  // namespace

// Under sanitizers tools/fuzz does the same, guided by coverage.
TEST_CASE("a damaged config reads or is refused with its line", "[optimised]") {
  const unsigned seed = test::stated_seed().value_or(20261121u);
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 random(seed);
  const std::string text = std::string(test::plain_rig) +
                           "effects:\n  coulomb_friction: {force_N: 3}\n  sensor_gain:x: {gain: 1.1}\n"
                           "tolerances: {slider.mass_kg: 0.02}\nevaluation: {from_s: 1, to_s: 2}\n";
  int read = 0, refused = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string wrong = damaged(text, random);
    INFO(wrong);
    try {
      const Rig rig = parse_rig(wrong, "rig.yaml");
      ++read;
      REQUIRE(same_rig(rig, parse_rig(dump_rig(rig), "dump")));
    } catch (const InputError& error) {
      ++refused;
      INFO(error.what());
      std::istringstream sentences(error.what());
      for (std::string sentence; std::getline(sentences, sentence);) {
        REQUIRE(sentence.starts_with("rig.yaml:"));
        REQUIRE(sentence.find(": found ") != std::string::npos);
        REQUIRE(sentence.find(", expected ") != std::string::npos);
      }
    }
  }
  REQUIRE(read > 100);
  REQUIRE(refused > 1000);
}
