// The sentence of a verdict.
#include <catch2/catch.hpp>

#include "diagnosis/result_text.hpp"

using namespace pneuservo;

TEST_CASE("of two names each has its own probability in the sentence") {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::missing_physics;
  DiagnosisAnswer sure, open;
  sure.effect = "valve_dead_band";
  sure.element = "valve";
  sure.probability = 0.97;
  sure.parameters = {{"width_V", 0.06, 1e-4}};
  diagnosis.answers = {sure};
  CHECK(verdict_sentence(diagnosis) ==
        "The model lacks valve_dead_band at the valve (width_V = 0.06 +- 0.0001), probability 0.97.");
  open.effect = "line_branch_2";
  open.element = "line_2";
  open.probability = 0.48;
  open.parameters = {{"volume_m3", 2e-6, 1e-7}};
  diagnosis.answers.push_back(open);
  CHECK(verdict_sentence(diagnosis) ==
        "The model lacks valve_dead_band at the valve (width_V = 0.06 +- 0.0001), probability 0.97, and "
        "line_branch_2 at line 2 (volume_m3 = 2e-06 +- 1e-07), probability 0.48.");
}

TEST_CASE("where recordings agree at the end of a tolerance alone, that is said of the numbers that stand there") {
  Diagnosis diagnosis;
  diagnosis.admitted_s = 12;
  diagnosis.moved = {{"slider.mass_kg", 2.0, 2.3, 3.0, true}, {"line_1.length_m", 10.0, 10.1, 2.9, false}};
  CHECK(verdict_sentence(diagnosis) ==
        "Model and recordings agree: in 12 s nothing is missing that these data could show, but only at the end of a "
        "tolerance: slider.mass_kg = 2.3 instead of 2.");
}
