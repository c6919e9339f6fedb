// Distributed pipeline on a staggered grid: pressure and density in cells, velocity on faces (thesis 3.2 to 3.4, Fig. 3.3).
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <pneuservo/core/scalar.hpp>
#include <pneuservo/elements/effects.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/pipe_friction.hpp>
#include <pneuservo/elements/valve_port.hpp>

namespace pneuservo {

/// What a step of the line hands to its ends. Flow is positive from valve to chamber.
template <class S> struct LineFlow {
  S port_mass_flow_kgps{};
  S chamber_mass_flow_kgps{};
  S chamber_enthalpy_flow_W{};  ///< stagnation enthalpy into the chamber
};

/// The chamber as the line sees it.
template <class S> struct ChamberEnd {
  S pressure_Pa;
  S temperature_K;
};

/// Physics of the line beside the nominal model; neutral by default. Orifices use the valve's critical ratio.
template <class S> struct LineEffects {
  LineRestriction<S> restriction;
  LineLeak<S> leak;
  S critical_pressure_ratio = S(0.35);
};

/// One pipeline, `cells` cells of equal length, explicit in time (leapfrog: pressures at t, velocities at t - h/2),
/// friction and wall heat implicit, pressure flux centred, temperature upwind: docs/physics/line.md has the scheme.
/// S may carry several lines in lanes (both sides of an axis, several rigs).
/// Guards keep every state physical: |u| <= c of the gas that moves, density >= 1e-3 kg/m3, 150 K <= T <= 600 K; what
/// they did is counted. Mass is conserved to rounding, guards included (the density floor excepted).
template <class S> class Line {
 public:
  /// Allocates; cells >= 1.
  void configure(const LineParameters<S>& line, const AirParameters<S>& air_parameters, int cells) {
    air_ = Air<S>(air_parameters);
    length_ = line.length_m;
    diameter_ = line.diameter_m;
    cross_section_ = S(0.78539816339744831) * diameter_ * diameter_;
    friction_ = PipeFriction<S>(line, air_);
    cell_.assign(static_cast<std::size_t>(std::max(1, cells)), Cell{});
    velocity_.assign(cell_.size() + 1, S(0));
    guard_actions_ = 0;
    set_effects(LineEffects<S>{});
    set_time_step(1e-3);
    reset(air_.atmosphere_Pa, air_.temperature_K);
  }

  /// Switches physics beside the nominal model on or off.
  void set_effects(const LineEffects<S>& effects) noexcept {
    effects_ = effects;
    restricted_ = any(effects.restriction.area_m2 > S(0));
    leaking_ = any(effects.leak.area_m2 > S(0));
  }
  /// Wall heat off: an adiabatic line, for tests against closed forms.
  void set_adiabatic(bool adiabatic) noexcept {
    adiabatic_ = adiabatic;
    set_time_step(step_s_);
  }
  /// Wall heat without bound: the gas keeps the wall's temperature, for tests against closed forms.
  void set_isothermal(bool isothermal) noexcept {
    isothermal_ = isothermal;
    set_time_step(step_s_);
  }
  /// Friction off (its heat as well), for tests against closed forms.
  void set_frictionless(bool frictionless) noexcept {
    frictionless_ = frictionless;
    set_time_step(step_s_);
  }

  /// Gas at rest at one pressure and temperature.
  void reset(const S& pressure_Pa, const S& temperature_K) noexcept {
    for (int i = 0; i < cells(); ++i) set_cell_state(i, pressure_Pa, temperature_K);
    for (auto& u : velocity_) u = S(0);
    port_pressure_ = pressure_Pa;
    port_flux_ = chamber_flux_ = S(0);
    fastest_squared_ = S(0);
  }
  /// Sets the state of cell i = 0..cells-1, e.g. to a mode shape.
  void set_cell_state(int i, const S& pressure_Pa, const S& temperature_K) noexcept {
    const S density_per_pressure = S(1) / (air_.R * temperature_K);
    cell_[static_cast<std::size_t>(i)] = {pressure_Pa, pressure_Pa * density_per_pressure, temperature_K, density_per_pressure};
  }
  /// Sets the velocity on face j = 0..cells at t - h/2.
  void set_face_velocity(int j, const S& velocity_mps) noexcept { velocity_[static_cast<std::size_t>(j)] = velocity_mps; }

  /// Sub-step h [s] of all following steps.
  void set_time_step(double step_s) noexcept {
    step_s_ = step_s;
    const S h(step_s), diameter_squared = diameter_ * diameter_;
    k_.grid_ratio = h / cell_length();
    k_.reynolds_factor = diameter_ / air_.viscosity_Pas;
    k_.friction_factor = frictionless_ ? S(0) : h * air_.viscosity_Pas / (S(2) * diameter_squared);
    k_.heat_factor = adiabatic_ ? S(0) : S(isothermal_ ? 2e12 : 2.0) * h / diameter_squared;
    k_.compression_factor = S(0.5) * (air_.kappa - S(1)) * k_.grid_ratio;
    k_.kappa_minus_one = air_.kappa - S(1);
    k_.cv = air_.cv;
    k_.inverse_R = S(1) / air_.R;
    k_.wall_pressure_factor = air_.R * air_.temperature_K;
    k_.sound_factor = air_.kappa * air_.R;
    k_.friction = friction_;
  }
  /// Largest speed on any face in the last sub-step [m/s], over all lanes.
  double largest_speed() const noexcept { return std::sqrt(largest(fastest_squared_)); }

  /// One sub-step with the port pressure prescribed (middle of the sub-step): the estimator's boundary.
  /// Gas that enters at the port has the stagnation temperature of the supply.
  LineFlow<S> step_prescribed(const S& port_pressure_Pa, const ChamberEnd<S>& chamber) noexcept {
    port_pressure_ = port_pressure_Pa;
    return sweep(chamber, [this](Face& face, const Cell& first, const S&) noexcept { prescribed_port_flux(face, first); });
  }

  /// One sub-step with a valve at the port: the port pressure follows from orifice and line together. The orifice's own
  /// flow is booked, so that valve and line agree in mass to rounding.
  LineFlow<S> step_valve(const ValvePort<S>& valve, const ChamberEnd<S>& chamber) noexcept {
    return sweep(chamber, [&](Face& face, const Cell& first, const S& density) noexcept { valve_port_flux(valve, face, first, density); });
  }

  int cells() const noexcept { return static_cast<int>(cell_.size()); }
  S cell_length() const noexcept { return length_ / S(cells()); }
  S cross_section() const noexcept { return cross_section_; }
  S volume() const noexcept { return cross_section_ * length_; }
  const Air<S>& air() const noexcept { return air_; }
  S cell_pressure(int i) const noexcept { return cell_[static_cast<std::size_t>(i)].pressure; }
  S cell_density(int i) const noexcept { return cell_[static_cast<std::size_t>(i)].density; }
  S cell_temperature(int i) const noexcept { return cell_[static_cast<std::size_t>(i)].temperature; }
  S face_velocity(int j) const noexcept { return velocity_[static_cast<std::size_t>(j)]; }
  /// Pressure at the valve port, of the last sub-step.
  S port_pressure() const noexcept { return port_pressure_; }
  /// Mass of the gas in the line [kg].
  S mass() const noexcept {
    S sum(0);
    for (const Cell& c : cell_) sum += c.density;
    return sum * cross_section_ * cell_length();
  }
  /// Internal energy of the gas in the line [J] (its kinetic energy not included).
  S internal_energy() const noexcept {
    S sum(0);
    for (const Cell& c : cell_) sum += c.pressure;
    return sum * cross_section_ * cell_length() / (air_.kappa - S(1));
  }
  /// Times a guard has acted since configure, over all lanes.
  std::int64_t guard_actions() const noexcept { return guard_actions_; }
  /// Mass flow lost through the leak in the last sub-step [kg/s].
  S leak_mass_flow() const noexcept { return leak_flow_; }

 private:
  struct Cell {
    S pressure{}, density{}, temperature{}, density_per_pressure{};  // the last is 1/(R T)
  };
  /// A face after its momentum step, with what it carries: m [kg/(m2 s)], z = p u (z/(kappa-1) is internal energy).
  struct Face {
    S velocity, mass_flux, pressure_flux, friction_coefficient, nusselt;
  };
  struct Constants {
    S grid_ratio, reynolds_factor, friction_factor, heat_factor, compression_factor, kappa_minus_one, cv, inverse_R;
    S wall_pressure_factor, sound_factor;
    PipeFriction<S> friction;
  };

  // One pass over the line, everything updated in place. The stages of neighbours overlap: while face f takes its momentum
  // step, the friction of face f+1 and the balance of cell f-2 are under way, so that the processor never waits for the
  // chain friction -> velocity -> flux -> cell of a single place.
  template <class PortFlux> LineFlow<S> sweep(const ChamberEnd<S>& chamber, PortFlux&& port_flux) noexcept {
    const Constants k = k_;  // local: a store into a field must not make the compiler reload them
    Cell* const cell = cell_.data();
    S* const velocity = velocity_.data();
    const int n = cells();
    leak_flow_ = S(0);
    const S old_end = velocity[n];
    S u_before = velocity[0];
    Face behind = port_face(k, cell[0], velocity[0], velocity[1], port_flux);
    velocity[0] = behind.velocity;
    S fastest = behind.velocity * behind.velocity;
    Face face = behind;
    if (n > 1) {
      Friction friction = friction_of(k, cell[0], cell[1], velocity[1]);
      for (int f = 1; f < n; ++f) {
        const S u = velocity[f];
        Friction next{};
        if (f + 1 < n) next = friction_of(k, cell[f], cell[f + 1], velocity[f + 1]);
        const Face made = inner_face(k, friction, cell[f - 1], cell[f], u_before, u, velocity[f + 1]);
        if (f > 1) advance_cell(k, cell[f - 2], behind, face, f - 2);
        velocity[f] = made.velocity;
        fastest = maximum(fastest, made.velocity * made.velocity);
        u_before = u;
        if (f > 1) behind = face;
        face = made;
        friction = next;
      }
    }
    Face end = chamber_face(k, cell[n - 1], u_before, old_end, chamber);
    velocity[n] = end.velocity;
    fastest_squared_ = maximum(fastest, end.velocity * end.velocity);
    const S enthalpy_flux = chamber_end_flux(end, cell[n - 1], chamber);
    chamber_flux_ = end.mass_flux;
    if (n > 1) advance_cell(k, cell[n - 2], behind, face, n - 2);
    advance_cell(k, cell[n - 1], face, end, n - 1);
    return {cross_section_ * port_flux_, cross_section_ * chamber_flux_, cross_section_ * enthalpy_flux};
  }

  struct Friction {
    S density, coefficient, nusselt;
  };
  static Friction friction_at(const Constants& k, const S& rho, const S& u) noexcept {
    const PipeFrictionValue<S> value = k.friction(rho * absolute(u) * k.reynolds_factor);
    return {rho, k.friction_factor * value.lambda_reynolds, value.nusselt};
  }
  static Friction friction_of(const Constants& k, const Cell& a, const Cell& b, const S& u) noexcept {
    return friction_at(k, S(0.5) * (a.density + b.density), u);
  }

  // Momentum: u' = (rho (u - a u du) - a dp) / (rho + f), a = h/dx, du upwind, friction implicit.
  static Face momentum(const Constants& k, const Friction& friction, const S& u, const S& du, const S& dp) noexcept {
    Face face;
    face.friction_coefficient = friction.coefficient;
    face.nusselt = friction.nusselt;
    face.velocity = (friction.density * (u - k.grid_ratio * (u * du)) - k.grid_ratio * dp) / (friction.density + friction.coefficient);
    return face;
  }

  Face inner_face(const Constants& k, const Friction& friction, const Cell& a, const Cell& b, const S& u_before, const S& u, const S& u_after) noexcept {
    Face face = momentum(k, friction, u, select(u > S(0), u - u_before, u_after - u), b.pressure - a.pressure);
    limit_speed(k, face, a.temperature, b.temperature);
    const auto forward = face.velocity > S(0);
    const S p_up = select(forward, a.pressure, b.pressure);
    const S s_up = select(forward, a.density_per_pressure, b.density_per_pressure);
    face.pressure_flux = limited_face_pressure(S(0.5) * (a.pressure + b.pressure), p_up) * face.velocity;
    face.mass_flux = s_up * face.pressure_flux;
    return face;
  }

  // The end faces are half a cell from the first and last pressures: twice the gradient; density of the gas that moves.
  template <class PortFlux> Face port_face(const Constants& k, const Cell& first, const S& u, const S& u_after, PortFlux&& port_flux) noexcept {
    const S rho = select(u > S(0), port_pressure_ / k.wall_pressure_factor, first.density);
    Face face = momentum(k, friction_at(k, rho, u), u, select(u > S(0), S(0), u_after - u), S(2) * (first.pressure - port_pressure_));
    port_flux(face, first, rho);
    port_flux_ = face.mass_flux;
    return face;
  }
  Face chamber_face(const Constants& k, const Cell& last, const S& u_before, const S& u, const ChamberEnd<S>& chamber) noexcept {
    const S rho = select(u < S(0), face_pressure_at_chamber(last, chamber) / (air_.R * chamber.temperature_K), last.density);
    Face face = momentum(k, friction_at(k, rho, u), u, select(u > S(0), u - u_before, S(0)), S(2) * (chamber.pressure_Pa - last.pressure));
    if (restricted_) apply_restriction(face, last, u, rho, chamber);
    limit_speed(k, face, last.temperature, chamber.temperature_K);
    return face;
  }

  // Face pressure centred, but within 10 % of the upwind cell's: a shock must not carry energy the cell does not have.
  static S limited_face_pressure(const S& centred, const S& upwind) noexcept {
    const S band = S(0.1) * upwind;
    return upwind + clamp(centred - upwind, -band, band);
  }

  // |u| <= sound speed of the gas that moves: chokes the ends and tames a jump of a prescribed port pressure.
  void limit_speed(const Constants& k, Face& face, const S& T_left, const S& T_right) noexcept {
    const S limit = k.sound_factor * select(face.velocity > S(0), T_left, T_right);
    if (all(face.velocity * face.velocity <= limit)) [[likely]] return;
    const S sound = square_root(limit);
    const auto bad = !(absolute(face.velocity) <= sound);
    guard_actions_ += count(bad);
    face.velocity = select(face.velocity == face.velocity, clamp(face.velocity, -sound, sound), S(0));
  }

  // Gas that enters has the static temperature T_stagnation - u^2/(2 c_p).
  S inflow_density_per_pressure(const S& stagnation_K, const S& u) const noexcept {
    return S(1) / (air_.R * (stagnation_K - u * u / (S(2) * air_.cp)));
  }

  void prescribed_port_flux(Face& face, const Cell& first) noexcept {
    limit_speed(k_, face, air_.temperature_K, first.temperature);
    const S u = face.velocity;
    const auto enters = u > S(0);
    face.pressure_flux = select(enters, port_pressure_, limited_face_pressure(port_pressure_, first.pressure)) * u;
    face.mass_flux = face.pressure_flux * select(enters, inflow_density_per_pressure(air_.temperature_K, u), first.density_per_pressure);
  }

  // u = u* + K p and A rho_b(p) u = G_supply(p) - G_exhaust(p); the momentum step was taken with the last port pressure.
  void valve_port_flux(const ValvePort<S>& valve, Face& face, const Cell& first, const S& density) noexcept {
    const S K = S(2) * k_.grid_ratio / (density + face.friction_coefficient);
    const S c = square_root(k_.sound_factor * maximum(first.temperature, air_.temperature_K));
    const PortSolution<S> port = solve_valve_port(air_, valve, cross_section_, face.velocity - K * port_pressure_, K, c, first.density, first.temperature, port_pressure_);
    port_pressure_ = port.pressure_Pa;
    face.velocity = port.velocity_mps;
    limit_speed(k_, face, air_.temperature_K, first.temperature);
    face.mass_flux = port.mass_flow_kgps / cross_section_;
    const S T_flow = select(face.mass_flux > S(0), air_.temperature_K - face.velocity * face.velocity / (S(2) * air_.cp), first.temperature);
    face.pressure_flux = face.mass_flux * air_.R * T_flow;
  }

  // Fitting between line end and chamber, implicit: u + k P (1 - sqrt(1 - (u/c)^2)) = u_free with the ellipse of the
  // orifice, P = p_up (1 - b), c the velocity of its sonic flow. Squared it is a quadratic in u/c.
  void apply_restriction(Face& face, const Cell& last, const S& u_old, const S& rho, const ChamberEnd<S>& chamber) noexcept {
    const S area = effects_.restriction.area_m2;
    const auto fitted = area > S(0), outward = face.velocity > S(0);
    const S p_up = select(outward, maximum(last.pressure, chamber.pressure_Pa), chamber.pressure_Pa);
    const S T_up = select(outward, last.temperature + u_old * u_old / (S(2) * air_.cp), chamber.temperature_K);
    const S sonic = air_.flow_constant * select(fitted, area, S(1)) * p_up / square_root(air_.R * T_up) / (rho * cross_section_);
    const S drop = S(2) * k_.grid_ratio / (rho + face.friction_coefficient) * p_up * (S(1) - effects_.critical_pressure_ratio);
    const S d = drop - minimum(absolute(face.velocity), sonic + drop);
    const S square = sonic * sonic + drop * drop;
    const S share = (drop * square_root(square - d * d) - sonic * d) / square;
    face.velocity = select(fitted, select(outward, sonic * share, -sonic * share), face.velocity);
  }
  // Behind a fitting the gas at the face has the line's pressure: it is throttled before it enters.
  S face_pressure_at_chamber(const Cell& last, const ChamberEnd<S>& chamber) const noexcept {
    return restricted_ ? select(effects_.restriction.area_m2 > S(0), last.pressure, chamber.pressure_Pa) : chamber.pressure_Pa;
  }

  // Flux at the chamber; returns the stagnation enthalpy flux into the chamber [W/m2].
  S chamber_end_flux(Face& end, const Cell& last, const ChamberEnd<S>& chamber) const noexcept {
    const S u = end.velocity;
    const auto enters = u < S(0);  // from the chamber into the line
    const S p = face_pressure_at_chamber(last, chamber);
    end.pressure_flux = select(enters, p, limited_face_pressure(p, last.pressure)) * u;
    end.mass_flux = end.pressure_flux * select(enters, inflow_density_per_pressure(chamber.temperature_K, u), last.density_per_pressure);
    return end.mass_flux * select(enters, air_.cp * chamber.temperature_K, air_.cp * last.temperature + S(0.5) * u * u);
  }

  // Mass and energy of a cell: compression trapezoidal, wall heat implicit, friction heat of both faces.
  // p = a/d, T = p/(rho R) and 1/(R T) = rho/p all come from the one division 1/(rho a d).
  void advance_cell(const Constants& k, Cell& cell, const Face& left, const Face& right, int index) noexcept {
    const S lost = leaking_ ? leak_per_volume(cell, left, right, index) : S(0);
    const S rho = cell.density - k.grid_ratio * (right.mass_flux - left.mass_flux) - lost;
    const S b = k.compression_factor * (right.velocity - left.velocity);
    const S one_plus = S(1) + b;
    S x = cell.pressure * (S(1) - b) - k.grid_ratio * (right.pressure_flux - left.pressure_flux);
    // A leak takes its static enthalpy from the internal energy (its kinetic energy is not part of that).
    if (leaking_) x -= lost * k.kappa_minus_one * air_.cp * cell.temperature;
    const S heat = S(0.5) * (left.friction_coefficient * (left.velocity * left.velocity) + right.friction_coefficient * (right.velocity * right.velocity));
    const S wall = k.heat_factor * (left.nusselt + right.nusselt) * Air<S>::conductivity(cell.temperature);
    const S rho_cv = rho * k.cv;
    const S a = rho_cv * (x + one_plus * (k.kappa_minus_one * heat)) + one_plus * (wall * (rho * k.wall_pressure_factor));
    const S d = one_plus * (rho_cv + wall);
    const S reciprocal = S(1) / (rho * (a * d));
    const S a_squared_r = a * a * reciprocal;
    cell.pressure = rho * a_squared_r;
    cell.density = rho;
    cell.temperature = a_squared_r * k.inverse_R;
    cell.density_per_pressure = rho * rho * (d * d * reciprocal);
    if (!all((rho >= S(1e-3)) & (cell.temperature >= S(150)) & (cell.temperature <= S(600)))) [[unlikely]] mend_cell(cell);
  }

  void mend_cell(Cell& cell) noexcept {
    const S T = cell.temperature;
    const auto thin = !(cell.density >= S(1e-3));
    const auto outside = !((T >= S(150)) & (T <= S(600)));
    guard_actions_ += count(thin) + count(outside);
    const auto mend = thin | outside;
    const S T_mended = select(T == T, clamp(T, S(150), S(600)), air_.temperature_K);
    cell.density = select(thin, S(1e-3), cell.density);
    cell.temperature = select(mend, T_mended, T);
    cell.pressure = select(mend, cell.density * air_.R * T_mended, cell.pressure);
    cell.density_per_pressure = select(mend, S(1) / (air_.R * T_mended), cell.density_per_pressure);
  }

  // Orifice to atmosphere in the cell that holds `position`: density lost in this sub-step [kg/m3].
  S leak_per_volume(const Cell& cell, const Face& left, const Face& right, int index) noexcept {
    const S place = minimum(effects_.leak.position * S(cells()), S(cells() - 0.5));
    const S share = select((place >= S(index)) & (place < S(index + 1)), S(1), S(0));
    const S u = S(0.5) * (left.velocity + right.velocity);
    const S stagnation_K = cell.temperature + u * u / (S(2) * air_.cp);
    const S flow = orifice_mass_flow(air_, effects_.leak.area_m2 * share, effects_.critical_pressure_ratio, cell.pressure, stagnation_K, air_.atmosphere_Pa, air_.temperature_K);
    leak_flow_ += flow;
    return flow * S(step_s_) / (cross_section_ * cell_length());
  }

  double step_s_ = 1e-3;
  Air<S> air_;
  S length_{}, diameter_{}, cross_section_{};
  PipeFriction<S> friction_;
  Constants k_;
  LineEffects<S> effects_;
  bool restricted_ = false, leaking_ = false, adiabatic_ = false, isothermal_ = false, frictionless_ = false;
  std::vector<Cell> cell_;
  std::vector<S> velocity_;
  S port_pressure_{}, port_flux_{}, chamber_flux_{}, leak_flow_{}, fastest_squared_{};
  std::int64_t guard_actions_ = 0;
};

}  // namespace pneuservo
