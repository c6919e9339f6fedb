// The result of `design` as JSON, with units in the keys.
#include <report/design_json.hpp>

#include <cmath>
#include <numbers>

#include <design/itae.hpp>
#include <design/sampled_laws.hpp>
#include <fmt/format.h>
#include <report/json_number.hpp>

namespace pneuservo {
namespace {

Json poles_json(const std::vector<std::complex<double>>& poles) {
  Json out = Json::array();
  for (const auto& pole : poles) out.push_back({pole.real(), pole.imag()});
  return out;
}

Json lag_json(const SecondOrderLag& lag) {
  if (!(lag.natural_frequency_rad_per_s > 0.0)) return nullptr;
  return {{"natural_frequency_Hz", lag.natural_frequency_rad_per_s / (2.0 * std::numbers::pi)},
          {"damping_ratio", lag.damping_ratio}};
}

Json margins_json(const LoopMargins& margins) {
  return {{"gain_down", number(margins.gain_down)}, {"gain_down_Hz", number(margins.gain_down_Hz)},
          {"gain_up", number(margins.gain_up)},     {"gain_up_Hz", number(margins.gain_up_Hz)},
          {"phase_deg", number(margins.phase_deg)}, {"phase_Hz", number(margins.phase_Hz)}};
}

Json gains_json(const ControllerParameters& controller, const Ppd2Gains& gains) {
  Json out;
  for (const NamedGain& gain : with_linear_law(controller, [](const auto& p) { return own_gains(p); }))
    out[std::string(gain.name)] = gain.value;
  out["position_gain_V_per_m"] = gains.position_V_per_m;
  out["velocity_gain_Vs_per_m"] = gains.velocity_Vs_per_m;
  out["acceleration_gain_Vs2_per_m"] = gains.acceleration_Vs2_per_m;
  return out;
}

Json side_json(const AxisSide& side) {
  constexpr const char* sources[] = {"config", "resonance", "low_frequency"};
  Json out{{"pressure_Pa", side.pressure_Pa},
           {"chamber_volume_m3", side.chamber_volume_m3},
           {"flow_kgps_per_V", side.flow_kgps_per_V},
           {"lag", lag_json(side.lag)},
           {"lag_source", sources[static_cast<int>(side.source)]}};
  if (side.resonance)
    out["exact_resonance"] = {{"natural_frequency_Hz", side.resonance->natural_frequency_Hz},
                              {"damping_ratio", side.resonance->damping_ratio},
                              {"static_gain", side.resonance->static_gain}};
  return out;
}

Json models_json(const AxisDesign& design, bool coefficients) {
  Json out = Json::array();
  for (const ModelFigures& model : design.models) {
    const int order = model.axis.order();
    Json json{{"order", order},
              {"poles_rad_per_s", poles_json(model.poles)},
              {"itae_s2", number(model.itae_s2)},
              {"feedforward_c", model.feedforward},
              {"normalised_coefficients", model.coefficients}};
    if (coefficients && order <= 7) {
      json["least_itae_coefficients"] = least_itae_coefficients(order);
      json["classic_itae_coefficients"] = classic_itae_coefficients(order);
    }
    out.push_back(json);
  }
  return out;
}

}  // namespace

Json design_json(const Rig& rig, const AxisDesign& design, bool coefficients) {
  const LinearAxis& axis = design.linear.axis;
  Json out{{"config", rig.name},
           {"method", design_method_names[static_cast<std::size_t>(design.method)]},
           {"period_s", rig.period_s},
           {"command_delay_s", design.delay_s},
           {"gain_m_per_s3V", axis.gain_per_V},
           {"natural_frequency_rad_per_s", std::sqrt(axis.natural_frequency_squared())},
           {"damping_per_s", axis.damping_per_s}};
  if (rig.valves() == 2) {
    out["discharge_ratio"] = design.linear.discharge_ratio;
    out["K_n_per_ms"] = design.linear.speed_per_area_per_ms;
    out["area_per_volt_m2_per_V"] = rig.axis.valve.area_per_volt_m2_per_V;
  }
  out["valve"] = lag_json(axis.valve);
  out["sides"] = {side_json(design.linear.sides[0]), side_json(design.linear.sides[1])};
  out["fifth_order_lag"] = lag_json(design.matched);
  out["pole_distance_lag"] = lag_json(design.by_distance);
  out["gains_config"] = gains_json(rig.controller, design.gains_before);
  out["gains"] = gains_json(design.controller, design.gains);
  out["models"] = models_json(design, coefficients);
  out["sampled_poles_rad_per_s"] = poles_json(design.poles);
  out["stable"] = design.is_stable;
  out["margins"] = margins_json(design.margins);
  out["margins_distributed_lines"] = margins_json(design.exact_margins);
  out["step"] = {{"overshoot", design.is_stable ? number(design.step.overshoot) : Json(nullptr)},
                 {"settling_s", design.is_stable ? number(design.step.settling_s) : Json(nullptr)}};
  out["command_noise_V"] = design.command_noise_V;
  if (design.mean_pressure_needed_Pa)
    out["mean_pressure_needed_Pa"] =
        *design.mean_pressure_needed_Pa > 0.0 ? Json(*design.mean_pressure_needed_Pa) : Json(nullptr);
  if (design.spool)
    out["spool_loop"] = {{"K1_V_per_m", design.spool->K1_V_per_m},
                         {"K2_Vs_per_m", design.spool->K2_Vs_per_m},
                         {"K3", design.spool->K3},
                         {"alpha", design.spool->alpha},
                         {"beta_per_s", design.spool->beta_per_s},
                         {"gamma_V_per_m", design.spool->gamma_V_per_m}};
  out["warnings"] = design.warnings;
  return out;
}

}  // namespace pneuservo
