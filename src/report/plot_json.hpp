// The data of one plot as the page's script reads it.
#pragma once
#include <string>

#include <report/html_page.hpp>

namespace pneuservo {

/// One JSON object, thinned and rounded to six digits, safe inside a script element (no '<').
std::string plot_json(const Plot& plot, const std::string& id);

}  // namespace pneuservo
