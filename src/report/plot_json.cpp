// The data of one plot as JSON: thinned with its peaks kept, times as steps of the sampling period.
#include <report/plot_json.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace pneuservo {
namespace {

/// A JSON string; nlohmann replaces what is not UTF-8, and '<' would end a script element.
std::string quoted(const std::string& text) {
  std::string json = nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (std::size_t at = json.find('<'); at != std::string::npos; at = json.find('<', at))
    json.replace(at, 1, "\\u003c");
  return json;
}

std::string number_text(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "null"; }

std::vector<double> chosen(const std::vector<double>& values, const std::vector<std::size_t>& indices) {
  std::vector<double> out;
  out.reserve(indices.size());
  for (std::size_t i : indices) out.push_back(values[i]);
  return out;
}

std::string array(const std::vector<double>& values) {
  std::string json = "[";
  for (std::size_t i = 0; i < values.size(); ++i) json.append(i > 0 ? "," : "").append(number_text(values[i]));
  return json + "]";
}

/// {"from", "step", "by": [whole steps]} where all x are multiples of `step`, else the plain numbers.
std::string abscissa(const std::vector<double>& x, double step) {
  const auto is_multiple = [&](double value) { return std::fabs(value / step - std::round(value / step)) < 1e-4; };
  if (!(step > 0.0) || x.empty() || !std::all_of(x.begin(), x.end(), is_multiple)) {
    std::string json = "[";
    for (std::size_t i = 0; i < x.size(); ++i) json += fmt::format("{}{:.9g}", i > 0 ? "," : "", x[i]);
    return json + "]";
  }
  std::string json = fmt::format("{{\"from\":{},\"step\":{:.12g},\"by\":[", std::llround(x.front() / step), step);
  for (std::size_t i = 0; i < x.size(); ++i)
    json +=
        fmt::format("{}{}", i > 0 ? "," : "", i > 0 ? std::llround(x[i] / step) - std::llround(x[i - 1] / step) : 0);
  return json + "]}";
}

std::string curve_json(const Curve& curve, const Plot& plot) {
  const auto indices = keep_peaks(curve.y, plot.points_max);
  return fmt::format("{{\"name\":{},\"tone\":{},\"dashed\":{},\"steps\":{},\"x\":{},\"y\":{}}}", quoted(curve.name),
                     static_cast<int>(curve.tone), curve.dashed, curve.steps,
                     abscissa(chosen(curve.x, indices), plot.x_step), array(chosen(curve.y, indices)));
}

/// A band keeps the outermost of every stretch of equal length.
std::string band_json(const Band& band, const Plot& plot) {
  const std::size_t n = band.x.size(),
                    stretch = std::max<std::size_t>(1, 4 * n / std::max<std::size_t>(1, plot.points_max));
  std::vector<double> x, low, high;
  for (std::size_t i = 0; i < n; i += stretch) {
    const std::size_t end = std::min(n, i + stretch);
    double least = band.low[i], greatest = band.high[i];
    for (std::size_t k = i + 1; k < end; ++k) {
      least = std::fmin(least, band.low[k]);
      greatest = std::fmax(greatest, band.high[k]);
    }
    x.push_back(i + stretch < n ? band.x[i] : band.x[end - 1]);
    low.push_back(least);
    high.push_back(greatest);
  }
  return fmt::format("{{\"name\":{},\"tone\":{},\"x\":{},\"low\":{},\"high\":{}}}", quoted(band.name),
                     static_cast<int>(band.tone), abscissa(x, plot.x_step), array(low), array(high));
}

template <class Items, class Function> std::string list(const Items& items, Function&& function) {
  std::string json = "[";
  for (const auto& item : items) json.append(json.size() > 1 ? "," : "").append(function(item));
  return json + "]";
}

}  // namespace

std::vector<std::size_t> keep_peaks(const std::vector<double>& y, std::size_t points_max) {
  const std::size_t n = y.size();
  std::vector<std::size_t> indices;
  if (n <= points_max || points_max < 8) {
    for (std::size_t i = 0; i < n; ++i) indices.push_back(i);
    return indices;
  }
  const std::size_t stretches = (points_max - 2) / 3;
  indices.push_back(0);
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t begin = 1 + s * (n - 2) / stretches, end = 1 + (s + 1) * (n - 2) / stretches;
    std::size_t least = n, greatest = n, gap = n;
    for (std::size_t i = begin; i < end; ++i) {
      if (!std::isfinite(y[i])) {
        gap = i;
        continue;
      }
      if (least == n || y[i] < y[least]) least = i;
      if (greatest == n || y[i] > y[greatest]) greatest = i;
    }
    std::size_t kept[] = {least, greatest, gap};
    std::sort(std::begin(kept), std::end(kept));
    for (std::size_t i : kept)
      if (i < n && i != indices.back()) indices.push_back(i);
  }
  indices.push_back(n - 1);
  return indices;
}

std::string plot_json(const Plot& plot, const std::string& id) {
  return fmt::format(
      "{{\"id\":{},\"group\":{},\"logX\":{},\"logY\":{},\"curves\":{},\"bands\":{},\"marks\":{},\"windows\":{}}}",
      quoted(id), quoted(plot.group), plot.log_x, plot.log_y,
      list(plot.curves, [&](const Curve& curve) { return curve_json(curve, plot); }),
      list(plot.bands, [&](const Band& band) { return band_json(band, plot); }),
      list(plot.marks,
           [](const Mark& mark) { return fmt::format("{{\"x\":{:.9g},\"text\":{}}}", mark.x, quoted(mark.text)); }),
      list(plot.windows, [](const auto& w) { return fmt::format("[{:.9g},{:.9g}]", w.first, w.second); }));
}

}  // namespace pneuservo
