// The page of the verb thesis: tables, and pictures where the thesis has pictures.
#include "thesis/pictures.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "report/pole_plot.hpp"
#include "thesis/groups.hpp"
#include "thesis/report.hpp"

namespace pneuservo {

HtmlPage thesis_page(const std::vector<ThesisResult>& results, ThesisBench&) {
  HtmlPage page("The thesis beside ours", "pneuservo thesis", thesis_summary(results));
  for (const ThesisResult& result : results) {
    page.section(result.title);
    page.table(thesis_table(result, true));
  }
  return page;
}

}  // namespace pneuservo
