// What the verb index says: text, JSON, and one self-contained HTML page with a map over length and diameter.
#pragma once
#include <string>

#include <nlohmann/json.hpp>

#include "index/necessity_index.hpp"

namespace pneuservo {

std::string index_text(const std::string& rig_name, const RigNecessity& result);
nlohmann::ordered_json index_json(const std::string& rig_name, const RigNecessity& result);
std::string index_html(const std::string& rig_name, const RigNecessity& result);

/// Tables 4.2 and 4.3: the printed digits beside ours.
std::string index_table_text();
nlohmann::ordered_json index_table_json();
std::string index_table_html();

}  // namespace pneuservo
