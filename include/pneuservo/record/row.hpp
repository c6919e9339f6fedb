// One row of a recording: the columns of the format, declared once for ring, writer, reader and reports.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

namespace pneuservo {

/// Bits of the column `flags`.
enum RowFlag : std::uint32_t {
  row_overrun = 1,          ///< this tick came late, slots were skipped before it
  row_dropped_before = 2,   ///< rows were dropped before this one
  row_command_limited = 4,
  row_fault = 8,
  row_input_bridged = 16,   ///< a sample of this tick was wrong and was replaced
};

/// Plain data, copied through the ring. NaN means "no value" and is written as an empty field.
struct Row {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  double t_s = 0.0;
  double x_ref_m = none, v_ref_mps = none;
  double x_predicted_m = none;                            ///< of the simulated closed loop
  double x_m = none, v_mps = none;
  double u_V = none;
  double u1_V = none, u2_V = none;                        ///< of a servo table's two valves, instead of u_V
  double p1_port_Pa = none, p2_port_Pa = none;
  double p1_chamber_Pa = none, p2_chamber_Pa = none;
  double p1_estimated_Pa = none, p2_estimated_Pa = none;
  double p1_bound_Pa = none, p2_bound_Pa = none;          ///< the estimator's stated error bounds
  double mass_flow_1_kgps = none, mass_flow_2_kgps = none;  ///< estimated, into the chambers
  double p_supply_Pa = none;
  double x_true_m = none, p1_chamber_true_Pa = none, p2_chamber_true_Pa = none;
  double lateness_us = none, work_us = none;              ///< real time only
  std::uint32_t state = 0;                                ///< SupervisorState (loop/supervisor.hpp)
  std::uint32_t flags = 0;
  std::uint64_t fault = 0;                                ///< bits of Fault (loop/fault.hpp), 0 while healthy
  static constexpr std::size_t most_terms = 16;
  std::array<double, most_terms> terms = no_terms();      ///< of the law, which names them (control/law.hpp)

  static constexpr std::array<double, most_terms> no_terms() noexcept {
    std::array<double, most_terms> out;
    out.fill(none);
    return out;
  }
  /// v(name, member...) for every column in file order, the law's terms last, by their names.
  template <class V, class... R> static void visit_all(std::span<const std::string_view> term_names, V&& v, R&... r) {
    visit(v, r...);
    for (std::size_t i = 0; i < term_names.size(); ++i) v(term_names[i], r.terms[i]...);
  }
  /// v(name, member...) for the columns that no law names.
  template <class V, class... R> static constexpr void visit(V&& v, R&... r) {
    v(std::string_view("t_s"), r.t_s...);
    v(std::string_view("x_ref_m"), r.x_ref_m...);
    v(std::string_view("v_ref_mps"), r.v_ref_mps...);
    v(std::string_view("x_predicted_m"), r.x_predicted_m...);
    v(std::string_view("x_m"), r.x_m...);
    v(std::string_view("v_mps"), r.v_mps...);
    v(std::string_view("u_V"), r.u_V...);
    v(std::string_view("u1_V"), r.u1_V...);
    v(std::string_view("u2_V"), r.u2_V...);
    v(std::string_view("p1_port_Pa"), r.p1_port_Pa...);
    v(std::string_view("p2_port_Pa"), r.p2_port_Pa...);
    v(std::string_view("p1_chamber_Pa"), r.p1_chamber_Pa...);
    v(std::string_view("p2_chamber_Pa"), r.p2_chamber_Pa...);
    v(std::string_view("p1_estimated_Pa"), r.p1_estimated_Pa...);
    v(std::string_view("p2_estimated_Pa"), r.p2_estimated_Pa...);
    v(std::string_view("p1_bound_Pa"), r.p1_bound_Pa...);
    v(std::string_view("p2_bound_Pa"), r.p2_bound_Pa...);
    v(std::string_view("mass_flow_1_kgps"), r.mass_flow_1_kgps...);
    v(std::string_view("mass_flow_2_kgps"), r.mass_flow_2_kgps...);
    v(std::string_view("p_supply_Pa"), r.p_supply_Pa...);
    v(std::string_view("x_true_m"), r.x_true_m...);
    v(std::string_view("p1_chamber_true_Pa"), r.p1_chamber_true_Pa...);
    v(std::string_view("p2_chamber_true_Pa"), r.p2_chamber_true_Pa...);
    v(std::string_view("lateness_us"), r.lateness_us...);
    v(std::string_view("work_us"), r.work_us...);
    v(std::string_view("state"), r.state...);
    v(std::string_view("flags"), r.flags...);
    v(std::string_view("fault"), r.fault...);
  }
};

}  // namespace pneuservo
