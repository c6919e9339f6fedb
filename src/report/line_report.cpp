// What was identified of a line, in words, as JSON and as a page.
#include "report/line_report.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "report/html_page.hpp"
#include "report/json_number.hpp"

namespace pneuservo {
namespace {

LineAcoustics theory(const IdentifiedLine& line, LineLoss loss) {
  return {line.belief.length_m, line.belief.diameter_m, line.found.mean_pressure_Pa, line.belief.air, loss};
}

/// Of exact or quasi-steady theory with the config's numbers; no numbers where there is no peak.
LineResonance expected(const IdentifiedLine& line, LineLoss loss) {
  try {
    return first_resonance(theory(line, loss), line.belief.ends);
  } catch (const std::invalid_argument&) {
    LineResonance none;
    none.natural_frequency_Hz = none.damping_ratio = std::nan("");
    return none;
  }
}

std::vector<std::string> remarks(const IdentifiedLine& line) {
  std::vector<std::string> out;
  const LineIdentification& f = line.found;
  if (!f.resonates) out.emplace_back("friction damps the first resonance away: there is no natural frequency");
  if (f.ends_share > 0.02)  // the ends move as much as the rest of the recording
    out.push_back(fmt::format("{} moves at the recording's ends ({:.0f} % of its changes lie in the first and last "
                              "hundredth): what went before is taken for rest, so record rest at both ends",
                              line.in_column, 100.0 * f.ends_share));
  if (line.port_age_s > 0.0)
    out.push_back(
        fmt::format("a simulated recording: its port is {:.3g} us older than its chamber, one sub-step of the "
                    "line, which the fit reckons with",
                    1e6 * line.port_age_s));
  if (line.sensor_noise_Pa > 0.0 && f.noise_Pa > 2.0 * line.sensor_noise_Pa)
    out.push_back(fmt::format(
        "the fit leaves {:.0f} Pa where the sensors' noise is {:.0f} Pa: something that a line with "
        "a volume does not have is in it (leaks, slow sensors, or swings that are no longer small: then let "
        "diagnose fit the length, by tolerances.line.length_m)",
        f.noise_Pa, line.sensor_noise_Pa));
  if (line.bridged_rows > 0)
    out.push_back(fmt::format("{} missing rows are bridged by straight lines", line.bridged_rows));
  return out;
}

std::string estimate_text(const EstimatedNumber& n, double factor = 1.0) {
  return fmt::format("{:.4g} +- {:.2g}", factor * n.value, factor * n.standard_error);
}

Table resonance_table(const IdentifiedLine& line) {
  const LineIdentification& f = line.found;
  const LineResonance exact = expected(line, LineLoss::frequency_dependent),
                      steady = expected(line, LineLoss::quasi_steady);
  const auto plain = [](double value) {
    return std::isfinite(value) ? fmt::format("{:.4g}", value) : std::string("-");
  };
  Table table;
  table.title = "First resonance, valve flow to chamber flow";
  table.columns = {
      text_column("", {"identified", "exact theory, config", "quasi-steady theory, config"}),
      text_column("natural frequency [Hz]", {f.resonates ? estimate_text(f.natural_frequency_Hz) : "-",
                                             plain(exact.natural_frequency_Hz), plain(steady.natural_frequency_Hz)}),
      text_column("damping ratio [-]", {f.resonates ? estimate_text(f.damping_ratio) : "-", plain(exact.damping_ratio),
                                        plain(steady.damping_ratio)})};
  return table;
}

Table parameter_table(const IdentifiedLine& line) {
  const LineIdentification& f = line.found;
  Table table;
  table.title = "What was fitted";
  table.columns = {text_column("", {"length at the config's speed of sound [m]", "losses over those of the air [-]",
                                    "volume at the end [cm3]", "gain of the far sensor over the near one [-]"}),
                   text_column("identified", {estimate_text(f.length_m), estimate_text(f.loss_ratio),
                                              estimate_text(f.volume_out_m3, 1e6), estimate_text(f.gain)}),
                   text_column("config", {fmt::format("{:.4g}", line.belief.length_m), "1",
                                          fmt::format("{:.4g}", 1e6 * line.belief.ends.volume_out_m3), "1"})};
  return table;
}

std::string headline(const IdentifiedLine& line) {
  const LineIdentification& f = line.found;
  return fmt::format("{} to {}, {:.3g} bar, {:.3g} to {:.3g} Hz; the fit leaves {:.3g} Pa", line.in_column,
                     line.out_column, 1e-5 * f.mean_pressure_Pa, f.lowest_Hz, f.highest_Hz, f.noise_Pa);
}

}  // namespace

std::string line_text(const IdentifiedLine& line) {
  std::string text = headline(line) + "\n" + text_table(resonance_table(line)) + text_table(parameter_table(line));
  for (const std::string& remark : remarks(line)) text += remark + "\n";
  return text;
}

nlohmann::ordered_json line_json(const IdentifiedLine& line) {
  const LineIdentification& f = line.found;
  const auto estimated = [](const EstimatedNumber& n) {
    return Json{{"value", number(n.value)}, {"standard_error", number(n.standard_error)}};
  };
  const auto resonance = [&](LineLoss loss) {
    const LineResonance r = expected(line, loss);
    return Json{{"natural_frequency_Hz", number(r.natural_frequency_Hz)}, {"damping_ratio", number(r.damping_ratio)}};
  };
  Json response = Json::array();
  for (const ResponsePoint& p : f.response)
    response.push_back({{"Hz", p.Hz},
                        {"magnitude", std::abs(p.measured)},
                        {"magnitude_standard_error", p.standard_error},
                        {"phase_rad", std::arg(p.measured)},
                        {"fitted_magnitude", std::abs(p.fitted)},
                        {"fitted_phase_rad", std::arg(p.fitted)}});
  return {{"in", line.in_column},
          {"out", line.out_column},
          {"mean_pressure_Pa", f.mean_pressure_Pa},
          {"port_age_s", line.port_age_s},
          {"lowest_Hz", f.lowest_Hz},
          {"highest_Hz", f.highest_Hz},
          {"natural_frequency_Hz", estimated(f.natural_frequency_Hz)},
          {"damping_ratio", estimated(f.damping_ratio)},
          {"exact_theory", resonance(LineLoss::frequency_dependent)},
          {"quasi_steady_theory", resonance(LineLoss::quasi_steady)},
          {"length_m", estimated(f.length_m)},
          {"loss_ratio", estimated(f.loss_ratio)},
          {"volume_out_m3", estimated(f.volume_out_m3)},
          {"gain", estimated(f.gain)},
          {"noise_Pa", f.noise_Pa},
          {"sensor_noise_Pa", line.sensor_noise_Pa},
          {"remarks", remarks(line)},
          {"response", std::move(response)}};
}

namespace {

void add_response(HtmlPage& page, const IdentifiedLine& line) {
  Plot magnitude = frequency_plot("Chamber over port: magnitude", "dB"),
       phase = frequency_plot("Chamber over port: phase", "deg");
  Curve measured{.name = "recorded", .tone = Tone::valve, .x = {}, .y = {}}, fitted = measured, believed = measured;
  fitted.name = "fitted", fitted.tone = Tone::estimated;
  believed.name = "exact theory, config", believed.tone = Tone::neutral, believed.dashed = true;
  Curve measured_phase = measured, fitted_phase = fitted, believed_phase = believed;
  Band band{.name = "two standard errors", .tone = Tone::valve, .x = {}, .low = {}, .high = {}};
  const LineAcoustics exact = theory(line, LineLoss::frequency_dependent);
  const auto decibel = [](double value) { return 20.0 * std::log10(std::max(value, 1e-6)); };
  const auto add = [&](Curve& size, Curve& angle, double Hz, std::complex<double> value) {
    size.x.push_back(Hz), angle.x.push_back(Hz);
    size.y.push_back(decibel(std::abs(value)));
    angle.y.push_back(std::arg(value) * 180.0 / std::numbers::pi);
  };
  for (const ResponsePoint& p : line.found.response) {
    add(measured, measured_phase, p.Hz, p.measured);
    add(fitted, fitted_phase, p.Hz, p.fitted);
    add(believed, believed_phase, p.Hz,
        pressure_transfer(exact, line.belief.ends, std::complex<double>(0.0, 2.0 * std::numbers::pi * p.Hz)));
    band.x.push_back(p.Hz);
    band.low.push_back(decibel(std::abs(p.measured) - 2.0 * p.standard_error));
    band.high.push_back(decibel(std::abs(p.measured) + 2.0 * p.standard_error));
  }
  magnitude.bands = {band};
  magnitude.curves = {measured, fitted, believed};
  phase.curves = {measured_phase, fitted_phase, believed_phase};
  if (line.found.resonates) magnitude.marks.push_back({line.found.natural_frequency_Hz.value, "flow resonance"});
  page.section("Pressure at the chamber over pressure at the valve's port", "Recorded, with its noise, and as fitted.");
  page.plots({magnitude, phase});
}

}  // namespace

void write_line_report(const IdentifiedLine& line, const std::string& rig, const std::string& path) {
  HtmlPage page("Line of " + rig, "pneuservo identify", "Line of " + rig + ": frequency and damping");
  page.paragraph(headline(line));
  for (const std::string& remark : remarks(line)) page.alert(remark);
  page.table(resonance_table(line));
  page.table(parameter_table(line));
  add_response(page, line);
  page.write(path);
}

}  // namespace pneuservo
