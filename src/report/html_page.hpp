// A self-contained HTML page of text, tables, bars and zoomable plots; what every report is built from.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <report/table.hpp>

namespace pneuservo {

struct PolePlot;

/// Text with & < > " ' replaced, fit for HTML text and attributes.
std::string html_escape(std::string_view text);

/// Colours by role; one role keeps its colour on the whole page, in light, dark and print.
enum class Tone { neutral, valve, chamber, estimated, fourth, fifth, sixth };
/// Its class in the page's style sheet.
constexpr const char* tone_name(Tone tone) {
  constexpr const char* names[] = {"neutral", "valve", "chamber", "estimated", "fourth", "fifth", "sixth"};
  return names[static_cast<int>(tone)];
}

/// One line of a plot. `x` rises; y may hold NaN: a gap.
struct Curve {
  std::string name;
  Tone tone = Tone::neutral;
  std::vector<double> x, y;
  bool dashed = false;
  bool steps = false;  ///< constant from each x to the next
};

/// An area between two lines.
struct Band {
  std::string name;
  Tone tone = Tone::neutral;
  std::vector<double> x, low, high;
};

/// A vertical line with a word.
struct Mark {
  double x = 0.0;
  std::string text;
};

/// One zoomable plot. Curves and bands are thinned to at most `points_max` points, keeping every peak.
struct Plot {
  std::string title, unit;        ///< of what the vertical axis shows
  std::string x_title = "time", x_unit = "s";
  std::string group = "time";     ///< plots of one group zoom together; empty: alone
  std::vector<Curve> curves;
  std::vector<Band> bands;
  std::vector<Mark> marks;
  std::vector<std::pair<double, double>> windows;  ///< shaded stretches of x, such as what was evaluated
  bool log_x = false, log_y = false;
  double x_step = 0.0;            ///< > 0: x are multiples of it, which makes the page smaller
  int height_px = 230;
  std::size_t points_max = 4000;
};

/// A plot over frequency on a logarithmic axis; all such plots of a page zoom together.
Plot frequency_plot(std::string title, std::string unit);

/// One figure as bars, one a name.
struct BarChart {
  std::string title, unit;
  struct Bar {
    std::string name;
    Tone tone = Tone::neutral;
    double value = 0.0;           ///< NaN: shown as unknown
  };
  std::vector<Bar> bars;
};

/// Indices into `y` of at most `points_max` points that keep the first, the last, and the least and greatest of every
/// stretch; a stretch with a gap keeps one NaN of it.
std::vector<std::size_t> keep_peaks(const std::vector<double>& y, std::size_t points_max);

/// The page grows in the order of the calls. All text is escaped here. Everything a page needs stands in it.
class HtmlPage {
 public:
  /// `title` for the browser's tab, `eyebrow` the small line above the headline.
  HtmlPage(std::string title, std::string_view eyebrow, std::string_view headline);

  void section(std::string_view title, std::string_view text = "");
  void paragraph(std::string_view text);
  /// A message that must not be overlooked, such as a fault.
  void alert(std::string_view text);
  void table(const Table& table);
  void bars(const std::vector<BarChart>& charts);
  /// A drawing that is SVG already (rig_picture), and what is seen on it in words.
  void drawing(std::string_view svg, std::string_view caption);
  void plot(const Plot& plot);
  /// Plots side by side where there is room.
  void plots(const std::vector<Plot>& row);
  /// Drawings of the s plane side by side where there is room (pole_plot.hpp).
  void poles(const std::vector<PolePlot>& row);
  /// Panels of which one is seen, chosen by its name; `selected` is seen first. Call panel() before each one's content.
  void panels_begin(const std::vector<std::string>& names, std::size_t selected);
  void panel(std::size_t index);
  void panels_end();
  /// Folded text as it stands (a config).
  void details(std::string_view title, std::string_view text);
  /// Folded names and values.
  void details(std::string_view title, const std::vector<std::pair<std::string, std::string>>& facts);

  std::string html() const;
  /// Writes the page; throws InputError naming the path if that fails.
  void write(const std::string& path) const;

 private:
  std::string title_, body_, plot_data_;
  int plots_ = 0, panel_sets_ = 0;
  bool in_section_ = false, in_panel_ = false;
  std::size_t selected_panel_ = 0;
};

}  // namespace pneuservo
