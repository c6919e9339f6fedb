// The effects of the vocabulary (docs/physics/effects.md): physics that an element has beside the nominal model,
// neutral by default. Their equations stand in the elements that apply them; what a diagnosis knows of them beside that
// stands in src/elements.
#pragma once
#include <pneuservo/core/field.hpp>
#include <pneuservo/core/scalar.hpp>
#include <pneuservo/elements/motion_effects.hpp>

namespace pneuservo {

template <class S> struct ValveDeadBand {
  S width_V = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"width_V", "V", -1000, 1000, "w: each edge opens where |s| is past it; negative: an underlap"},
      p.width_V...);
  }
};
template <class S> struct ValveOffset {
  S offset_V = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"offset_V", "V", -1000, 1000, "o of s_eff = s + o"}, p.offset_V...);
  }
};
template <class S> struct ValveHysteresis {
  S width_V = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"width_V", "V", 0, 1000, "total width of the play between command and spool"}, p.width_V...);
  }
};
/// A spool that sticks where it stands until the command is far enough away, and then jumps to it.
template <class S> struct ValveStiction {
  S threshold_V = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"threshold_V", "V", 0, 1000, "distance of command and spool that breaks it loose"}, p.threshold_V...);
  }
};
template <class S> struct ValveLag {
  S time_constant_s = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"time_constant_s", "s", 0, 10, "first-order lag between command and spool"}, p.time_constant_s...);
  }
};
template <class S> struct ValveNeutralLeak {
  S area_m2 = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"area_m2", "m2", 0, 1e-2, "supply to each port and each port to exhaust, at every spool position"},
      p.area_m2...);
  }
};
template <class S> struct ValveAsymmetry {
  S exhaust_ratio = S(1);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"exhaust_ratio", "-", 0.01, 100, "exhaust areas over supply areas"}, p.exhaust_ratio...);
  }
};
/// Edges whose area is no straight line of the spool's way: its slope is (1 + n) times the configured one about the
/// middle (within a tenth of the largest command) and (1 + w) times it wide open.
template <class S> struct ValveCurve {
  S near_middle = S(0);
  S wide_open = S(0);
  /// Of the slope; s_max: the largest command.
  S factor(const S& opening_V, const S& command_max_V) const noexcept {
    const S bend = S(0.1) * command_max_V;
    return maximum(S(1) + near_middle * bend / (bend + opening_V) + wide_open * opening_V / command_max_V, S(0));
  }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"near_middle", "-", -0.9, 10, "n of slope (1 + n s_b/(s_b + |s|) + w |s|/s_max), s_b = s_max/10"},
      p.near_middle...);
    v(Field{"wide_open", "-", -0.9, 10, "w"}, p.wide_open...);
  }
};
/// What each of a valve's four edges has more than the valve says, as a share of that: edges are ground one by one.
template <class S> struct OfEachEdge {
  S supply_1 = S(0), exhaust_1 = S(0), supply_2 = S(0), exhaust_2 = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"supply_1", "-", -0.9, 10, "e of 1 + e times the valve's, for the edge that fills port 1"}, p.supply_1...);
    v(Field{"exhaust_1", "-", -0.9, 10, "of the edge that empties port 1"}, p.exhaust_1...);
    v(Field{"supply_2", "-", -0.9, 10, "of the edge that fills port 2"}, p.supply_2...);
    v(Field{"exhaust_2", "-", -0.9, 10, "of the edge that empties port 2"}, p.exhaust_2...);
  }
};
/// What the edges' areas are beside a straight line at six ways of the spool, as shares of it: |s| from 3 to 40 % of
/// the largest command. Between them along straight lines, outside as at the nearest.
template <class S> struct ValveLinearity {
  S at_3_percent = S(0), at_5_percent = S(0), at_8_percent = S(0), at_12_percent = S(0), at_20_percent = S(0),
    at_40_percent = S(0);
  static constexpr std::array<double, 6> ways{0.03, 0.05, 0.08, 0.12, 0.2, 0.4};  ///< over the largest command
  S share(const S& way) const noexcept {
    const auto part = [&](std::size_t from) {
      return minimum(maximum((way - S(ways[from])) * S(1 / (ways[from + 1] - ways[from])), S(0)), S(1));
    };
    return at_3_percent + (at_5_percent - at_3_percent) * part(0) + (at_8_percent - at_5_percent) * part(1) +
           (at_12_percent - at_8_percent) * part(2) + (at_20_percent - at_12_percent) * part(3) +
           (at_40_percent - at_20_percent) * part(4);
  }
  S size() const noexcept {
    return absolute(at_3_percent) + absolute(at_5_percent) + absolute(at_8_percent) + absolute(at_12_percent) +
           absolute(at_20_percent) + absolute(at_40_percent);
  }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"at_3_percent", "-", -0.9, 10, "share more than a straight line at 3 % of the largest command"},
      p.at_3_percent...);
    v(Field{"at_5_percent", "-", -0.9, 10, "at 5 %"}, p.at_5_percent...);
    v(Field{"at_8_percent", "-", -0.9, 10, "at 8 %"}, p.at_8_percent...);
    v(Field{"at_12_percent", "-", -0.9, 10, "at 12 %"}, p.at_12_percent...);
    v(Field{"at_20_percent", "-", -0.9, 10, "at 20 %"}, p.at_20_percent...);
    v(Field{"at_40_percent", "-", -0.9, 10, "at 40 %"}, p.at_40_percent...);
  }
};
template <class S> struct CommandDelay {
  S delay_s = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"delay_s", "s", 0, 0.5, "dead time between command and spool"}, p.delay_s...);
  }
};

/// The command path: delay, play, stiction, lag, (spool dynamics), offset, overlaps, area.
template <class S> struct ValveEffects {
  CommandDelay<S> command_delay;
  ValveHysteresis<S> valve_hysteresis;
  ValveStiction<S> valve_stiction;
  ValveLag<S> valve_lag;
  ValveOffset<S> valve_offset;
  ValveDeadBand<S> valve_dead_band;
  ValveNeutralLeak<S> valve_neutral_leak;
  ValveAsymmetry<S> valve_asymmetry;
  ValveCurve<S> valve_curve;
  ValveLinearity<S> valve_linearity_forward, valve_linearity_backward;
  OfEachEdge<S> valve_edge_slopes, valve_edge_overlaps;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"command_delay", "", 0, 0, "dead time of the command", optional}, p.command_delay...);
    v(Field{"valve_hysteresis", "", 0, 0, "play between command and spool", optional}, p.valve_hysteresis...);
    v(Field{"valve_stiction", "", 0, 0, "spool that sticks and jumps", optional}, p.valve_stiction...);
    v(Field{"valve_lag", "", 0, 0, "first-order lag of the spool", optional}, p.valve_lag...);
    v(Field{"valve_offset", "", 0, 0, "zero shift of the spool", optional}, p.valve_offset...);
    v(Field{"valve_dead_band", "", 0, 0, "overlap of the spool", optional}, p.valve_dead_band...);
    v(Field{"valve_neutral_leak", "", 0, 0, "leak of the spool at every position", optional}, p.valve_neutral_leak...);
    v(Field{"valve_asymmetry", "", 0, 0, "exhaust edges larger or smaller than supply edges", optional},
      p.valve_asymmetry...);
    v(Field{"valve_curve", "", 0, 0, "slope of the edges that changes along the spool's way", optional},
      p.valve_curve...);
    v(Field{"valve_linearity_forward", "", 0, 0, "edges beside a straight line where s > 0", optional},
      p.valve_linearity_forward...);
    v(Field{"valve_linearity_backward", "", 0, 0, "the same where s < 0", optional}, p.valve_linearity_backward...);
    v(Field{"valve_edge_slopes", "", 0, 0, "slope of each edge by itself", optional}, p.valve_edge_slopes...);
    v(Field{"valve_edge_overlaps", "", 0, 0, "overlap of each edge by itself, of valve_dead_band's", optional},
      p.valve_edge_overlaps...);
  }
};

/// The regulator feeds a volume at the valve through an orifice; area 0: the supply is constant.
template <class S> struct SupplyDroop {
  S area_m2 = S(0);
  S volume_m3 = S(1e-3);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"area_m2", "m2", 0, 1e-2, "orifice between regulator and valve"}, p.area_m2...);
    v(Field{"volume_m3", "m3", 1e-7, 10, "volume at the valve, at ambient temperature"}, p.volume_m3...);
  }
};

/// A supply whose pressure swings: a compressor that cuts in and out, a regulator that hunts.
template <class S> struct SupplySwing {
  S amplitude_Pa = S(0);
  S frequency_Hz = S(1);
  S phase_rad = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"amplitude_Pa", "Pa", 0, 1e6, "A of A sin(2 pi f t + phase), added to the supply's pressure"},
      p.amplitude_Pa...);
    v(Field{"frequency_Hz", "Hz", 0.01, 1000, "f"}, p.frequency_Hz...);
    v(Field{"phase_rad", "rad", -100, 100, "at the run's start", Presence::optional}, p.phase_rad...);
  }
};

/// Orifice between line end and chamber; area 0: none.
template <class S> struct LineRestriction {
  static constexpr bool is_inside_line = true;  ///< needs a line that is computed by cells
  S area_m2 = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"area_m2", "m2", 0, 1e-2, "effective area between line end and chamber"}, p.area_m2...);
  }
};
template <class S> struct LineLeak {
  static constexpr bool is_inside_line = true;
  S area_m2 = S(0);
  S position = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"area_m2", "m2", 0, 1e-2, "orifice from the line to atmosphere"}, p.area_m2...);
    v(Field{"position", "-", 0, 1, "0 valve end, 1 chamber end"}, p.position...);
  }
};
/// Dead-end branch, as a T-piece with the hose of a gauge or a pressure switch has: a volume behind a neck; volume 0:
/// none.
template <class S> struct LineBranch {
  static constexpr bool is_inside_line = true;
  S volume_m3 = S(0);
  S neck_length_m = S(0.1);
  S neck_diameter_m = S(0.004);
  S position = S(0.5);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"volume_m3", "m3", 0, 1, "volume behind the neck, without heat through its walls"}, p.volume_m3...);
    v(Field{"neck_length_m", "m", 1e-3, 10, "length of the neck between line and volume"}, p.neck_length_m...);
    v(Field{"neck_diameter_m", "m", 1e-4, 0.1, "inner diameter of the neck"}, p.neck_diameter_m...);
    v(Field{"position", "-", 0, 1, "0 valve end, 1 chamber end"}, p.position...);
  }
};
/// Volume at the valve's port, where its fittings and its sensor sit: a branch at the line's end behind the port's
/// bore; volume 0: none.
template <class S> struct PortVolume {
  static constexpr bool is_inside_line = true;
  S volume_m3 = S(0);
  /// Behind 10 mm of 6 mm bore: a port of G1/8, wide beside the 13 mm2 of the valves in config.
  LineBranch<S> as_branch() const noexcept { return {volume_m3, S(0.01), S(0.006), S(0)}; }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"volume_m3", "m3", 0, 1, "of fittings and bores between valve and line"}, p.volume_m3...);
  }
};
/// A hose that swells: its section grows with the pressure.
template <class S> struct LineCompliance {
  static constexpr bool is_inside_line = true;
  S section_growth_per_Pa = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"section_growth_per_Pa", "1/Pa", 0, 1e-4, "C of the section A (1 + C (p - p_0)), p_0 at the start"},
      p.section_growth_per_Pa...);
  }
};
/// Friction and wall heat of both lines beside the quasi-steady ones (wall_memory.hpp); share 0: none, 1: the theory of
/// laminar layers, with the Nusselt number 8 of slow changes in place of 3.66.
template <class S> struct FrequencyDependentLosses {
  S share = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"share", "-", 0, 3, "of the friction and wall heat that depend on frequency; 1: theory of laminar layers"},
      p.share...);
  }
};
template <class S> struct ChamberLeak {
  S area_m2 = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"area_m2", "m2", 0, 1e-2, "orifice from chamber to atmosphere"}, p.area_m2...);
  }
};
/// A relief valve, or a seal that lifts: from a pressure on, its area grows with what is beyond.
template <class S> struct ChamberRelief {
  S area_per_pressure_m2_per_Pa = S(0);
  S opening_Pa = S(1e6);
  S area_at(const S& pressure_Pa) const noexcept {
    return area_per_pressure_m2_per_Pa * maximum(pressure_Pa - opening_Pa, S(0));
  }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"area_per_pressure_m2_per_Pa", "m2/Pa", 0, 1e-6, "k of an orifice k (p - p_0) from chamber to atmosphere"},
      p.area_per_pressure_m2_per_Pa...);
    v(Field{"opening_Pa", "Pa", 1e3, 1e8, "p_0, absolute: closed below"}, p.opening_Pa...);
  }
};
/// What a diagnosis draws of a flow that has no name (docs/diagnose.md).
inline constexpr TableKeys leak_over_pressure_keys{
    {"pressure_1_Pa", "pressure_2_Pa", "pressure_3_Pa", "pressure_4_Pa", "pressure_5_Pa", "pressure_6_Pa",
     "pressure_7_Pa", "pressure_8_Pa"},
    {"area_1_m2", "area_2_m2", "area_3_m2", "area_4_m2", "area_5_m2", "area_6_m2", "area_7_m2", "area_8_m2"},
    {"", "Pa", 0, 1e8, "ascending, absolute, of the chamber"},
    {"", "m2", 0, 1e-2, "orifice from chamber to atmosphere there"}};
template <class S> struct LeakOverPressure : PointTable<S> {
  template <class V, class... P> static void visit(V&& v, P&... p) { leak_over_pressure_keys.visit(v, p...); }
};
/// A throttle with a check valve at the cylinder's port, or the cushion of an end: what leaves the chamber passes its
/// area, what enters passes freely. Area 0: none.
template <class S> struct FlowControl {
  static constexpr bool is_inside_line = true;
  S area_m2 = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"area_m2", "m2", 0, 1e-2, "effective area for what leaves the chamber"}, p.area_m2...);
  }
};
template <class S> struct EndCushion {
  static constexpr bool is_inside_line = true;
  S area_m2 = S(0);
  S length_m = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"area_m2", "m2", 0, 1e-2, "effective area for what leaves the chamber near its end stop"}, p.area_m2...);
    v(Field{"length_m", "m", 0, 10, "distance of the piston from that end stop within which it acts"}, p.length_m...);
  }
};
template <class S> struct PistonLeak {
  S area_m2 = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"area_m2", "m2", 0, 1e-2, "orifice between the chambers"}, p.area_m2...);
  }
};
/// A leak past the piston that depends on where it stands: a worn or scored place of the bore.
template <class S> struct PistonLeakZone {
  S area_m2 = S(0);
  S center_m = S(0);
  S width_m = S(0.01);
  /// With the piston at x.
  S area_at(const S& x_m) const noexcept {
    const S offset = (x_m - center_m) / width_m;
    return area_m2 * exponential(-offset * offset);
  }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"area_m2", "m2", 0, 1e-2, "S of an orifice S exp(-((x - c)/w)^2) between the chambers"}, p.area_m2...);
    v(Field{"center_m", "m", -10, 10, "c: place of the wear"}, p.center_m...);
    v(Field{"width_m", "m", 1e-5, 10, "w"}, p.width_m...);
  }
};
template <class S> struct SensorOffset {
  S offset = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"offset", "SI", -1e7, 1e7, "added to the reading, in the channel's unit"}, p.offset...);
  }
};
template <class S> struct SensorGain {
  S gain = S(1);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"gain", "-", -100, 100, "factor on the reading"}, p.gain...);
  }
};
template <class S> struct SensorLag {
  S time_constant_s = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"time_constant_s", "s", 0, 10, "first-order lag of the sensor"}, p.time_constant_s...);
  }
};

/// What one sensor channel does to its signal beside noise and quantum: lag first, then gain, then offset.
template <class S> struct SensorEffects {
  SensorLag<S> sensor_lag;
  SensorGain<S> sensor_gain;
  SensorOffset<S> sensor_offset;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"sensor_lag", "", 0, 0, "first-order lag", optional}, p.sensor_lag...);
    v(Field{"sensor_gain", "", 0, 0, "wrong gain", optional}, p.sensor_gain...);
    v(Field{"sensor_offset", "", 0, 0, "wrong zero", optional}, p.sensor_offset...);
  }
};

/// All pneumatic and mechanical effects of one axis.
template <class S> struct AxisEffects {
  MotionEffects<S> motion;
  ValveEffects<S> valve;
  SupplyDroop<S> supply_droop;
  SupplySwing<S> supply_swing;
  LineRestriction<S> line_restriction_1, line_restriction_2;
  LineLeak<S> line_leak_1, line_leak_2;
  LineBranch<S> line_branch_1, line_branch_2;
  PortVolume<S> port_volume_1, port_volume_2;
  LineCompliance<S> line_compliance_1, line_compliance_2;
  FrequencyDependentLosses<S> frequency_dependent_losses;
  FlowControl<S> flow_control_1, flow_control_2;
  EndCushion<S> end_cushion_1, end_cushion_2;
  ChamberLeak<S> chamber_leak_1, chamber_leak_2;
  ChamberRelief<S> chamber_relief_1, chamber_relief_2;
  PistonLeak<S> piston_leak;
  PistonLeakZone<S> piston_leak_zone;
  LeakOverPressure<S> leak_over_pressure_1, leak_over_pressure_2;
  /// Those of an axis without pneumatics.
  template <class V, class... P> static void visit_without_air(V&& v, P&... p) {
    MotionEffects<S>::visit_without_air(v, p.motion...);
  }
  /// Those of a cylinder with an on/off valve, of which positions alone are compared: what swings on its slider would
  /// look like any other fault.
  template <class V, class... P> static void visit_switched(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    MotionEffects<S>::visit_rigid(v, p.motion...);
    MotionEffects<S>::visit_seals(v, p.motion...);
    v(Field{"command_delay", "", 0, 0, "dead time of the command", optional}, p.valve.command_delay...);
    v(Field{"chamber_leak_1", "", 0, 0, "leak of chamber 1 to atmosphere", optional}, p.chamber_leak_1...);
    v(Field{"chamber_leak_2", "", 0, 0, "leak of chamber 2 to atmosphere", optional}, p.chamber_leak_2...);
    v(Field{"piston_leak", "", 0, 0, "leak between the chambers", optional}, p.piston_leak...);
  }
  /// Those of a valve, a hose and a volume: side 1 alone. Its supply does not droop: side 2 would draw from it, too.
  template <class V, class... P> static void visit_of_one_side(V&& v, P&... p) {
    ValveEffects<S>::visit(v, p.valve...);
    visit_pneumatics(
        [&](const Field& field, auto&... effect) {
          for (const std::string_view name : {"supply_swing", "line_restriction_1", "line_leak_1", "line_branch_1",
                                              "frequency_dependent_losses", "chamber_leak_1"})
            if (field.key == name) v(field, effect...);
        },
        p...);
  }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    MotionEffects<S>::visit(v, p.motion...);
    ValveEffects<S>::visit(v, p.valve...);
    visit_pneumatics(v, p...);
  }

 private:
  /// Of supply, lines, chambers and piston.
  template <class V, class... P> static void visit_pneumatics(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"supply_droop", "", 0, 0, "supply pressure that falls with flow", optional}, p.supply_droop...);
    v(Field{"supply_swing", "", 0, 0, "supply pressure that swings", optional}, p.supply_swing...);
    v(Field{"line_restriction_1", "", 0, 0, "fitting between line 1 and chamber 1", optional}, p.line_restriction_1...);
    v(Field{"line_restriction_2", "", 0, 0, "fitting between line 2 and chamber 2", optional}, p.line_restriction_2...);
    v(Field{"line_leak_1", "", 0, 0, "leak of line 1 to atmosphere", optional}, p.line_leak_1...);
    v(Field{"line_leak_2", "", 0, 0, "leak of line 2 to atmosphere", optional}, p.line_leak_2...);
    v(Field{"line_branch_1", "", 0, 0, "dead-end branch of line 1", optional}, p.line_branch_1...);
    v(Field{"line_branch_2", "", 0, 0, "dead-end branch of line 2", optional}, p.line_branch_2...);
    v(Field{"port_volume_1", "", 0, 0, "volume at the valve's port 1", optional}, p.port_volume_1...);
    v(Field{"port_volume_2", "", 0, 0, "volume at the valve's port 2", optional}, p.port_volume_2...);
    v(Field{"line_compliance_1", "", 0, 0, "hose 1 that swells", optional}, p.line_compliance_1...);
    v(Field{"line_compliance_2", "", 0, 0, "hose 2 that swells", optional}, p.line_compliance_2...);
    v(Field{"frequency_dependent_losses", "", 0, 0, "friction and wall heat of both lines that depend on frequency",
            optional},
      p.frequency_dependent_losses...);
    v(Field{"chamber_leak_1", "", 0, 0, "leak of chamber 1 to atmosphere", optional}, p.chamber_leak_1...);
    v(Field{"chamber_leak_2", "", 0, 0, "leak of chamber 2 to atmosphere", optional}, p.chamber_leak_2...);
    v(Field{"piston_leak", "", 0, 0, "leak between the chambers", optional}, p.piston_leak...);
    v(Field{"flow_control_1", "", 0, 0, "throttle with check valve at port 1 of the cylinder", optional},
      p.flow_control_1...);
    v(Field{"flow_control_2", "", 0, 0, "throttle with check valve at port 2 of the cylinder", optional},
      p.flow_control_2...);
    v(Field{"end_cushion_1", "", 0, 0, "cushion of the end at chamber 1", optional}, p.end_cushion_1...);
    v(Field{"end_cushion_2", "", 0, 0, "cushion of the end at chamber 2", optional}, p.end_cushion_2...);
    v(Field{"chamber_relief_1", "", 0, 0, "relief valve of chamber 1", optional}, p.chamber_relief_1...);
    v(Field{"chamber_relief_2", "", 0, 0, "relief valve of chamber 2", optional}, p.chamber_relief_2...);
    v(Field{"piston_leak_zone", "", 0, 0, "leak between the chambers about one place", optional},
      p.piston_leak_zone...);
    v(Field{"leak_over_pressure_1", "", 0, 0, "leak of chamber 1 by a table over its pressure", optional},
      p.leak_over_pressure_1...);
    v(Field{"leak_over_pressure_2", "", 0, 0, "leak of chamber 2 by a table over its pressure", optional},
      p.leak_over_pressure_2...);
  }
};

}  // namespace pneuservo
