// What the verb design says, as tables for screen and page.
#include <report/design_summary.hpp>

#include <cmath>
#include <numbers>

#include <design/itae.hpp>
#include <design/sampled_laws.hpp>
#include <fmt/format.h>

namespace pneuservo {
namespace {

constexpr double rad_per_cycle = 2.0 * std::numbers::pi;

/// A table of quantities, each with its own unit.
class Quantities {
 public:
  explicit Quantities(std::string title) { table_.title = std::move(title); }
  void add(std::string name, double value, std::string unit, std::string remark = "") {
    add_text(std::move(name), digits(value), std::move(unit), std::move(remark));
  }
  void add_text(std::string name, std::string value, std::string unit, std::string remark = "") {
    names_.push_back(std::move(name));
    values_.push_back(std::move(value));
    units_.push_back(std::move(unit));
    remarks_.push_back(std::move(remark));
  }
  Table table() const {
    Table out = table_;
    out.columns = {text_column("quantity", names_), {"value", "", values_, false}, text_column("unit", units_)};
    for (const std::string& remark : remarks_)
      if (!remark.empty()) {
        out.columns.push_back(text_column("", remarks_));
        break;
      }
    return out;
  }
  static std::string digits(double value) { return std::isfinite(value) ? fmt::format("{:.5g}", value) : "–"; }

 private:
  Table table_;
  std::vector<std::string> names_, values_, units_, remarks_;
};

std::string lag_text(const SecondOrderLag& lag) {
  if (!(lag.natural_frequency_rad_per_s > 0.0)) return "none";
  return fmt::format("{:.4g} Hz, {:.3g}", lag.natural_frequency_rad_per_s / rad_per_cycle, lag.damping_ratio);
}

std::string source_text(const AxisSide& side) {
  std::string theory = side.resonance ? fmt::format("exact theory {:.4g} Hz, {:.2g}",
                                                    side.resonance->natural_frequency_Hz, side.resonance->damping_ratio)
                                      : std::string("exact theory: no resonance, friction damps it away");
  switch (side.source) {
    case LagSource::config: return "config; " + theory;
    case LagSource::low_frequency: return theory + "; matched at low frequency";
    case LagSource::resonance: break;
  }
  return "exact theory with this chamber";
}

std::string order_name(int order) { return fmt::format("{}{}", order, order == 3 ? "rd" : "th"); }

void add_gain(Table& table, std::string_view name, double before, double after, std::string_view unit) {
  table.columns[0].cells.emplace_back(name);
  table.columns[1].cells.push_back(Quantities::digits(before));
  table.columns[2].cells.push_back(Quantities::digits(after));
  table.columns[3].cells.emplace_back(unit);
}

std::vector<std::complex<double>> upper(const std::vector<std::complex<double>>& poles) {
  std::vector<std::complex<double>> out;
  for (const auto& pole : poles)
    if (pole.imag() >= 0.0) out.push_back(pole);
  return out;
}

}  // namespace

std::string pole_text(std::complex<double> pole) {
  if (std::fabs(pole.imag()) < 1e-9 * std::abs(pole) || pole == 0.0) return fmt::format("{:.1f}", pole.real());
  return fmt::format("{:.1f} ± {:.1f}j", pole.real(), std::fabs(pole.imag()));
}

Table model_table(const Rig& rig, const AxisDesign& design) {
  const AxisLinearisation& linear = design.linear;
  Quantities out("Linear model");
  out.add("K", linear.axis.gain_per_V, "m/(s3 V)", "jerk per volt of spool");
  out.add("omega_n", std::sqrt(linear.axis.natural_frequency_squared()), "rad/s", "slider between both air springs");
  if (rig.valves() == 2) {
    out.add("delta", linear.discharge_ratio, "-", "discharge over charge flow");
    out.add("K_n", linear.speed_per_area_per_ms, "1/(m s)");
    out.add("K_sv", rig.axis.valve.area_per_volt_m2_per_V, "m2/V");
  } else {
    out.add("B/m", linear.axis.damping_per_s, "1/s");
  }
  out.add_text("valve", lag_text(linear.axis.valve), "");
  for (std::size_t i = 0; i < 2; ++i)
    out.add_text(fmt::format("line {}", i + 1), lag_text(linear.sides[i].lag), "", source_text(linear.sides[i]));
  out.add_text("omega_0, zeta_0", lag_text(design.matched), "", "all lags in one, matched at low frequency");
  out.add_text("", lag_text(design.by_distance), "", "by distance of the poles: not used");
  return out.table();
}

Table gain_table(const Rig& rig, const AxisDesign& design) {
  Table table;
  table.title = fmt::format("Gains, method {}", design_method_names[static_cast<std::size_t>(design.method)]);
  table.columns = {
      text_column("gain", {}), {"config", "", {}, false}, {"design", "", {}, false}, text_column("unit", {})};
  const auto own = [](const auto& parameters) { return own_gains(parameters); };
  const std::vector<NamedGain> before = with_linear_law(rig.controller, own),
                               after = with_linear_law(design.controller, own);
  for (std::size_t i = 0; i < before.size(); ++i)
    add_gain(table, before[i].name, before[i].value, after[i].value, before[i].unit);
  const Ppd2Gains &a = design.gains_before, &b = design.gains;
  add_gain(table, "K_p", a.position_V_per_m, b.position_V_per_m, "V/m");
  add_gain(table, "K_v", a.velocity_Vs_per_m, b.velocity_Vs_per_m, "V s/m");
  add_gain(table, "K_a", a.acceleration_Vs2_per_m, b.acceleration_Vs2_per_m, "V s2/m");
  return table;
}

Table pole_table(const AxisDesign& design) {
  Table table;
  table.title = "Closed-loop poles [rad/s]: ideal derivatives by order of the model; sampled with observer and hold";
  for (const ModelFigures& model : design.models) {
    TableColumn column{order_name(model.axis.order()), "", {}, false};
    for (const auto& pole : upper(model.poles)) column.cells.push_back(pole_text(pole));
    table.columns.push_back(column);
  }
  TableColumn sampled{"sampled", "", {}, false}, frequency{"frequency", "Hz", {}, false},
      damping{"damping", "", {}, false};
  for (const auto& pole : upper(design.poles)) {
    sampled.cells.push_back(pole_text(pole));
    frequency.cells.push_back(fmt::format("{:.1f}", std::abs(pole) / rad_per_cycle));
    damping.cells.push_back(fmt::format("{:.2f}", -pole.real() / std::abs(pole)));
  }
  for (TableColumn* column : {&sampled, &frequency, &damping}) table.columns.push_back(*column);
  return table;
}

Table feedforward_table(const AxisDesign& design) {
  Table table;
  table.title = "Feedforward r = x + sum c_i d^i x/dt^i, the inverse of the closed loop [s^i]";
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= design.models.back().feedforward.size(); ++i) names.push_back(fmt::format("c{}", i));
  table.columns.push_back(text_column("", names));
  for (const ModelFigures& model : design.models) {
    TableColumn column{order_name(model.axis.order()), "", {}, false};
    for (const double c : model.feedforward) column.cells.push_back(fmt::format("{:.5e}", c));
    table.columns.push_back(column);
  }
  return table;
}

Table margin_table(const AxisDesign& design) {
  Table table;
  table.title = "Margins, sampled, the loop cut at the command";
  table.columns = {text_column("model", {"linear", "distributed lines"}),
                   {"gain down", "", {}, false},
                   {"at", "Hz", {}, false},
                   {"gain up", "", {}, false},
                   {"at", "Hz", {}, false},
                   {"phase", "deg", {}, false},
                   {"at", "Hz", {}, false}};
  for (const LoopMargins* margins : {&design.margins, &design.exact_margins}) {
    const auto cell = [&](std::size_t column, double value, const char* format) {
      table.columns[column].cells.push_back(std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "–");
    };
    const double none = std::nan("");
    cell(1, margins->gain_down, "{:.3f}");
    cell(2, margins->gain_down > 0.0 ? margins->gain_down_Hz : none, "{:.1f}");
    cell(3, margins->gain_up, "{:.3f}");
    cell(4, std::isfinite(margins->gain_up) ? margins->gain_up_Hz : none, "{:.1f}");
    cell(5, margins->phase_deg, "{:.1f}");
    cell(6, std::isfinite(margins->phase_deg) ? margins->phase_Hz : none, "{:.1f}");
  }
  return table;
}

Table loop_table(const Rig& rig, const AxisDesign& design) {
  Quantities out("Loop");
  const bool stable = design.is_stable;
  out.add("overshoot of a step", stable ? 100.0 * design.step.overshoot : std::nan(""), "%");
  out.add("within 2 % after", stable ? design.step.settling_s : std::nan(""), "s");
  for (const ModelFigures& model : design.models)
    out.add("ITAE of a step, " + order_name(model.axis.order()), model.itae_s2, "s2", "ideal derivatives");
  out.add("command noise, rms", 1e6 * design.command_noise_V, "uV", "from the position sensor alone");
  if (design.mean_pressure_needed_Pa && *design.mean_pressure_needed_Pa > 0.0)
    out.add(
        "mean pressure needed", 1e-3 * *design.mean_pressure_needed_Pa, "kPa",
        fmt::format("by the reference; the config holds {:g} kPa", 1e-3 * rig.controller.of<Ppd2>().mean_pressure_Pa));
  return out.table();
}

Table spool_table(const Rig& rig, const AxisDesign& design) {
  Quantities out(fmt::format("Inner loop of the valve: {:g} Hz, damping {:g}, 100 us, spool of Table 2.3",
                             rig.axis.valve.natural_frequency_Hz, rig.axis.valve.damping_ratio));
  if (design.spool) {
    out.add_text("K1", fmt::format("{:.6g}", design.spool->K1_V_per_m), "V/m");
    out.add_text("K2", fmt::format("{:.6g}", design.spool->K2_Vs_per_m), "V s/m");
    out.add_text("K3", fmt::format("{:.6g}", design.spool->K3), "-");
    out.add_text("observer: alpha", fmt::format("{:.6g}", design.spool->alpha), "-");
    out.add_text("beta", fmt::format("{:.6g}", design.spool->beta_per_s), "1/s");
    out.add_text("gamma", fmt::format("{:.6g}", design.spool->gamma_V_per_m), "V/m");
  }
  return out.table();
}

Table coefficient_table(const AxisDesign& design) {
  Table table;
  table.title = "Normalised coefficients C_i of s^i: this loop, least ITAE, classic ITAE";
  TableColumn names = text_column("", {});
  for (int i = 1; i < design.models.back().axis.order(); ++i) names.cells.push_back(fmt::format("C of s^{}", i));
  table.columns.push_back(names);
  for (const ModelFigures& model : design.models) {
    const int order = model.axis.order();
    const auto column = [&](const std::string& title, const std::vector<double>& values) {
      TableColumn out{title, "", {}, false};
      for (const double value : values) out.cells.push_back(fmt::format("{:.3f}", value));
      table.columns.push_back(out);
    };
    column(order_name(order), model.coefficients);
    if (order > 7) continue;
    column("least", least_itae_coefficients(order));
    column("classic", classic_itae_coefficients(order));
  }
  return table;
}

std::string circumstances(const Rig& rig, const AxisDesign& design) {
  const bool table = rig.valves() == 2;
  const auto& sides = design.linear.sides;
  const std::string pressures =
      table ? fmt::format("P0 {:g} kPa", 1e-3 * sides[0].pressure_Pa)
            : fmt::format("{:g} and {:.4g} kPa", 1e-3 * sides[0].pressure_Pa, 1e-3 * sides[1].pressure_Pa);
  return fmt::format("{}, {}, period {:g} us, command delay {:g} us", table ? "servo table" : "cylinder", pressures,
                     1e6 * rig.period_s, 1e6 * design.delay_s);
}

std::string design_text(const Rig& rig, const AxisDesign& design, bool coefficients) {
  std::string out = fmt::format("{}: {}\n\n", rig.name, circumstances(rig, design));
  const auto add = [&](const Table& table) { out += text_table(table) + "\n"; };
  add(model_table(rig, design));
  add(gain_table(rig, design));
  add(pole_table(design));
  add(margin_table(design));
  add(loop_table(rig, design));
  add(feedforward_table(design));
  if (coefficients) add(coefficient_table(design));
  if (design.spool) add(spool_table(rig, design));
  for (const std::string& warning : design.warnings) out += "warning: " + warning + "\n";
  if (design.warnings.empty()) out += "no warnings\n";
  return out;
}

}  // namespace pneuservo
