// Distributed pipeline on a staggered grid: pressure and density in cells, velocity on faces (thesis 3.2 to 3.4,
// Fig. 3.3).
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <pneuservo/core/scalar.hpp>
#include <pneuservo/elements/line_ends.hpp>
#include <pneuservo/elements/line_losses.hpp>
#include <pneuservo/elements/line_memory.hpp>
#include <pneuservo/elements/line_rows.hpp>
#include <pneuservo/elements/line_scheme.hpp>
#include <pneuservo/elements/line_steps.hpp>
#include <pneuservo/elements/pipe_friction.hpp>
#include <pneuservo/elements/valve_port.hpp>

namespace pneuservo {

/// One pipeline, `cells` cells of equal length, explicit in time (leapfrog: pressures at t, velocities at t - h/2),
/// friction and wall heat implicit, pressure flux centred, temperature upwind: docs/physics/line.md has the scheme.
/// S may carry several lines in lanes (both sides of an axis, several rigs).
/// Guards keep every state physical: |u| <= c of the gas that moves, density >= 1e-3 kg/m3, 150 K <= T <= 600 K; what
/// they did is counted. Mass is conserved to rounding, guards included (the density floor excepted).
template <class S> class Line : public LineSteps<Line<S>, S> {
 public:
  /// Allocates; cells >= 1.
  void configure(const LineParameters<S>& line, const AirParameters<S>& air_parameters, int cells) {
    air_ = Air<S>(air_parameters);
    length_ = line.length_m;
    port_constants_ = PortConstants<S>(air_, S(0.35), port_constants_.tolerance);
    diameter_ = line.diameter_m;
    cross_section_ = line.section_m2();
    friction_ = PipeFriction<S>(line, air_);
    arrange(std::max(1, cells));
    guard_actions_ = 0;
    step_s_ = 1e-3;
    set_effects(LineEffects<S>{});
    reset(air_.atmosphere_Pa, air_.temperature_K);
  }

  /// Switches physics beside the nominal model on or off.
  void set_effects(const LineEffects<S>& effects) noexcept {
    effects_ = effects;
    fittings_.set_effects(effects);
    losses_.set_effects(effects);
    const S share = effects.frequency_dependent_losses.share;
    memory_.set_share(share);
    friction_.nusselt_laminar = S(3.66) + minimum(share, S(1)) * S(8 - 3.66);
    set_time_step(step_s_);
  }
  bool is_cushioned() const noexcept { return fittings_.are_cushioned(); }
  /// Distance [m] of the piston from the end stop of the line's chamber from here on, which a cushion looks at.
  void set_piston_distance(const S& distance_m) noexcept { fittings_.set_piston_distance(distance_m); }
  /// Gas that comes into the middle from here on [kg/s], for the diagnosis.
  void set_inflow(const S& inflow_kgps) noexcept { losses_.set_inflow(inflow_kgps); }
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

  /// Relative change of the port pressure at which the solution behind a valve ends.
  void set_port_tolerance(double tolerance) noexcept { port_constants_.tolerance = tolerance; }

  /// Gas at rest at one pressure and temperature.
  void reset(const S& pressure_Pa, const S& temperature_K) noexcept {
    for (int i = 0; i < cells(); ++i) set_cell_state(i, pressure_Pa, temperature_K);
    for (G& u : face_.velocity) u = G(0);
    port_pressure_ = port_before_ = pressure_Pa;
    losses_.reset(pressure_Pa, pressure_Pa / (air_.R * temperature_K));
    fastest_squared_ = G(0);
    memory_.forget();
  }
  /// Sets the state of cell i = 0..cells-1, e.g. to a mode shape.
  void set_cell_state(int i, const S& pressure_Pa, const S& temperature_K) noexcept {
    const S RT = air_.R * temperature_K, density_per_pressure = S(1) / RT;
    set_cell(i, {pressure_Pa, pressure_Pa * density_per_pressure, RT, density_per_pressure});
    if (i == cells_ - 1) fill_places_beyond();
  }
  /// Sets the velocity on face j = 0..cells at t - h/2.
  void set_face_velocity(int j, const S& velocity_mps) noexcept {
    set_element<S>(face_.velocity[face_group(j)], face_place(j), velocity_mps);
  }

  /// Multiplies the gas's pressure and temperature; its density follows, its velocities stay.
  void scale_gas(const S& pressure, const S& temperature) noexcept {
    for (int i = 0; i < cells_; ++i) set_cell_state(i, cell(i).pressure * pressure, cell_temperature(i) * temperature);
    port_pressure_ *= pressure;
    port_before_ *= pressure;
    losses_.scale_gas(pressure, temperature);
  }

  /// Sub-step h [s] of all following steps.
  void set_time_step(double step_s) noexcept {
    step_s_ = step_s;
    memory_.renew();
    const S h(step_s), diameter_squared = diameter_ * diameter_;
    k_.grid_ratio = h / cell_length();
    k_.reynolds_factor = diameter_ / air_.viscosity_Pas;
    k_.heat_share = S(0.5) * (air_.kappa - S(1));
    k_.compression_factor = S(0.5) * (air_.kappa - S(1)) * k_.grid_ratio;
    const S friction = frictionless_ ? S(0) : h * air_.viscosity_Pas / (S(2) * diameter_squared);
    k_.flow_diffusion = S(8) * friction;
    k_.friction = friction_.multiplied(friction);
    k_.inverse_R = S(1) / air_.R;
    k_.cv = air_.cv;
    k_.inverse_cv = S(1) / air_.cv;
    const S wall = adiabatic_ ? S(0) : S(isothermal_ ? 2e12 : 2.0) * h / diameter_squared * k_.inverse_cv;
    k_.wall_offset = wall * Air<S>::conductivity(S(0));
    k_.wall_slope = (wall * Air<S>::conductivity(S(1)) - k_.wall_offset) * k_.inverse_R;
    k_.wall_pressure_per_density = air_.R * air_.temperature_K;
    k_.inverse_wall_pressure_per_density = S(1) / k_.wall_pressure_per_density;
    k_.coldest = air_.R * S(line_scheme::coldest_K);
    k_.hottest = air_.R * S(line_scheme::hottest_K);
    k_.kappa_minus_one = air_.kappa - S(1);
    k_.sound_factor = isothermal_ ? air_.R : air_.kappa * air_.R;
    k_.half_inverse_cp = isothermal_ ? S(0) : S(0.5) / air_.cp;
    k_.half_inverse_grid_ratio = S(0.5) / k_.grid_ratio;
    group_k_ = line_scheme::replicate_constants(k_);
  }
  /// Largest speed on any face in the last sub-step [m/s], over all lanes.
  double largest_speed() const noexcept { return std::sqrt(largest(fastest_squared_)); }

  /// The two parts of a sub-step: LineSteps has the whole.
  LineFlow<S> advance_ends_prescribed(const S& port_pressure_Pa, const ChamberEnd<S>& chamber) noexcept {
    port_pressure_ = port_before_ = port_pressure_Pa;
    return advance_ends(chamber, [this](Face& face, const Cell& first) noexcept { prescribed_port_flux(face, first); });
  }
  LineFlow<S> advance_ends_valve(const ValvePort<S>& valve, const ChamberEnd<S>& chamber) noexcept {
    // Once, unless somebody changes the valve in flight.
    if (any(!(valve.critical_pressure_ratio == port_constants_.shape.critical))) [[unlikely]]
      port_constants_ = PortConstants<S>(air_, valve.critical_pressure_ratio, port_constants_.tolerance);
    return advance_ends(chamber, [&](Face& face, const Cell& first) noexcept { valve_port_flux(valve, face, first); });
  }
  void advance_inside() noexcept {
    if (memory_.is_present()) [[unlikely]]
      advance_inside<true>();
    else advance_inside<false>();
  }

  int cells() const noexcept { return cells_; }
  S cell_length() const noexcept { return length_ / S(cells()); }
  S cross_section() const noexcept { return cross_section_; }
  S volume() const noexcept { return cross_section_ * length_; }
  const Air<S>& air() const noexcept { return air_; }
  S cell_pressure(int i) const noexcept { return cell(i).pressure; }
  S cell_density(int i) const noexcept { return cell(i).density; }
  S cell_temperature(int i) const noexcept { return temperature(cell(i)); }
  S face_velocity(int j) const noexcept { return velocity(j); }
  /// Pressure at the valve port, of the last sub-step.
  S port_pressure() const noexcept { return port_pressure_; }
  /// The correlation of its walls, for what hangs on the line.
  const PipeFriction<S>& friction() const noexcept { return friction_; }
  /// Mass of the gas in the line [kg].
  S mass() const noexcept {
    S sum(0);
    for (int i = 0; i < cells_; ++i) sum += cell(i).density;
    return sum * cross_section_ * cell_length();
  }
  /// Internal energy of the gas in the line [J] (its kinetic energy not included).
  S internal_energy() const noexcept {
    S sum(0);
    for (int i = 0; i < cells_; ++i) sum += cell(i).pressure;
    return sum * cross_section_ * cell_length() / (air_.kappa - S(1));
  }
  /// Times a guard has acted since configure, over all lanes.
  std::int64_t guard_actions() const noexcept { return guard_actions_; }
  /// Mass flow lost through the leak in the last sub-step [kg/s].
  S leak_mass_flow() const noexcept { return losses_.leak_mass_flow(); }
  /// Gas behind the necks of a branch and of the valve's port [kg].
  S branch_mass() const noexcept { return losses_.branch_mass(effects_); }
  /// Gas that a hose which swells holds beyond its bore at the start [kg].
  S swollen_mass() const noexcept { return losses_.swollen_mass(*this); }

 private:
  using G = Group<S>;
  using Cell = line_scheme::Cell<S>;
  using Face = line_scheme::Face<S>;
  using Constants = line_scheme::Constants<S>;
  using CellRow = line_scheme::CellRow<S>;
  using FaceRow = line_scheme::FaceRow<S>;
  using End = typename LineMemory<S>::End;
  static constexpr int per_group = GroupOf<S>::elements;

  // Cells q g .. q g + g - 1 stand in cell group q, faces (q-1) g + 1 .. q g in face group q (g = per_group): the left
  // cells of a face group are a cell group, the right faces of a cell group are a face group.
  // Places beyond the last cell repeat it, places beyond the last face repeat that: nothing happens there.
  int cell_groups() const noexcept { return (cells_ + per_group - 1) / per_group; }
  static std::size_t face_group(int j) noexcept { return static_cast<std::size_t>((j + per_group - 1) / per_group); }
  static int face_place(int j) noexcept { return (j + per_group - 1) % per_group; }
  [[gnu::always_inline]] Cell cell(int i) const noexcept {
    const int at = i % per_group;
    const auto c = cell_.group(static_cast<std::size_t>(i / per_group));
    return {element<S>(c.pressure, at), element<S>(c.density, at), element<S>(c.pressure_per_density, at),
            element<S>(c.density_per_pressure, at)};
  }
  void set_cell(int i, const Cell& c) noexcept {
    const auto q = static_cast<std::size_t>(i / per_group);
    const int at = i % per_group;
    set_element<S>(cell_.pressure[q], at, c.pressure);
    set_element<S>(cell_.density[q], at, c.density);
    set_element<S>(cell_.pressure_per_density[q], at, c.pressure_per_density);
    set_element<S>(cell_.density_per_pressure[q], at, c.density_per_pressure);
  }
  S temperature(const Cell& c) const noexcept { return c.pressure_per_density * k_.inverse_R; }
  S velocity(int j) const noexcept { return element<S>(face_.velocity[face_group(j)], face_place(j)); }

  // The ends have the longest chains and go first. What computes them is always inlined: a program of many lines uses
  // up what the compiler allows itself, and a face handed over through the stack there costs a fifth of a step.
  template <class PortFlux> LineFlow<S> advance_ends(const ChamberEnd<S>& chamber, PortFlux&& port_flux) noexcept {
    if (memory_.is_present()) [[unlikely]]
      return advance_ends_with_memory(chamber, port_flux);
    return advance_both_ends<false>(chamber, port_flux);
  }
  // Apart, so that the plain line's code stays as short as if there were no memory.
  template <class PortFlux>
  [[gnu::noinline]] LineFlow<S> advance_ends_with_memory(const ChamberEnd<S>& chamber, PortFlux&& port_flux) noexcept {
    if (memory_.begin_step()) find_layers();
    return advance_both_ends<true>(chamber, port_flux);
  }
  template <bool remembering, class PortFlux>
  [[gnu::always_inline]] LineFlow<S> advance_both_ends(const ChamberEnd<S>& chamber, PortFlux&& port_flux) noexcept {
    const int n = cells_;
    const S u_0 = velocity(0), u_n = velocity(n), u_1 = velocity(1), u_before_n = velocity(n - 1);
    const Cell first = cell(0), last = cell(n - 1);
    Face end = chamber_face<remembering>(last, u_before_n, u_n, chamber);
    const S enthalpy_flux = chamber_end_flux(end, last, u_before_n, chamber);
    const Face port = port_face<remembering>(first, u_0, u_1, port_flux);
    if constexpr (remembering) memory_.advance_ends(port.velocity - u_0, end.velocity - u_n);
    chamber_face_ = end;
    port_face_ = port;
    return {cross_section_ * port.mass_flux, cross_section_ * end.mass_flux, cross_section_ * enthalpy_flux};
  }

  // Passes over the line, each of independent places: a place's chain friction -> velocity -> flux -> cell takes longer
  // than all else together, so the processor must have many places under way at once.
  // The passes are functions of their own, not inlined: what the compiler makes of each does not hang on which of them
  // a program uses.
  template <bool remembering> void advance_inside() noexcept {
    if (cells_ > 1) {
      find_reynolds();
      advance_velocities<remembering>();
      find_inner_fluxes();
    }
    face_.fill(0, all_places_, port_face_);
    face_.fill(face_group(cells_), from_end_, chamber_face_);
    if (losses_.are_present()) {
      losses_.step(*this, effects_, k_, step_s_);
      find_balances<true, remembering>();
    } else {
      find_balances<false, remembering>();
    }
    find_states<remembering>();
  }

  int inner_face_groups() const noexcept { return (cells_ - 1 + per_group - 1) / per_group; }

  [[gnu::noinline]] void find_reynolds() noexcept {
    const auto& k = group_k_;
    const G* const density = cell_.density.data();
    const FaceRow faces(face_);
    const int groups = inner_face_groups();
    G left = density[0];
    for (int q = 1; q <= groups; ++q) {
      const G next = density[q];
      const G rho = G(0.5) * (left + one_after<S>(left, next));
      const G Re = line_scheme::reynolds(k, rho, faces.velocity[q]);
      faces.density[q] = rho;
      faces.reynolds[q] = Re;
      faces.reynolds_root[q] = PipeFriction<G>::root(Re);
      left = next;
    }
  }

  template <bool remembering> [[gnu::noinline]] void advance_velocities() noexcept {
    const auto& k = group_k_;
    const G* const pressure = cell_.pressure.data();
    const FaceRow faces(face_);
    const int groups = inner_face_groups();
    G previous = faces.velocity[0], u = faces.velocity[1], left = pressure[0];
    for (int q = 1; q <= groups; ++q) {
      const G u_next = faces.velocity[q + 1], next = pressure[q];
      const auto friction = k.friction.at_root(faces.reynolds[q], faces.reynolds_root[q]);
      const G f = friction.lambda_reynolds;
      const G du = select(u > G(0), u - one_before<S>(previous, u), one_after<S>(u, u_next) - u);
      const G rho = faces.density[q];
      const G momentum = line_scheme::momentum(k, rho, u, du, one_after<S>(left, next) - left);
      if constexpr (remembering) {
        const WallAnswer<G> wall = memory_.at_faces(q, u);
        const G u_new = (momentum + wall.source) / (rho + f + wall.conductance);
        memory_.advance_faces(q, u_new - u);
        faces.velocity[q] = u_new;
      } else {
        faces.velocity[q] = momentum / (rho + f);
      }
      faces.friction_coefficient[q] = f;
      faces.nusselt[q] = friction.nusselt;
      left = next;
      previous = u;
      u = u_next;
    }
  }

  [[gnu::noinline]] void find_inner_fluxes() noexcept {
    const auto& k = group_k_;
    const CellRow cells_in(cell_);
    const FaceRow faces(face_);
    const int groups = inner_face_groups();
    const G coldest = k.sound_factor *
                      G(line_scheme::coldest_K);  // the sound speed of the coldest gas there is; mending looks closer
    auto left = cells_in[0];
    auto subsonic = G(0) == G(0);
    for (int q = 1; q <= groups; ++q) {
      const auto next = cells_in[q];
      const auto right = line_scheme::one_cell_after<S>(left, next);
      line_scheme::Face<G> face;
      face.velocity = faces.velocity[q];
      subsonic = subsonic & (face.velocity * face.velocity <= coldest);
      line_scheme::inner_flux(face, left, right);
      faces.mass_flux[q] = face.mass_flux;
      faces.pressure_flux[q] = face.pressure_flux;
      left = next;
    }
    if (!all(subsonic)) [[unlikely]]
      mend_inner_faces();
  }

  // The speed limit, where some inner face has broken it; cells are still the old ones.
  [[gnu::noinline, gnu::cold]] void mend_inner_faces() noexcept {
    for (int j = 1; j < cells_; ++j) {
      const Cell left = cell(j - 1), right = cell(j);
      Face mended;
      mended.velocity = velocity(j);
      limit_speed(mended, temperature(left), temperature(right));
      line_scheme::inner_flux(mended, left, right);
      set_element<S>(face_.velocity[face_group(j)], face_place(j), mended.velocity);
      set_element<S>(face_.mass_flux[face_group(j)], face_place(j), mended.mass_flux);
      set_element<S>(face_.pressure_flux[face_group(j)], face_place(j), mended.pressure_flux);
    }
    memory_.mend();
  }

  template <bool losing, bool remembering> [[gnu::noinline]] void find_balances() noexcept {
    const auto& k = group_k_;
    const CellRow row(cell_);
    const FaceRow faces(face_);
    const int groups = cell_groups();
    auto previous = faces[0];
    G fastest = previous.velocity * previous.velocity, previous_heat = previous.friction_coefficient * fastest;
    for (int q = 0; q < groups; ++q) {
      const auto right = faces[q + 1];
      const G squared = right.velocity * right.velocity, heat = right.friction_coefficient * squared;
      fastest = maximum(fastest, squared);
      const line_scheme::CellLoss<G>* loss = nullptr;
      if constexpr (losing) loss = &losses_.in_cells(q);
      const WallAnswer<G>* memory = nullptr;
      WallAnswer<G> wall{};
      if constexpr (remembering) {
        const G RT = row.pressure_per_density[q];
        wall = memory_.in_cells(q, line_scheme::heat_diffusion(k, RT), RT);
        memory = &wall;
      }
      const auto made = line_scheme::balance(k, row[q], line_scheme::one_face_before<S>(previous, right), right,
                                             one_before<S>(previous_heat, heat), heat, loss, memory);
      row.density[q] = made.density;
      row.a[q] = made.a;
      row.d[q] = made.d;
      previous = right;
      previous_heat = heat;
    }
    fastest_squared_ = fastest;
  }

  template <bool remembering> [[gnu::noinline]] void find_states() noexcept {
    const auto& k = group_k_;
    const CellRow row(cell_);
    const int groups = cell_groups();
    auto sound = G(0) == G(0);
    for (int q = 0; q < groups; ++q) {
      const auto made = line_scheme::state_of(row.density[q], row.a[q], row.d[q]);
      sound = sound & line_scheme::sound_cell(k, made);
      if constexpr (remembering) memory_.advance_cells(q, made.pressure_per_density - row.pressure_per_density[q]);
      row.pressure[q] = made.pressure;
      row.pressure_per_density[q] = made.pressure_per_density;
      row.density_per_pressure[q] = made.density_per_pressure;
    }
    if (!all(sound)) [[unlikely]]
      mend_cells();
    fill_places_beyond();
  }

  // Places beyond the last cell repeat it.
  void fill_places_beyond() noexcept {
    if constexpr (per_group > 1) {
      const Cell last = cell(cells_ - 1);
      cell_.fill(static_cast<std::size_t>(cell_groups() - 1), beyond_last_, last);
      cell_.fill(static_cast<std::size_t>(cell_groups()), all_places_, last);
    }
  }
  void arrange(int cells) {
    cells_ = cells;
    cell_.resize(static_cast<std::size_t>(cell_groups()) + 1);
    face_.resize(static_cast<std::size_t>(cell_groups()) + 2);
    losses_.resize(static_cast<std::size_t>(cell_groups()));
    memory_.resize(static_cast<std::size_t>(cell_groups()) + 1, static_cast<std::size_t>(cell_groups()));
    all_places_ = places_from<S>(0);
    from_end_ = places_from<S>(face_place(cells));
    beyond_last_ = places_from<S>(cells % per_group == 0 ? per_group : cells % per_group);
  }

  template <bool remembering>
  [[gnu::always_inline]] Face end_face(const S& rho, const S& u, const S& du, const S& dp, End end) const noexcept {
    const auto friction = k_.friction(line_scheme::reynolds(k_, rho, u));
    S momentum = line_scheme::momentum(k_, rho, u, du, dp);
    Face made;
    made.friction_coefficient = friction.lambda_reynolds;
    made.nusselt = friction.nusselt;
    made.inertia = rho + made.friction_coefficient;
    if constexpr (remembering) {
      const WallAnswer<S> wall = memory_.at_end(end, u);
      made.inertia += wall.conductance;
      momentum += wall.source;
    }
    made.velocity = momentum / made.inertia;
    return made;
  }
  // Of the line's mean density, temperature and speed.
  void find_layers() noexcept {
    S density(0), RT(0), speed(0);
    for (int i = 0; i < cells_; ++i) {
      density += cell(i).density;
      RT += cell(i).pressure_per_density;
      speed += absolute(velocity(i));
    }
    const S share = S(1) / S(cells_);
    density *= share;
    memory_.set_layers({k_.flow_diffusion, line_scheme::heat_diffusion(k_, share * RT), density, air_.cp,
                        k_.friction.renewal(line_scheme::reynolds(k_, density, share * speed))});
  }
  // The end faces are half a cell from the first and last pressures: twice the gradient; density of the gas that moves.
  template <bool remembering, class PortFlux>
  [[gnu::always_inline]] Face port_face(const Cell& first, const S& u, const S& u_after,
                                        PortFlux&& port_flux) noexcept {
    const S rho = select(u > S(0), port_pressure_ * k_.inverse_wall_pressure_per_density, first.density);
    Face made = end_face<remembering>(rho, u, select(u > S(0), S(0), u_after - u),
                                      S(2) * (first.pressure - port_pressure_), End::port);
    port_flux(made, first);
    return made;
  }
  template <bool remembering>
  [[gnu::always_inline]] Face chamber_face(const Cell& last, const S& u_before, const S& u,
                                           const ChamberEnd<S>& chamber) noexcept {
    const S rho = select(u < S(0),
                         fittings_.face_pressure(u >= S(0), last.pressure, chamber.pressure_Pa) /
                             (air_.R * chamber.temperature_K),
                         last.density);
    Face made = end_face<remembering>(rho, u, select(u > S(0), u - u_before, S(0)),
                                      S(2) * (chamber.pressure_Pa - last.pressure), End::chamber);
    if (fittings_.are_present()) apply_restriction(made, last, u, rho, chamber);
    limit_speed(made, temperature(last), chamber.temperature_K);
    return made;
  }

  // |u| <= sound speed of the gas that moves: chokes the ends and tames a jump of a prescribed port pressure.
  [[gnu::always_inline]] void limit_speed(Face& face, const S& T_left, const S& T_right) noexcept {
    const S limit = k_.sound_factor * select(face.velocity > S(0), T_left, T_right);
    if (all(face.velocity * face.velocity <= limit)) [[likely]]
      return;
    const S sound = square_root(limit);
    const auto bad = !(absolute(face.velocity) <= sound);
    guard_actions_ += count(bad);
    face.velocity = select(is_number(face.velocity), clamp(face.velocity, -sound, sound), S(0));
  }

  // Gas that enters has the static temperature T_stagnation - u^2/(2 c_p).
  S inflow_density_per_pressure(const S& stagnation_K, const S& u) const noexcept {
    return S(1) / (air_.R * (stagnation_K - u * u * k_.half_inverse_cp));
  }

  [[gnu::always_inline]] void prescribed_port_flux(Face& face, const Cell& first) noexcept {
    limit_speed(face, air_.temperature_K, temperature(first));
    const S u = face.velocity;
    const auto enters = u > S(0);
    face.pressure_flux =
        select(enters, port_pressure_, line_scheme::limited_face_pressure(port_pressure_, first.pressure)) * u;
    face.mass_flux = face.pressure_flux *
                     select(enters, inflow_density_per_pressure(air_.temperature_K, u), first.density_per_pressure);
  }

  // u = u* + K p and A rho_b(p) u = G_supply(p) - G_exhaust(p); the momentum step was taken with the last port
  // pressure.
  void valve_port_flux(const ValvePort<S>& valve, Face& face, const Cell& first) noexcept {
    const S K = S(2) * k_.grid_ratio / face.inertia;
    const S T_first = temperature(first), c = square_root(k_.sound_factor * maximum(T_first, air_.temperature_K));
    const PortSolution<S> port =
        solve_valve_port(port_constants_, air_, valve, cross_section_, face.velocity - K * port_pressure_, K, c,
                         first.density, T_first, S(2) * port_pressure_ - port_before_);
    port_before_ = port_pressure_;
    port_pressure_ = port.pressure_Pa;
    face.velocity = port.velocity_mps;
    limit_speed(face, air_.temperature_K, temperature(first));
    face.mass_flux = port.mass_flow_kgps / cross_section_;
    const S T_flow =
        select(face.mass_flux > S(0), air_.temperature_K - face.velocity * face.velocity * k_.half_inverse_cp, T_first);
    face.pressure_flux = face.mass_flux * air_.R * T_flow;
  }

  // Fitting between line end and chamber, implicit: u + k P (1 - sqrt(1 - (u/c)^2)) = u_free with the ellipse of the
  // orifice, P = p_up (1 - b), c the velocity of its sonic flow. Squared it is a quadratic in u/c.
  void apply_restriction(Face& face, const Cell& last, const S& u_old, const S& rho,
                         const ChamberEnd<S>& chamber) noexcept {
    const auto outward = face.velocity > S(0);
    const S area = fittings_.area_m2(outward);
    const auto fitted = area > S(0);
    const S p_up = select(outward, maximum(last.pressure, chamber.pressure_Pa), chamber.pressure_Pa);
    const S T_up = select(outward, temperature(last) + u_old * u_old * k_.half_inverse_cp, chamber.temperature_K);
    const S sonic =
        air_.flow_constant * select(fitted, area, S(1)) * p_up / square_root(air_.R * T_up) / (rho * cross_section_);
    const S drop = S(2) * k_.grid_ratio / face.inertia * p_up * (S(1) - effects_.critical_pressure_ratio);
    const S d = drop - minimum(absolute(face.velocity), sonic + drop);
    const S square = sonic * sonic + drop * drop;
    const S share = (drop * square_root(square - d * d) - sonic * d) / square;
    face.velocity = select(fitted, select(outward, sonic * share, -sonic * share), face.velocity);
  }
  // Flux at the chamber; returns the stagnation enthalpy flux into the chamber [W/m2]. What leaves is what the last
  // cell gives away: internal energy, the work p u of its own pressure and the kinetic energy that came to it, less
  // what it keeps as heat of the end face: whatever chokes or bends the end, no energy is made or lost there in steady
  // flow.
  [[gnu::always_inline]] S chamber_end_flux(Face& end, const Cell& last, const S& u_before,
                                            const ChamberEnd<S>& chamber) const noexcept {
    const S u = end.velocity;
    const auto enters = u < S(0);  // from the chamber into the line
    const S p = fittings_.face_pressure(u >= S(0), last.pressure, chamber.pressure_Pa);
    end.pressure_flux = select(enters, p, line_scheme::limited_face_pressure(p, last.pressure)) * u;
    end.mass_flux = end.pressure_flux *
                    select(enters, inflow_density_per_pressure(chamber.temperature_K, u), last.density_per_pressure);
    const S kept = k_.half_inverse_grid_ratio * (end.friction_coefficient * u * u);
    const S leaves =
        end.mass_flux * (air_.cv * temperature(last) + S(0.5) * u_before * u_before) + last.pressure * u - kept;
    return select(enters, end.mass_flux * air_.cp * chamber.temperature_K, leaves);
  }

  // The bounds of density and temperature, where some cell has broken them.
  [[gnu::noinline, gnu::cold]] void mend_cells() noexcept {
    for (int i = 0; i < cells_; ++i) {
      Cell c = cell(i);
      const S RT = c.pressure_per_density;
      const auto thin = !(c.density >= S(line_scheme::thinnest_kg_per_m3));
      const auto outside = !((RT >= k_.coldest) & (RT <= k_.hottest));
      guard_actions_ += count(thin) + count(outside);
      const auto mend = thin | outside;
      const S RT_mended = select(is_number(RT), clamp(RT, k_.coldest, k_.hottest), k_.wall_pressure_per_density);
      c.density = select(thin, S(line_scheme::thinnest_kg_per_m3), c.density);
      c.pressure_per_density = select(mend, RT_mended, RT);
      c.pressure = select(mend, c.density * RT_mended, c.pressure);
      c.density_per_pressure = select(mend, S(1) / RT_mended, c.density_per_pressure);
      set_cell(i, c);
    }
    memory_.mend();
  }

  double step_s_ = 1e-3;
  Air<S> air_;
  S length_{}, diameter_{}, cross_section_{};
  PipeFriction<S> friction_;
  Constants k_;
  LineEffects<S> effects_;
  EndFittings<S> fittings_;
  bool adiabatic_ = false, isothermal_ = false, frictionless_ = false;
  line_scheme::Constants<G> group_k_;
  int cells_ = 1;
  line_scheme::Cells<S> cell_;
  line_scheme::Faces<S> face_;
  LineLosses<S> losses_;
  LineMemory<S> memory_;
  Mask<G> all_places_{}, from_end_{}, beyond_last_{};
  Face port_face_, chamber_face_;  // of the step under way
  PortConstants<S> port_constants_;
  S port_pressure_{}, port_before_{};
  G fastest_squared_{};
  std::int64_t guard_actions_ = 0;
};

/// Packs wider than a register have a line of their own: include <pneuservo/elements/wide_line.hpp> for them.
template <class T, int N>
  requires(!detail::single_register<T, N>)
class Line<Pack<T, N>>;

}  // namespace pneuservo
