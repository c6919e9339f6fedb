// Whether a channel goes on across some rows as it does elsewhere.
#include "record/foreign/channel_steps.hpp"

#include <algorithm>
#include <cmath>

#include "record/column_values.hpp"

namespace pneuservo {

bool jumps_into(const std::vector<std::size_t>& rows, const std::vector<double>& values,
                const std::vector<double>& calm) {
  constexpr double usual_share = 0.99, much_larger = 2;
  std::vector<double> at_rows, elsewhere;
  auto next = rows.begin();  // they rise
  for (std::size_t i = 1; i < values.size(); ++i) {
    const bool is_at_row = next != rows.end() && *next == i;
    if (is_at_row) ++next;
    const double step = is_at_row ? std::abs(values[i] - values[i - 1]) : std::abs(calm[i] - calm[i - 1]);
    if (std::isfinite(step)) (is_at_row ? at_rows : elsewhere).push_back(step);
  }
  if (at_rows.empty() || elsewhere.empty()) return false;
  return median_of(std::move(at_rows)) > much_larger * quantile(std::move(elsewhere), usual_share);
}

}  // namespace pneuservo
