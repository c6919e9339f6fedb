// Distributed pipeline on a staggered grid: pressure and density in cells, velocity on faces (thesis 3.2 to 3.4, Fig. 3.3).
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <pneuservo/core/wide.hpp>
#include <pneuservo/elements/effects.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/pipe_friction.hpp>
#include <pneuservo/elements/valve_port.hpp>

namespace pneuservo {

/// What a step of the line hands to its ends. Flow is positive from valve to chamber.
template <class S> struct LineFlow {
  S port_mass_flow_kgps;
  S chamber_mass_flow_kgps;
  S chamber_enthalpy_flow_W;  ///< stagnation enthalpy into the chamber
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
/// S may carry several lines in lanes (both sides of an axis, several rigs); V is the register of the cell loops.
/// Guards keep every state physical: |u| <= c of the gas that moves, density >= 1e-3 kg/m3, 150 K <= T <= 600 K; what
/// they did is counted. Mass is conserved to rounding, guards included (the density floor excepted).
template <class S, class V = Wide<S>> class Line {
 public:
  /// Allocates; cells >= 1.
  void configure(const LineParameters<S>& line, const AirParameters<S>& air_parameters, int cells) {
    cells_ = std::max(1, cells);
    air_ = Air<S>(air_parameters);
    length_ = line.length_m;
    diameter_ = line.diameter_m;
    cross_section_ = S(0.78539816339744831) * diameter_ * diameter_;
    friction_ = PipeFriction<S>(line, air_);
    for (auto* field : {&pressure_, &pressure_next_, &density_, &density_next_, &temperature_, &temperature_next_, &density_per_pressure_})
      field->assign(static_cast<std::size_t>(cells_ + 2), S(1));
    for (auto* field : {&velocity_, &velocity_next_})
      field->assign(static_cast<std::size_t>(cells_ + 3), S(0));
    for (auto* field : {&mass_flux_, &pressure_flux_, &friction_coefficient_, &nusselt_, &leak_})
      field->assign(static_cast<std::size_t>(cells_ + 1), S(0));
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
  /// Friction off (its heat as well), for tests against closed forms.
  void set_frictionless(bool frictionless) noexcept {
    frictionless_ = frictionless;
    set_time_step(step_s_);
  }

  /// Gas at rest at one pressure and temperature.
  void reset(const S& pressure_Pa, const S& temperature_K) noexcept {
    for (int i = 0; i < cells_ + 2; ++i) set_cell(i, pressure_Pa, temperature_K);
    for (auto& u : velocity_) u = S(0);
    port_pressure_ = pressure_Pa;
    largest_speed_ = 0.0;
  }
  /// Sets the state of cell i = 0..cells-1, e.g. a mode shape.
  void set_cell_state(int i, const S& pressure_Pa, const S& temperature_K) noexcept { set_cell(i + 1, pressure_Pa, temperature_K); }
  /// Sets the velocity on face j = 0..cells at t - h/2.
  void set_face_velocity(int j, const S& velocity_mps) noexcept { at(velocity_, j + 1) = velocity_mps; }

  /// Sub-step h [s] of all following steps.
  void set_time_step(double step_s) noexcept {
    step_s_ = step_s;
    const S h = S(step_s), a = h / cell_length();
    const S friction_h = frictionless_ ? S(0) : h;
    narrow_ = {a, diameter_ / air_.viscosity_Pas, friction_h * air_.viscosity_Pas / (S(2) * diameter_ * diameter_),
               adiabatic_ ? S(0) : S(2) * h / (diameter_ * diameter_), S(0.5) * (air_.kappa - S(1)) * a, air_.kappa - S(1),
               air_.cv, S(1) / air_.R, air_.R * air_.temperature_K, air_.kappa * air_.R, friction_};
    wide_ = {repeat<V>(narrow_.grid_ratio), repeat<V>(narrow_.reynolds_factor), repeat<V>(narrow_.friction_factor),
             repeat<V>(narrow_.heat_factor), repeat<V>(narrow_.compression_factor), repeat<V>(narrow_.kappa_minus_one),
             repeat<V>(narrow_.cv), repeat<V>(narrow_.inverse_R), repeat<V>(narrow_.wall_pressure_factor),
             repeat<V>(narrow_.sound_factor), friction_.template widened<V>()};
  }

  /// Largest speed on any face in the last sub-step [m/s], over all lanes.
  double largest_speed() const noexcept { return largest_speed_; }

  /// One sub-step with the port pressure prescribed (middle of the sub-step): the estimator's boundary.
  /// Gas that enters at the port has the stagnation temperature of the supply.
  LineFlow<S> step_prescribed(const S& port_pressure_Pa, const ChamberEnd<S>& chamber) noexcept {
    port_pressure_ = port_pressure_Pa;
    set_ghosts(chamber);
    advance_faces();
    if (restricted_) apply_restriction(chamber);
    limit_speeds();
    prescribed_port_flux();
    return finish(chamber);
  }

  /// One sub-step with a valve at the port: the port pressure follows from orifice and line together. The orifice's own
  /// flow is booked, so that valve and line agree in mass to rounding.
  LineFlow<S> step_valve(const ValvePort<S>& valve, const ChamberEnd<S>& chamber) noexcept {
    set_ghosts(chamber);
    const S density_at_port = select(at(velocity_, 1) > S(0), port_density(), at(density_, 1));
    advance_faces();
    if (restricted_) apply_restriction(chamber);
    solve_port(valve, density_at_port);
    limit_speeds();
    return finish(chamber);
  }

  int cells() const noexcept { return cells_; }
  S cell_length() const noexcept { return length_ / S(cells_); }
  S cross_section() const noexcept { return cross_section_; }
  S volume() const noexcept { return cross_section_ * length_; }
  const Air<S>& air() const noexcept { return air_; }
  S cell_pressure(int i) const noexcept { return at(pressure_, i + 1); }
  S cell_density(int i) const noexcept { return at(density_, i + 1); }
  S cell_temperature(int i) const noexcept { return at(temperature_, i + 1); }
  S face_velocity(int j) const noexcept { return at(velocity_, j + 1); }
  /// Pressure at the valve port, of the last sub-step.
  S port_pressure() const noexcept { return port_pressure_; }
  /// Mass flow [kg/s] through face j of the last sub-step.
  S face_mass_flow(int j) const noexcept { return cross_section_ * at(mass_flux_, j); }
  /// Mass of the gas in the line [kg].
  S mass() const noexcept {
    S sum(0);
    for (int i = 1; i <= cells_; ++i) sum += at(density_, i);
    return sum * cross_section_ * cell_length();
  }
  /// Internal energy of the gas in the line [J] (its kinetic energy not included).
  S internal_energy() const noexcept {
    S sum(0);
    for (int i = 1; i <= cells_; ++i) sum += at(pressure_, i);
    return sum * cross_section_ * cell_length() / (air_.kappa - S(1));
  }
  /// Times a guard has acted since configure, over all lanes.
  std::int64_t guard_actions() const noexcept { return guard_actions_; }
  /// Mass flow lost through the leak in the last sub-step [kg/s].
  S leak_mass_flow() const noexcept { return leak_flow_; }

 private:
  template <class T> struct Constants {
    T grid_ratio, reynolds_factor, friction_factor, heat_factor, compression_factor, kappa_minus_one, cv, inverse_R;
    T wall_pressure_factor, sound_factor;
    PipeFriction<T> friction;
  };

  template <class T> static T& at(std::vector<T>& field, int i) noexcept { return field[static_cast<std::size_t>(i)]; }
  template <class T> static const T& at(const std::vector<T>& field, int i) noexcept { return field[static_cast<std::size_t>(i)]; }
  template <class W> const Constants<W>& constants() const noexcept {
    if constexpr (std::is_same_v<W, V>) return wide_;
    else return narrow_;
  }
  void set_cell(int i, const S& p, const S& T) noexcept {
    at(pressure_, i) = p;
    at(temperature_, i) = T;
    at(density_, i) = p / (air_.R * T);
    at(density_per_pressure_, i) = S(1) / (air_.R * T);
  }
  S port_density() const noexcept { return port_pressure_ / (air_.R * air_.temperature_K); }

  // Ghost cells make the end faces look like inner ones: pressures mirrored about the end (half a cell away: twice the
  // gradient) and densities such that the mean is that of the gas that moves.
  void set_ghosts(const ChamberEnd<S>& chamber) noexcept {
    const int n = cells_;
    const S rho_port = port_density();
    const S rho_chamber = chamber.pressure_Pa / (air_.R * chamber.temperature_K);
    at(pressure_, 0) = S(2) * port_pressure_ - at(pressure_, 1);
    at(pressure_, n + 1) = S(2) * chamber.pressure_Pa - at(pressure_, n);
    at(density_, 0) = select(at(velocity_, 1) > S(0), S(2) * rho_port - at(density_, 1), at(density_, 1));
    at(density_, n + 1) = select(at(velocity_, n + 1) < S(0), S(2) * rho_chamber - at(density_, n), at(density_, n));
    at(temperature_, 0) = air_.temperature_K;
    at(temperature_, n + 1) = chamber.temperature_K;
    at(velocity_, 0) = at(velocity_, 1);
    at(velocity_, n + 2) = at(velocity_, n + 1);
  }

  // Momentum on every face and the fluxes that its new velocity carries. Speeds above sound are found here and mended
  // by limit_speeds(); the end faces' fluxes are overwritten by their boundary.
  void advance_faces() noexcept {
    bool too_fast = false;
    V fastest(0);
    S fastest_narrow(0);
    for_each_wide<V, S>(cells_ + 1, [&](auto tag, int f) noexcept {
      using W = decltype(tag);
      const Constants<W>& k = constants<W>();
      const W p_left = load_wide<W>(&at(pressure_, f)), p_right = load_wide<W>(&at(pressure_, f + 1));
      const W rho = W(0.5) * (load_wide<W>(&at(density_, f)) + load_wide<W>(&at(density_, f + 1)));
      const W u_before = load_wide<W>(&at(velocity_, f)), u = load_wide<W>(&at(velocity_, f + 1));
      const W u_after = load_wide<W>(&at(velocity_, f + 2));
      const W difference = select(u > W(0), u - u_before, u_after - u);
      const PipeFrictionValue<W> friction = k.friction(rho * absolute(u) * k.reynolds_factor);
      const W friction_coefficient = k.friction_factor * friction.lambda_reynolds;
      const W u_new = (rho * (u - k.grid_ratio * (u * difference)) - k.grid_ratio * (p_right - p_left)) / (rho + friction_coefficient);
      const auto forward = u_new > W(0);
      const W T_left = load_wide<W>(&at(temperature_, f)), T_right = load_wide<W>(&at(temperature_, f + 1));
      const W u_squared = u_new * u_new;
      too_fast |= !all(u_squared <= k.sound_factor * select(forward, T_left, T_right));
      if constexpr (std::is_same_v<W, V>) fastest = maximum(fastest, u_squared);
      else fastest_narrow = maximum(fastest_narrow, u_squared);
      const W p_up = select(forward, p_left, p_right);
      const W s_up = select(forward, load_wide<W>(&at(density_per_pressure_, f)), load_wide<W>(&at(density_per_pressure_, f + 1)));
      const W z = limited_face_pressure(W(0.5) * (p_left + p_right), p_up) * u_new;
      store_wide(u_new, &at(velocity_next_, f + 1));
      store_wide(friction_coefficient, &at(friction_coefficient_, f));
      store_wide(friction.nusselt, &at(nusselt_, f));
      store_wide(z, &at(pressure_flux_, f));
      store_wide(s_up * z, &at(mass_flux_, f));
    });
    too_fast_ = too_fast;
    largest_speed_ = std::sqrt(std::max(largest(fastest), largest(fastest_narrow)));
    velocity_.swap(velocity_next_);
  }

  // Face pressure centred, but within 10 % of the upwind cell's: a shock must not carry energy the cell does not have.
  template <class W> static W limited_face_pressure(const W& centred, const W& upwind) noexcept {
    const W band = W(0.1) * absolute(upwind);
    return upwind + clamp(centred - upwind, -band, band);
  }

  // |u| <= sound speed of the gas that moves: chokes the ends and tames a jump of a prescribed port pressure.
  void limit_speeds() noexcept {
    if (!too_fast_) [[likely]] return;
    for (int f = 0; f <= cells_; ++f) {
      S& u = at(velocity_, f + 1);
      const S sound = square_root(narrow_.sound_factor * select(u > S(0), at(temperature_, f), at(temperature_, f + 1)));
      const auto bad = !(absolute(u) <= sound);
      if (!any(bad)) continue;
      guard_actions_ += count(bad);
      u = select(u == u, clamp(u, -sound, sound), S(0));
      if (f > 0 && f < cells_) inner_flux(f);
    }
  }
  void inner_flux(int f) noexcept {
    const S u = at(velocity_, f + 1), p_left = at(pressure_, f), p_right = at(pressure_, f + 1);
    const auto forward = u > S(0);
    const S z = limited_face_pressure(S(0.5) * (p_left + p_right), select(forward, p_left, p_right)) * u;
    at(pressure_flux_, f) = z;
    at(mass_flux_, f) = select(forward, at(density_per_pressure_, f), at(density_per_pressure_, f + 1)) * z;
  }

  // Gas that enters has the static temperature T_stagnation - u^2/(2 c_p).
  S inflow_density_per_pressure(const S& stagnation_K, const S& u) const noexcept {
    return S(1) / (air_.R * (stagnation_K - u * u / (S(2) * air_.cp)));
  }

  void prescribed_port_flux() noexcept {
    const S u = at(velocity_, 1), p_1 = at(pressure_, 1);
    const auto enters = u > S(0);
    const S z = select(enters, port_pressure_, limited_face_pressure(port_pressure_, p_1)) * u;
    at(pressure_flux_, 0) = z;
    at(mass_flux_, 0) = z * select(enters, inflow_density_per_pressure(air_.temperature_K, u), at(density_per_pressure_, 1));
  }

  // u = u* + K p and A rho_b(p) u = G_supply(p) - G_exhaust(p): monotone in p.
  void solve_port(const ValvePort<S>& valve, const S& density_at_port) noexcept {
    const S K = S(2) * narrow_.grid_ratio / (density_at_port + at(friction_coefficient_, 0));
    const S u_star = at(velocity_, 1) - K * port_pressure_;  // the momentum step was taken with the last port pressure
    const S T_1 = at(temperature_, 1);
    const S c = square_root(narrow_.sound_factor * maximum(T_1, air_.temperature_K));
    const PortSolution<S> port = solve_valve_port(air_, valve, cross_section_, u_star, K, c, at(density_, 1), T_1, port_pressure_);
    port_pressure_ = port.pressure_Pa;
    at(velocity_, 1) = port.velocity_mps;
    const S flux = port.mass_flow_kgps / cross_section_;
    const S T_flow = select(flux > S(0), air_.temperature_K - port.velocity_mps * port.velocity_mps / (S(2) * air_.cp), T_1);
    at(mass_flux_, 0) = flux;
    at(pressure_flux_, 0) = flux * air_.R * T_flow;
    if (!all(port.velocity_mps * port.velocity_mps <= narrow_.sound_factor * select(flux > S(0), air_.temperature_K, T_1))) too_fast_ = true;
  }

  // Fitting between line end and chamber: its pressure drop by the inverse orifice law at the old velocity, taken
  // implicitly like friction: u' = u_free / (1 + w a R/(rho + f)), R = drop/|u|.
  void apply_restriction(const ChamberEnd<S>& chamber) noexcept {
    const int n = cells_;
    S& u = at(velocity_, n + 1);
    const S old = at(velocity_next_, n + 1);  // after the swap: the old velocity
    const auto outward = u > S(0);
    const S p_up = select(outward, maximum(at(pressure_, n), chamber.pressure_Pa), chamber.pressure_Pa);
    const S T_up = select(outward, at(temperature_, n) + old * old / (S(2) * air_.cp), chamber.temperature_K);
    const S rho = S(0.5) * (at(density_, n) + at(density_, n + 1));
    const S area = effects_.restriction.area_m2;
    const auto fitted = area > S(0);
    const S full = air_.flow_constant * select(fitted, area, S(1)) * p_up / square_root(air_.R * T_up);
    const S psi = minimum(rho * maximum(absolute(old), S(1e-6)) * cross_section_ / full, S(0.99999));
    const S drop = p_up * (S(1) - effects_.critical_pressure_ratio) * (S(1) - square_root(S(1) - psi * psi));
    const S resistance = select(fitted, drop / maximum(absolute(old), S(1e-6)), S(0));
    u = u / (S(1) + S(2) * narrow_.grid_ratio * resistance / (rho + at(friction_coefficient_, n)));
    const S sonic = full / (rho * cross_section_);
    u = select(fitted, clamp(u, -sonic, sonic), u);
  }

  LineFlow<S> finish(const ChamberEnd<S>& chamber) noexcept {
    const S chamber_flux = chamber_end_flux(chamber);
    if (leaking_) find_leak();
    advance_cells();
    if (leaking_) apply_leak();
    mend_cells();
    LineFlow<S> flow;
    flow.port_mass_flow_kgps = cross_section_ * at(mass_flux_, 0);
    flow.chamber_mass_flow_kgps = cross_section_ * at(mass_flux_, cells_);
    flow.chamber_enthalpy_flow_W = cross_section_ * chamber_flux;
    return flow;
  }

  // Flux at the chamber; returns the stagnation enthalpy flux into the chamber [W/m2].
  S chamber_end_flux(const ChamberEnd<S>& chamber) noexcept {
    const int n = cells_;
    const S u = at(velocity_, n + 1);
    const auto enters = u < S(0);  // from the chamber into the line
    const S z = select(enters, chamber.pressure_Pa, limited_face_pressure(chamber.pressure_Pa, at(pressure_, n))) * u;
    const S m = z * select(enters, inflow_density_per_pressure(chamber.temperature_K, u), at(density_per_pressure_, n));
    const S stagnation_enthalpy = select(enters, air_.cp * chamber.temperature_K, air_.cp * at(temperature_, n) + S(0.5) * u * u);
    at(pressure_flux_, n) = z;
    at(mass_flux_, n) = m;
    return m * stagnation_enthalpy;
  }

  // Mass and energy of every cell: compression trapezoidal, wall heat implicit, friction heat of both faces.
  void advance_cells() noexcept {
    bool bad = false;
    for_each_wide<V, S>(cells_, [&](auto tag, int i) noexcept {
      using W = decltype(tag);
      const Constants<W>& k = constants<W>();
      const W u_left = load_wide<W>(&at(velocity_, i + 1)), u_right = load_wide<W>(&at(velocity_, i + 2));
      const W rho = load_wide<W>(&at(density_, i + 1)) - k.grid_ratio * (load_wide<W>(&at(mass_flux_, i + 1)) - load_wide<W>(&at(mass_flux_, i)));
      const W b = k.compression_factor * (u_right - u_left);
      const W one_plus = W(1) + b;
      const W x = load_wide<W>(&at(pressure_, i + 1)) * (W(1) - b) -
                  k.grid_ratio * (load_wide<W>(&at(pressure_flux_, i + 1)) - load_wide<W>(&at(pressure_flux_, i)));
      const W heat = W(0.5) * (load_wide<W>(&at(friction_coefficient_, i)) * (u_left * u_left) + load_wide<W>(&at(friction_coefficient_, i + 1)) * (u_right * u_right));
      const W wall = k.heat_factor * (load_wide<W>(&at(nusselt_, i)) + load_wide<W>(&at(nusselt_, i + 1))) * Air<W>::conductivity(load_wide<W>(&at(temperature_, i + 1)));
      const W rho_cv = rho * k.cv;
      const W p = (rho_cv * (x + one_plus * (k.kappa_minus_one * heat)) + one_plus * (wall * (rho * k.wall_pressure_factor))) /
                  (one_plus * (rho_cv + wall));
      const W reciprocal = W(1) / (rho * p);
      const W T = p * p * reciprocal * k.inverse_R;
      bad |= !all((rho >= W(1e-3)) & (T >= W(150)) & (T <= W(600)));
      store_wide(rho, &at(density_next_, i + 1));
      store_wide(p, &at(pressure_next_, i + 1));
      store_wide(T, &at(temperature_next_, i + 1));
      store_wide(rho * rho * reciprocal, &at(density_per_pressure_, i + 1));
    });
    bad_cell_ = bad;
    density_.swap(density_next_);
    pressure_.swap(pressure_next_);
    temperature_.swap(temperature_next_);
  }

  // Orifice to atmosphere in the cell nearest to `position`; from the state at the start of the sub-step.
  void find_leak() noexcept {
    leak_flow_ = S(0);
    for (int i = 1; i <= cells_; ++i) {
      const S u = S(0.5) * (at(velocity_, i) + at(velocity_, i + 1));
      const S stagnation = at(temperature_, i) + u * u / (S(2) * air_.cp);
      at(leak_, i - 1) = orifice_mass_flow(air_, effects_.leak.area_m2 * leak_share(i - 1), effects_.critical_pressure_ratio,
                                           at(pressure_, i), stagnation, air_.atmosphere_Pa, air_.temperature_K);
      leak_flow_ += at(leak_, i - 1);
    }
  }
  // 1 for the cell that holds the place of the leak, else 0.
  S leak_share(int i) const noexcept {
    const S place = minimum(effects_.leak.position * S(cells_), S(cells_ - 0.5));
    return select((place >= S(i)) & (place < S(i + 1)), S(1), S(0));
  }
  // What leaves takes its static enthalpy from the internal energy (its kinetic energy is not part of that).
  void apply_leak() noexcept {
    const S per_volume = S(step_s_) / (cross_section_ * cell_length());
    for (int i = 1; i <= cells_; ++i) {
      const S lost = at(leak_, i - 1) * per_volume;
      at(density_, i) -= lost;
      at(pressure_, i) -= lost * narrow_.kappa_minus_one * air_.cp * at(temperature_, i);
      at(temperature_, i) = at(pressure_, i) / (at(density_, i) * air_.R);
      at(density_per_pressure_, i) = at(density_, i) / at(pressure_, i);
    }
  }

  void mend_cells() noexcept {
    if (!bad_cell_) [[likely]] return;
    for (int i = 1; i <= cells_; ++i) {
      S& rho = at(density_, i);
      const S T = at(temperature_, i);
      const auto thin = !(rho >= S(1e-3));
      const auto outside = !((T >= S(150)) & (T <= S(600)));
      if (!any(thin) && !any(outside)) continue;
      guard_actions_ += count(thin) + count(outside);
      rho = select(thin, S(1e-3), rho);
      const S T_mended = select(T == T, clamp(T, S(150), S(600)), air_.temperature_K);
      const auto mend = thin | outside;
      at(temperature_, i) = select(mend, T_mended, T);
      at(pressure_, i) = select(mend, rho * air_.R * T_mended, at(pressure_, i));
      at(density_per_pressure_, i) = select(mend, S(1) / (air_.R * T_mended), at(density_per_pressure_, i));
    }
  }

  int cells_ = 0;
  double step_s_ = 1e-3;
  Air<S> air_;
  S length_{}, diameter_{}, cross_section_{};
  PipeFriction<S> friction_;
  Constants<V> wide_;
  Constants<S> narrow_;
  LineEffects<S> effects_;
  bool restricted_ = false, leaking_ = false, adiabatic_ = false, frictionless_ = false;
  bool too_fast_ = false, bad_cell_ = false;
  // Cells 1..N between two ghosts; faces 0..N, velocities with one ghost more on either side.
  std::vector<S> pressure_, pressure_next_, density_, density_next_, temperature_, temperature_next_, density_per_pressure_;
  std::vector<S> velocity_, velocity_next_;
  std::vector<S> mass_flux_, pressure_flux_, friction_coefficient_, nusselt_;
  std::vector<S> leak_;
  S port_pressure_{};
  S leak_flow_{};
  double largest_speed_ = 0.0;
  std::int64_t guard_actions_ = 0;
};

}  // namespace pneuservo
