// Texts that every page carries in itself; src/report/assets.cmake writes their definitions.
#pragma once
#include <string_view>

namespace pneuservo::assets {

extern const std::string_view dygraphs_script, dygraphs_style, page_script, page_style;

}  // namespace pneuservo::assets
