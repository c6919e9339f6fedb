// Effects of the slider: frictions, loads and couplings beside the nominal model (docs/physics/effects.md); their
// equations stand in slider.hpp.
#pragma once
#include <pneuservo/core/field.hpp>
#include <pneuservo/core/scalar.hpp>
#include <pneuservo/elements/point_table.hpp>

namespace pneuservo {

template <class S> struct CoulombFriction {
  S force_N = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"force_N", "N", 0, 1e5, "opposes motion; holds a slider at rest up to it"}, p.force_N...);
  }
};
template <class S> struct StribeckFriction {
  S extra_force_N = S(0);
  S velocity_mps = S(0.02);
  S coulomb_force_N = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"extra_force_N", "N", 0, 1e5, "F_e of F_c + F_e exp(-(v/v_s)^2)"}, p.extra_force_N...);
    v(Field{"velocity_mps", "m/s", 1e-5, 10, "v_s"}, p.velocity_mps...);
    v(Field{"coulomb_force_N", "N", 0, 1e5, "F_c", Presence::optional}, p.coulomb_force_N...);
  }
};
template <class S> struct DirectionDependentFriction {
  S forward_N = S(0);
  S backward_N = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"forward_N", "N", 0, 1e5, "Coulomb force for v > 0"}, p.forward_N...);
    v(Field{"backward_N", "N", 0, 1e5, "Coulomb force for v < 0"}, p.backward_N...);
  }
};
template <class S> struct PressureDependentFriction {
  S force_per_pressure_N_per_Pa = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"force_per_pressure_N_per_Pa", "N/Pa", 0, 1, "c of c (max(p1 - p_atm, 0) + max(p2 - p_atm, 0))/2"},
      p.force_per_pressure_N_per_Pa...);
  }
};
template <class S> struct FrictionZone {
  S force_N = S(0);
  S center_m = S(0);
  S width_m = S(0.01);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"force_N", "N", 0, 1e5, "Coulomb force F exp(-((x - c)/w)^2)"}, p.force_N...);
    v(Field{"center_m", "m", -10, 10, "c: place of the tight spot"}, p.center_m...);
    v(Field{"width_m", "m", 1e-5, 10, "w"}, p.width_m...);
  }
};
template <class S> struct QuadraticDrag {
  S coefficient_Ns2_per_m2 = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"coefficient_Ns2_per_m2", "N s2/m2", 0, 1e5, "c of c |v| v"}, p.coefficient_Ns2_per_m2...);
  }
};
template <class S> struct DirectionDependentViscousFriction {
  S forward_Ns_per_m = S(0);
  S backward_Ns_per_m = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"forward_Ns_per_m", "N s/m", -1e5, 1e5, "beside viscous_friction for v > 0"}, p.forward_Ns_per_m...);
    v(Field{"backward_Ns_per_m", "N s/m", -1e5, 1e5, "beside viscous_friction for v < 0"}, p.backward_Ns_per_m...);
  }
};
/// Beside slider.viscous_friction_Ns_per_m, for a config that has none: where the owner states that with a tolerance,
/// it is the number that may be off.
template <class S> struct ViscousFriction {
  S coefficient_Ns_per_m = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"coefficient_Ns_per_m", "N s/m", 0, 1e6, "beside viscous_friction, the same both ways"},
      p.coefficient_Ns_per_m...);
  }
};
/// Dry friction that the slider's way builds up: bristles, a seal or a belt that is dragged along where the motion
/// turns.
template <class S> struct ElasticFriction {
  S force_N = S(0);
  S way_m = S(1e-3);
  /// F after the way dx: dF/dx = (F_c - F sign(dx))/w.
  S carried(const S& force, const S& dx) const noexcept {
    const S end = select(dx < S(0), -force_N, force_N);
    return end + (force - end) * exponential(-absolute(dx) / way_m);
  }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"force_N", "N", 0, 1e5, "F_c: where a long way one way ends"}, p.force_N...);
    v(Field{"way_m", "m", 1e-7, 10, "w of dF/dx = (F_c - F sign(v))/w"}, p.way_m...);
  }
};
/// The way over which dry friction builds up where the motion turns: a seal is sheared before it slides.
template <class S> struct Presliding {
  S way_m = S(0);
  /// Share of the dry friction that acts after the way dx: ds/dx = (1 - s sign(dx))/w.
  S carried(const S& share, const S& dx) const noexcept {
    return ElasticFriction<S>{S(1), no_division_by_zero()}.carried(share, dx);
  }
  /// ds/dx [1/m].
  S stiffness(const S& share, const S& direction) const noexcept {
    return (S(1) - direction * share) / no_division_by_zero();
  }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"way_m", "m", 0, 0.01, "w of ds/dx = (1 - s sign(v))/w: dry friction is s F"}, p.way_m...);
  }

 private:
  S no_division_by_zero() const noexcept { return maximum(way_m, S(1e-12)); }
};
/// Weight on a lever that turns with the axis: x is its angle [rad], forces are torques.
template <class S> struct GravityLoad {
  S sine_N = S(0);
  S cosine_N = S(0);
  S at(const S& angle) const noexcept { return sine_N * sine(angle) + cosine_N * cosine(angle); }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"sine_N", "N", -1e5, 1e5, "a of a sin(x) + b cos(x), x in rad; subtracted from the driving force"},
      p.sine_N...);
    v(Field{"cosine_N", "N", -1e5, 1e5, "b", Presence::optional}, p.cosine_N...);
  }
};
template <class S> struct ConstantForce {
  S force_N = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"force_N", "N", -1e5, 1e5, "subtracted from the driving force: incline, weight, cable"}, p.force_N...);
  }
};
template <class S> struct SpringLoad {
  S stiffness_N_per_m = S(0);
  S rest_m = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"stiffness_N_per_m", "N/m", -1e6, 1e6, "k of k (x - x_0), subtracted from the driving force"},
      p.stiffness_N_per_m...);
    v(Field{"rest_m", "m", -10, 10, "x_0", Presence::optional}, p.rest_m...);
  }
};

/// A part that the slider takes up at rest or at its own speed, or puts down.
template <class S> struct PayloadChange {
  S mass_kg = S(0);
  S weight_N = S(0);
  S time_s = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"mass_kg", "kg", -1e4, 1e4, "beside mass_kg + payload_kg of the slider from then on; negative: put down"},
      p.mass_kg...);
    v(Field{"weight_N", "N", -1e5, 1e5, "its weight along the axis, subtracted from the driving force",
            Presence::optional},
      p.weight_N...);
    v(Field{"time_s", "s", 0, 1e6, "from the run's start"}, p.time_s...);
  }
};

/// A part of slider.mass_kg + slider.payload_kg that is carried on a soft coupling: a load on a long arm, a belt, a
/// bellows.
template <class S> struct ElasticLoad {
  S mass_kg = S(0);
  S natural_frequency_Hz = S(10);
  S damping_ratio = S(0.05);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"mass_kg", "kg", 0, 1e4, "of the moving mass, on a spring; below mass_kg + payload_kg of the slider"},
      p.mass_kg...);
    v(Field{"natural_frequency_Hz", "Hz", 0.1, 500, "of that mass where the slider stands still: sqrt(k/m)/(2 pi)"},
      p.natural_frequency_Hz...);
    v(Field{"damping_ratio", "-", 0, 10, "of that mass where the slider stands still"}, p.damping_ratio...);
  }
};
/// A part of slider.mass_kg + slider.payload_kg that is coupled with play: a worn pin, a loose nut. It flies from one
/// end of the play to the other, and strikes there.
template <class S> struct LoadBacklash {
  S mass_kg = S(0);
  S play_m = S(1e-3);
  S contact_frequency_Hz = S(60);
  S contact_damping_ratio = S(0.1);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"mass_kg", "kg", 0, 1e4, "of the moving mass, loose; below mass_kg + payload_kg of the slider"},
      p.mass_kg...);
    v(Field{"play_m", "m", 1e-6, 1, "from end to end"}, p.play_m...);
    v(Field{"contact_frequency_Hz", "Hz", 1, 500, "of that mass on what it strikes"}, p.contact_frequency_Hz...);
    v(Field{"contact_damping_ratio", "-", 0, 10, "of that mass on what it strikes"}, p.contact_damping_ratio...);
  }
};
/// A force of one frequency, from a neighbouring machine or a fan.
template <class S> struct PeriodicForce {
  S amplitude_N = S(0);
  S frequency_Hz = S(10);
  S phase_rad = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"amplitude_N", "N", 0, 1e5, "A of A sin(2 pi f t + phase), added to the driving force"}, p.amplitude_N...);
    v(Field{"frequency_Hz", "Hz", 0.01, 1000, "f"}, p.frequency_Hz...);
    v(Field{"phase_rad", "rad", -100, 100, "at the run's start", Presence::optional}, p.phase_rad...);
  }
};

// What a diagnosis draws of a force that has no name (docs/diagnose.md).
inline constexpr TableKeys force_over_position_keys{
    {"position_1_m", "position_2_m", "position_3_m", "position_4_m", "position_5_m", "position_6_m", "position_7_m",
     "position_8_m"},
    {"force_1_N", "force_2_N", "force_3_N", "force_4_N", "force_5_N", "force_6_N", "force_7_N", "force_8_N"},
    {"", "m", -10, 10, "ascending"},
    {"", "N", -1e5, 1e5, "there, subtracted from the driving force"}};
inline constexpr TableKeys friction_over_speed_keys{
    {"speed_1_mps", "speed_2_mps", "speed_3_mps", "speed_4_mps", "speed_5_mps", "speed_6_mps", "speed_7_mps",
     "speed_8_mps"},
    force_over_position_keys.values,
    {"", "m/s", 0, 100, "ascending, both ways alike"},
    {"", "N", -1e5, 1e5, "against the motion there, beside all other dry friction; together not below zero"}};
inline constexpr TableKeys force_over_time_keys{
    {"time_1_s", "time_2_s", "time_3_s", "time_4_s", "time_5_s", "time_6_s", "time_7_s", "time_8_s"},
    force_over_position_keys.values,
    {"", "s", 0, 1e6, "ascending, from the run's start"},
    force_over_position_keys.value};
template <class S> struct ForceOverPosition : PointTable<S> {
  template <class V, class... P> static void visit(V&& v, P&... p) { force_over_position_keys.visit(v, p...); }
};
template <class S> struct FrictionOverSpeed : PointTable<S> {
  template <class V, class... P> static void visit(V&& v, P&... p) { friction_over_speed_keys.visit(v, p...); }
};
template <class S> struct ForceOverTime : PointTable<S> {
  template <class V, class... P> static void visit(V&& v, P&... p) { force_over_time_keys.visit(v, p...); }
};

/// Everything that acts on the slider beside B v.
template <class S> struct MotionEffects {
  CoulombFriction<S> coulomb_friction;
  StribeckFriction<S> stribeck_friction;
  DirectionDependentFriction<S> direction_dependent_friction;
  PressureDependentFriction<S> pressure_dependent_friction;
  FrictionZone<S> friction_zone;
  QuadraticDrag<S> quadratic_drag;
  DirectionDependentViscousFriction<S> direction_dependent_viscous_friction;
  ViscousFriction<S> viscous_friction;
  ElasticFriction<S> elastic_friction;
  Presliding<S> presliding;
  GravityLoad<S> gravity_load;
  ConstantForce<S> constant_force;
  SpringLoad<S> spring_load;
  PayloadChange<S> payload_change;
  ElasticLoad<S> elastic_load;
  LoadBacklash<S> load_backlash;
  PeriodicForce<S> periodic_force;
  ForceOverPosition<S> force_over_position;
  FrictionOverSpeed<S> friction_over_speed;
  ForceOverTime<S> force_over_time;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    visit_without_air(v, p...);
    visit_seals(v, p...);
    v(Field{"payload_change", "", 0, 0, "payload that is taken up or put down", Presence::optional},
      p.payload_change...);
    v(Field{"periodic_force", "", 0, 0, "force of one frequency", Presence::optional}, p.periodic_force...);
  }
  /// Those of an axis that is recorded and not run, without pressures.
  template <class V, class... P> static void visit_without_air(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    visit_rigid(v, p...);
    v(Field{"elastic_friction", "", 0, 0, "dry friction that the way builds up", optional}, p.elastic_friction...);
    v(Field{"presliding", "", 0, 0, "all other dry friction builds up along a way", optional}, p.presliding...);
    v(Field{"gravity_load", "", 0, 0, "weight on a lever that turns with the axis", optional}, p.gravity_load...);
    v(Field{"elastic_load", "", 0, 0, "load on a soft coupling", optional}, p.elastic_load...);
    v(Field{"load_backlash", "", 0, 0, "load coupled with play", optional}, p.load_backlash...);
    v(Field{"force_over_position", "", 0, 0, "load by a table over position", optional}, p.force_over_position...);
    v(Field{"friction_over_speed", "", 0, 0, "dry friction by a table over speed", optional}, p.friction_over_speed...);
    v(Field{"force_over_time", "", 0, 0, "load by a table over time", optional}, p.force_over_time...);
  }
  template <class V, class... P> static void visit_seals(V&& v, P&... p) {
    v(Field{"pressure_dependent_friction", "", 0, 0, "seal friction that grows with pressure", Presence::optional},
      p.pressure_dependent_friction...);
  }
  /// Those of a slider all of one piece.
  template <class V, class... P> static void visit_rigid(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"coulomb_friction", "", 0, 0, "dry friction", optional}, p.coulomb_friction...);
    v(Field{"stribeck_friction", "", 0, 0, "friction that falls with speed", optional}, p.stribeck_friction...);
    v(Field{"direction_dependent_friction", "", 0, 0, "dry friction that differs by direction", optional},
      p.direction_dependent_friction...);
    v(Field{"friction_zone", "", 0, 0, "a tight spot of the guide", optional}, p.friction_zone...);
    v(Field{"quadratic_drag", "", 0, 0, "drag c |v| v", optional}, p.quadratic_drag...);
    v(Field{"direction_dependent_viscous_friction", "", 0, 0, "viscous friction that differs by direction", optional},
      p.direction_dependent_viscous_friction...);
    v(Field{"viscous_friction", "", 0, 0, "viscous friction, the same both ways", optional}, p.viscous_friction...);
    v(Field{"constant_force", "", 0, 0, "constant load", optional}, p.constant_force...);
    v(Field{"spring_load", "", 0, 0, "spring between slider and frame", optional}, p.spring_load...);
  }
};

}  // namespace pneuservo
