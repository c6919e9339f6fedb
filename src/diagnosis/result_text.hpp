// A diagnosis in words: one sentence, and the page of text that the program prints.
#pragma once
#include <string>
#include <string_view>

#include "diagnosis/diagnosis.hpp"

namespace pneuservo {

/// How many machines got the same answer, and what was said of the others.
std::string self_test_text(const SelfTest& test);
/// E.g. "A leak of chamber 1 (chamber_leak_1) of area_m2 = 2.0e-08 +- 1e-10 is missing, probability 0.97."
std::string verdict_sentence(const Diagnosis& diagnosis);
std::string diagnosis_text(const Diagnosis& diagnosis);
/// What a table stands beside: the config, or names.
std::string beside_words(const UnknownCurve& curve);
/// "chamber 1", "sensor of p1_port", "slider, guide and load": every place that names an element says it so.
std::string element_words(std::string_view element);
/// Four significant digits, as the text and the page write every value of a diagnosis; a dash where there is none.
std::string value_text(double value);
/// The names of an explanation in one line; "nothing" where it has none.
std::string explanation_text(const RankedExplanation& explanation);

}  // namespace pneuservo
