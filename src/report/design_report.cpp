// The page of the verb `design`.
#include <report/design_report.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <report/design_summary.hpp>
#include <report/html_page.hpp>
#include <report/pole_plot.hpp>

namespace pneuservo {
namespace {

using Complex = std::complex<double>;
constexpr int bode_points = 700, locus_points = 140;

std::vector<double> log_grid(double low, double high, int points) {
  std::vector<double> out;
  for (int i = 0; i < points; ++i) out.push_back(low * std::pow(high / low, i / (points - 1.0)));
  return out;
}

double decibel(Complex value) { return 20.0 * std::log10(std::abs(value)); }

/// Phase in degrees; a gap where it jumps by a turn.
std::vector<double> phase_of(const std::vector<Complex>& values) {
  std::vector<double> out;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double phase = std::arg(values[i]) * 180.0 / std::numbers::pi;
    const bool jumps = i > 0 && std::fabs(phase - std::arg(values[i - 1]) * 180.0 / std::numbers::pi) > 270.0;
    out.push_back(jumps ? std::nan("") : phase);
  }
  return out;
}

/// One transfer over frequency, in the magnitude and the phase plot alike.
struct Bode {
  Plot magnitude, phase;
  std::vector<double> Hz;
  Bode(const char* name, double low, double high)
      : magnitude(frequency_plot(fmt::format("{}: magnitude", name), "dB")),
        phase(frequency_plot(fmt::format("{}: phase", name), "deg")), Hz(log_grid(low, high, bode_points)) {}
  template <class Transfer> void add(const char* name, Tone tone, bool dashed, const Transfer& transfer) {
    std::vector<Complex> values;
    std::vector<double> size;
    for (const double f : Hz) {
      values.push_back(transfer(f));
      size.push_back(decibel(values.back()));
    }
    magnitude.curves.push_back({name, tone, Hz, size, dashed, false});
    phase.curves.push_back({name, tone, Hz, phase_of(values), dashed, false});
  }
};

void add_margin_marks(Bode& bode, const LoopMargins& margins) {
  if (std::isfinite(margins.gain_up))
    bode.magnitude.marks.push_back({margins.gain_up_Hz, fmt::format("gain x {:.3g}", margins.gain_up)});
  if (std::isfinite(margins.phase_deg))
    bode.phase.marks.push_back({margins.phase_Hz, fmt::format("{:.3g} deg", margins.phase_deg)});
}

void add_bode(HtmlPage& page, const AxisDesign& design) {
  page.section("Bode diagrams",
               "Open loop, cut at the command, with observer or filter, hold and delay; the loop is at its limit "
               "where magnitude is 0 dB and phase 180 deg. Distributed lines: exact theory with "
               "frequency-dependent friction.");
  const double highest = 0.5 / design.loop.period_s;
  Bode open("Open loop", 0.1, std::min(highest, 1000.0));
  open.add("linear model", Tone::chamber, false, [&](double f) { return design.loop.open(f); });
  open.add("distributed lines", Tone::valve, true, [&](double f) { return exact_open(design, f); });
  add_margin_marks(open, design.margins);
  page.plots({open.magnitude, open.phase});
  Bode closed("Closed loop, position over reference at the position gain", 0.1, std::min(highest, 1000.0));
  const auto& loop = design.loop;
  closed.add("linear model", Tone::chamber, false, [&](double f) {
    const Complex z = std::exp(Complex(0.0, 2.0 * std::numbers::pi * f * loop.period_s));
    const Complex by_reference = loop.law.transfer(z)(0, loop.plant.C.rows());
    return loop.plant.transfer(z)(0, 0) * by_reference / (1.0 + loop.open(f));
  });
  page.plots({closed.magnitude, closed.phase});
}

void add_line(HtmlPage& page, const Rig& rig, const AxisDesign& design) {
  page.section(
      "Line 1",
      "Flow into the chamber over flow through the valve. The model's line has quasi-steady friction, which damps "
      "less than real air near resonance.");
  const AxisSide& side = design.linear.sides[0];
  const auto& line = rig.axis.line_1;
  const double quarter_Hz = design.linear.lines[0].sound_speed_mps() / (4.0 * line.length_m);
  Bode bode("Line", 0.02 * quarter_Hz, 4.0 * quarter_Hz);
  const LineEnds ends{0.0, side.chamber_volume_m3 / design.linear.polytropic_exponent};
  const auto at = [](double f) { return Complex(0.0, 2.0 * std::numbers::pi * f); };
  bode.add("frequency-dependent friction", Tone::chamber, false,
           [&](double f) { return flow_transfer(design.linear.lines[0], ends, at(f)); });
  const LineAcoustics simple(line.length_m, line.diameter_m, side.pressure_Pa, rig.axis.air, LineLoss::quasi_steady);
  bode.add("quasi-steady friction", Tone::estimated, false,
           [&](double f) { return flow_transfer(simple, ends, at(f)); });
  bode.add("lag of the linear model", Tone::valve, true, [&](double f) {
    return 1.0 / (1.0 + side.lag.slope_s() * at(f) + side.lag.curvature_s2() * at(f) * at(f));
  });
  page.plots({bode.magnitude, bode.phase});
}

/// Loci over the loop gain from a tenth of the design's to well beyond its upper margin.
PolePlot locus_plot(const AxisDesign& design, std::string title, double extent) {
  PolePlot plot;
  plot.title = std::move(title);
  plot.real_min = -extent;
  plot.real_max = 0.3 * extent;
  plot.imag_max = extent;
  PoleSet less{"gain below the design's", Tone::estimated, PoleMark::dot, {}},
      more{"above", Tone::valve, PoleMark::dot, {}};
  const double most = std::isfinite(design.margins.gain_up) ? std::max(4.0, 1.5 * design.margins.gain_up) : 10.0;
  for (const double gain : log_grid(0.1, most, locus_points)) {
    auto& set = gain < 1.0 ? less : more;
    for (const Complex& pole : design.loop.poles(gain)) set.poles.push_back(pole);
  }
  plot.sets = {less,
               more,
               {"ideal derivatives", Tone::neutral, PoleMark::circle, design.models.back().poles},
               {"design", Tone::chamber, PoleMark::cross, design.poles}};
  return plot;
}

void add_poles(HtmlPage& page, const AxisDesign& design) {
  page.section("Pole loci",
               fmt::format("Closed-loop poles, sampled ones as s = ln(z)/period, while the loop gain grows from 0.1 to "
                           "{:.3g} times the design's. Right of the vertical line the loop is unstable.",
                           std::isfinite(design.margins.gain_up) ? std::max(4.0, 1.5 * design.margins.gain_up) : 10.0));
  double fastest = 0.0, slowest = 0.0;  // of the model's own poles; the observer's may lie far out
  const auto& poles = design.models.back().poles;
  for (const Complex& pole : poles) fastest = std::max(fastest, std::abs(pole));
  for (std::size_t i = 0; i < std::min<std::size_t>(3, poles.size()); ++i)
    slowest = std::max(slowest, std::abs(poles[i]));
  page.poles({locus_plot(design, "All poles", 1.5 * fastest), locus_plot(design, "The slow ones", 2.5 * slowest)});
  page.table(pole_table(design));
}

void add_step(HtmlPage& page, const AxisDesign& design) {
  if (!design.is_stable) return;
  Plot plot;
  plot.title = "Step of the reference";
  plot.unit = "m/m";
  plot.group.clear();
  const double end_s = std::isfinite(design.step.settling_s) ? 1.6 * design.step.settling_s : design.step.t_s.back();
  Curve curve{"position", Tone::chamber, {}, {}, false, false},
      wanted{"reference", Tone::neutral, {0.0, end_s}, {1.0, 1.0}, true, false};
  for (std::size_t i = 0; i < design.step.t_s.size() && design.step.t_s[i] <= end_s; ++i) {
    curve.x.push_back(design.step.t_s[i]);
    curve.y.push_back(design.step.y[i]);
  }
  plot.curves = {curve, wanted};
  if (std::isfinite(design.step.settling_s)) plot.marks.push_back({design.step.settling_s, "within 2 %"});
  page.plot(plot);
}

std::string headline(const AxisDesign& design) {
  if (!design.is_stable) return "The loop is unstable with these gains";
  const LoopMargins& m = design.margins;
  std::string down = m.gain_down > 0.0 ? fmt::format("{:.3g}", m.gain_down) : std::string("0");
  std::string up = std::isfinite(m.gain_up) ? fmt::format("{:.3g}", m.gain_up) : std::string("any factor");
  return fmt::format("The loop gain may lie between {} and {} of the design's, phase margin {:.3g} deg", down, up,
                     m.phase_deg);
}

HtmlPage make_page(const Rig& rig, const AxisDesign& design, const std::string& config_yaml) {
  HtmlPage page(rig.name + " · design", fmt::format("{} · {}", rig.name, circumstances(rig, design)), headline(design));
  for (const std::string& warning : design.warnings) page.alert(warning);
  page.section("Loop");
  page.table(gain_table(rig, design));
  page.table(margin_table(design));
  page.table(loop_table(rig, design));
  add_step(page, design);
  add_poles(page, design);
  add_bode(page, design);
  page.section("Model");
  page.table(model_table(rig, design));
  page.table(feedforward_table(design));
  page.table(coefficient_table(design));
  if (design.spool) page.table(spool_table(rig, design));
  add_line(page, rig, design);
  page.section("Circumstances");
  page.details("Config as designed", config_yaml);
  return page;
}

}  // namespace

std::string design_report_html(const Rig& rig, const AxisDesign& design, const std::string& config_yaml) {
  return make_page(rig, design, config_yaml).html();
}

void write_design_report(const Rig& rig, const AxisDesign& design, const std::string& config_yaml,
                         const std::string& path) {
  make_page(rig, design, config_yaml).write(path);
}

}  // namespace pneuservo
