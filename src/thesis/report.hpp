// What the verb thesis says: text, JSON, and the page's tables.
#pragma once
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/table.hpp"
#include "thesis/row.hpp"

namespace pneuservo {

/// How many rows have each verdict, in the order of ThesisVerdict.
std::vector<std::size_t> thesis_counts(const std::vector<ThesisResult>& results);
/// "231 rows: 120 agrees, ...".
std::string thesis_summary(const std::vector<ThesisResult>& results);
/// Which command computes what is left out; empty: nothing is.
std::string thesis_left_out(const std::vector<ThesisResult>& results);
Table thesis_table(const ThesisResult& result);
/// "[1] reason", each reason once; the last column of the table has its number.
std::vector<std::string> thesis_reasons(const ThesisResult& result);

/// Groups as tables, reasons below each, the summary last.
std::string thesis_text(const std::vector<ThesisResult>& results);
nlohmann::ordered_json thesis_json(const std::vector<ThesisResult>& results);

}  // namespace pneuservo
