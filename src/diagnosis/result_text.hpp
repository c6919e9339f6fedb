// A diagnosis in words: one sentence, and the page of text that the program prints.
#pragma once
#include <string>

#include "diagnosis/diagnosis.hpp"

namespace pneuservo {

/// E.g. "A leak of chamber 1 (chamber_leak_1) of area_m2 = 2.0e-08 +- 1e-10 is missing, probability 0.97."
std::string verdict_sentence(const Diagnosis& diagnosis);
std::string diagnosis_text(const Diagnosis& diagnosis);
/// The names of an explanation in one line; "nothing" where it has none.
std::string explanation_text(const RankedExplanation& explanation);

}  // namespace pneuservo
