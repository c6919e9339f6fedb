// The page of the verb `diagnose`.
#pragma once
#include <string>

#include "diagnosis/diagnosis.hpp"

namespace pneuservo {

std::string diagnosis_report_html(const Diagnosis& diagnosis);

/// Writes the page; throws InputError naming the path if that fails.
void write_diagnosis_report(const Diagnosis& diagnosis, const std::string& path);

}  // namespace pneuservo
