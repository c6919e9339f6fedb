// A self-contained HTML page of text, tables, bars and zoomable plots.
#include <report/html_page.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <record/result_file.hpp>
#include <report/assets.hpp>
#include <report/plot_json.hpp>
#include <report/pole_plot.hpp>

namespace pneuservo {

Plot frequency_plot(std::string title, std::string unit) {
  Plot plot;
  plot.title = std::move(title);
  plot.unit = std::move(unit);
  plot.x_title = "frequency";
  plot.x_unit = "Hz";
  plot.group = "frequency";
  plot.log_x = true;
  plot.height_px = 280;
  return plot;
}
namespace {

std::string with_unit(std::string_view title, std::string_view unit) {
  std::string text = fmt::format("<span class=\"name\">{}</span>", html_escape(title));
  if (!unit.empty()) text += fmt::format(" <span class=\"unit\">{}</span>", html_escape(unit));
  return text;
}

std::string bar_html(const BarChart::Bar& bar, double largest) {
  const double share = std::isfinite(bar.value) && largest > 0.0 ? std::fabs(bar.value) / largest : 0.0;
  return fmt::format(
      "<div class=\"bar\"><span class=\"bar-name\">{}</span><span class=\"bar-track\"><span class=\"bar-fill "
      "tone-{}\" style=\"width:{:.1f}%\"></span></span><span class=\"bar-value\">{}</span></div>",
      html_escape(bar.name), tone_name(bar.tone), 100.0 * share, html_escape(figure(bar.value)));
}

}  // namespace

std::string html_escape(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (char c : text) {
    switch (c) {
      case '&': escaped += "&amp;"; break;
      case '<': escaped += "&lt;"; break;
      case '>': escaped += "&gt;"; break;
      case '"': escaped += "&quot;"; break;
      case '\'': escaped += "&#39;"; break;
      default: escaped += c;
    }
  }
  return escaped;
}

HtmlPage::HtmlPage(std::string title, std::string_view eyebrow, std::string_view headline) : title_(std::move(title)) {
  body_ = fmt::format("<header><p class=\"eyebrow\">{}</p><h1>{}</h1></header>\n", html_escape(eyebrow),
                      html_escape(headline));
}

void HtmlPage::section(std::string_view title, std::string_view text) {
  body_ += fmt::format("{}<section><h2>{}</h2>\n", in_section_ ? "</section>\n" : "", html_escape(title));
  in_section_ = true;
  if (!text.empty()) paragraph(text);
}

void HtmlPage::paragraph(std::string_view text) { body_ += fmt::format("<p>{}</p>\n", html_escape(text)); }

void HtmlPage::alert(std::string_view text) {
  body_ += fmt::format("<p class=\"alert\" role=\"alert\">{}</p>\n", html_escape(text));
}

void HtmlPage::table(const Table& table) {
  body_ += "<div class=\"table\"><table>";
  if (!table.title.empty()) body_ += fmt::format("<caption>{}</caption>", html_escape(table.title));
  body_ += "<thead><tr>";
  std::size_t rows = 0;
  for (const TableColumn& column : table.columns) {
    body_ +=
        fmt::format("<th{}>{}</th>", column.is_text ? " class=\"text\"" : "", with_unit(column.title, column.unit));
    rows = std::max(rows, column.cells.size());
  }
  body_ += "</tr></thead><tbody>";
  for (std::size_t row = 0; row < rows; ++row) {
    body_ += static_cast<int>(row) == table.best_row ? "<tr class=\"best\">" : "<tr>";
    for (const TableColumn& column : table.columns)
      body_ += fmt::format("<td{}>{}</td>", column.is_text ? " class=\"text\"" : "",
                           row < column.cells.size() ? html_escape(column.cells[row]) : std::string());
    body_ += "</tr>";
  }
  body_ += "</tbody></table></div>\n";
}

void HtmlPage::bars(const std::vector<BarChart>& charts) {
  body_ += "<div class=\"charts\">";
  for (const BarChart& chart : charts) {
    double largest = 0.0;
    for (const auto& bar : chart.bars)
      if (std::isfinite(bar.value)) largest = std::max(largest, std::fabs(bar.value));
    body_ += fmt::format("<div class=\"chart\"><h3>{}</h3>", with_unit(chart.title, chart.unit));
    for (const auto& bar : chart.bars) body_ += bar_html(bar, largest);
    body_ += "</div>";
  }
  body_ += "</div>\n";
}

void HtmlPage::drawing(std::string_view svg, std::string_view caption) {
  body_ += fmt::format("<figure class=\"drawing\">{}<figcaption>{}</figcaption></figure>\n", svg, html_escape(caption));
}

void HtmlPage::plot(const Plot& plot) {
  const std::string id = fmt::format("plot-{}", ++plots_);
  body_ +=
      fmt::format("<figure class=\"plot\" id=\"{}\"><figcaption><h3>{}</h3><span class=\"legend\"></span></figcaption>"
                  "<div class=\"canvas\" style=\"height:{}px\"></div><p class=\"x-title\">{}</p></figure>\n",
                  id, with_unit(plot.title, plot.unit), plot.height_px, with_unit(plot.x_title, plot.x_unit));
  plot_data_.append(plots_ > 1 ? ",\n" : "").append(plot_json(plot, id));
}

void HtmlPage::plots(const std::vector<Plot>& row) {
  body_ += row.size() > 2 ? "<div class=\"plot-row narrow\">" : "<div class=\"plot-row\">";
  for (const Plot& one : row) plot(one);
  body_ += "</div>\n";
}

void HtmlPage::poles(const std::vector<PolePlot>& row) {
  body_ += "<div class=\"plot-row\">";
  for (const PolePlot& one : row)
    body_ += fmt::format("<figure class=\"drawing\"><figcaption><h3>{}</h3></figcaption>{}</figure>\n",
                         with_unit(one.title, one.unit), pole_svg(one));
  body_ += "</div>\n";
}

void HtmlPage::panels_begin(const std::vector<std::string>& names, std::size_t selected) {
  const int set = ++panel_sets_;
  selected_panel_ = selected;
  body_ +=
      fmt::format("<div class=\"panels\"><div class=\"tabs\" role=\"group\"{}>", names.size() < 2 ? " hidden" : "");
  for (std::size_t i = 0; i < names.size(); ++i)
    body_ += fmt::format("<button type=\"button\" data-panel=\"panel-{}-{}\" aria-pressed=\"{}\">{}</button>", set, i,
                         i == selected ? "true" : "false", html_escape(names[i]));
  body_ += "</div><div class=\"stack\">";
}

void HtmlPage::panel(std::size_t index) {
  body_ += fmt::format("{}<div class=\"panel{}\" id=\"panel-{}-{}\">", in_panel_ ? "</div>" : "",
                       index == selected_panel_ ? " shown" : "", panel_sets_, index);
  in_panel_ = true;
}

void HtmlPage::panels_end() {
  body_ += in_panel_ ? "</div></div></div>\n" : "</div></div>\n";
  in_panel_ = false;
}

void HtmlPage::details(std::string_view title, std::string_view text) {
  body_ +=
      fmt::format("<details><summary>{}</summary><pre>{}</pre></details>\n", html_escape(title), html_escape(text));
}

void HtmlPage::details(std::string_view title, const std::vector<std::pair<std::string, std::string>>& facts) {
  body_ += fmt::format("<details><summary>{}</summary><dl>", html_escape(title));
  for (const auto& [name, value] : facts)
    body_ += fmt::format("<dt>{}</dt><dd>{}</dd>", html_escape(name), html_escape(value));
  body_ += "</dl></details>\n";
}

std::string HtmlPage::html() const {
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
                     "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
                     "<meta name=\"color-scheme\" content=\"light dark\">";
  page += fmt::format("<title>{}</title>\n<style>{}\n{}</style></head>\n<body><main>\n", html_escape(title_),
                      assets::dygraphs_style, assets::page_style);
  page.append(body_).append(in_section_ ? "</section>\n</main>\n" : "</main>\n");
  if (plots_ > 0) {
    page += "<button type=\"button\" id=\"reset-zoom\" hidden>Reset zoom</button>\n";
    page += "<script type=\"application/json\" id=\"plot-data\">[";
    page.append(plot_data_).append("]</script>\n");
    page += "<script>/* dygraphs, Copyright (c) Dan Vanderkam and contributors, MIT licence */\n";
    page.append(assets::dygraphs_script).append("</script>\n");
  }
  page.append("<script>").append(assets::page_script).append("</script>\n</body></html>\n");
  return page;
}

void HtmlPage::write(const std::string& path) const { write_result(path, html()); }

}  // namespace pneuservo
