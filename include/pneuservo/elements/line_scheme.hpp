// The equations of the line's staggered grid for one cell and one face, on any scalar (thesis 3.2 to 3.10).
#pragma once
#include <pneuservo/core/group.hpp>
#include <pneuservo/elements/pipe_friction.hpp>
#include <pneuservo/elements/wall_memory.hpp>

namespace pneuservo::line_scheme {

template <class V> struct Cell {
  V pressure{}, density{}, temperature{}, density_per_pressure{};  // the last is 1/(R T)
};
/// A face after its momentum step, with what it carries: m [kg/(m2 s)], z = p u (z/(kappa-1) is internal energy).
template <class V> struct Face {
  V velocity{}, mass_flux{}, pressure_flux{}, friction_coefficient{}, nusselt{};
  V inertia{};  ///< of an end face: what divides its momentum
};

/// What does not change within a step; a = h/dx is the grid ratio.
template <class V> struct Constants {
  V grid_ratio, reynolds_factor, friction_factor, wall_slope, wall_offset, heat_share, compression_factor;
  V kappa_minus_one, cv, inverse_R, wall_pressure_factor, sound_factor, inverse_wall_factor, half_inverse_cp,
      half_inverse_grid_ratio;
  PipeFriction<V> friction;
};
template <class S> Constants<Group<S>> replicate_constants(const Constants<S>& k) noexcept {
  return {replicate(k.grid_ratio),
          replicate(k.reynolds_factor),
          replicate(k.friction_factor),
          replicate(k.wall_slope),
          replicate(k.wall_offset),
          replicate(k.heat_share),
          replicate(k.compression_factor),
          replicate(k.kappa_minus_one),
          replicate(k.cv),
          replicate(k.inverse_R),
          replicate(k.wall_pressure_factor),
          replicate(k.sound_factor),
          replicate(k.inverse_wall_factor),
          replicate(k.half_inverse_cp),
          replicate(k.half_inverse_grid_ratio),
          k.friction.template grouped<Group<S>>()};
}

template <class V> [[gnu::always_inline]] inline V reynolds(const Constants<V>& k, const V& rho, const V& u) noexcept {
  return rho * absolute(u) * k.reynolds_factor;
}

/// Momentum rho (u - a u du) - a dp, du upwind; over rho + f, the friction implicit, it is the new velocity.
template <class V> [[gnu::always_inline]] inline V momentum(const Constants<V>& k, const V& rho, const V& u,
                                                            const V& du, const V& dp) noexcept {
  return rho * (u - k.grid_ratio * (u * du)) - k.grid_ratio * dp;
}

/// mu h/R^2, of friction_factor.
template <class V> [[gnu::always_inline]] inline V flow_diffusion(const Constants<V>& k) noexcept {
  return V(8) * k.friction_factor;
}
/// k h/R^2, of which the wall's slope and offset are half.
template <class V> [[gnu::always_inline]] inline V heat_diffusion(const Constants<V>& k, const V& T) noexcept {
  return V(2) * (k.wall_slope * T + k.wall_offset);
}

/// Face pressure centred, but within 10 % of the upwind cell's: a shock must not carry energy the cell does not have.
template <class V> [[gnu::always_inline]] inline V limited_face_pressure(const V& centred, const V& upwind) noexcept {
  const V band = V(0.1) * upwind;
  return upwind + clamp(centred - upwind, -band, band);
}
template <class V> [[gnu::always_inline]] inline void inner_flux(Face<V>& face, const Cell<V>& a,
                                                                 const Cell<V>& b) noexcept {
  const auto forward = face.velocity > V(0);
  const V p_up = select(forward, a.pressure, b.pressure);
  const V s_up = select(forward, a.density_per_pressure, b.density_per_pressure);
  face.pressure_flux = limited_face_pressure(V(0.5) * (a.pressure + b.pressure), p_up) * face.velocity;
  face.mass_flux = s_up * face.pressure_flux;
}

/// What a leak takes from a cell in a step.
template <class V> struct CellLoss {
  V density{}, pressure{};
};

/// Mass and energy of a cell: compression trapezoidal, wall heat implicit, friction heat of both faces. p = a/d.
template <class V> struct Balance {
  V density, a, d;
};
template <class V>
[[gnu::always_inline]] inline Balance<V> balance(const Constants<V>& k, const Cell<V>& cell, const Face<V>& left,
                                                 const Face<V>& right, const V& left_heat, const V& right_heat,
                                                 const CellLoss<V>* loss, const WallAnswer<V>* memory) noexcept {
  V rho = cell.density - k.grid_ratio * (right.mass_flux - left.mass_flux);
  const V b = k.compression_factor * (right.velocity - left.velocity);
  const V one_plus = V(1) + b;
  V x = cell.pressure * (V(1) - b) - k.grid_ratio * (right.pressure_flux - left.pressure_flux);
  if (loss != nullptr) {
    rho -= loss->density;
    x -= loss->pressure;
  }
  const V heat = k.heat_share * (left_heat + right_heat);
  const V wall = (left.nusselt + right.nusselt) * (k.wall_slope * cell.temperature + k.wall_offset);
  const V rho_cv = rho * k.cv;
  if (memory != nullptr)
    return {rho,
            rho_cv * (x + one_plus * heat) + one_plus * (wall * (rho * k.wall_pressure_factor) + rho * memory->source),
            one_plus * (rho_cv + wall + memory->conductance)};
  return {rho, rho_cv * (x + one_plus * heat) + one_plus * (wall * (rho * k.wall_pressure_factor)),
          one_plus * (rho_cv + wall)};
}
/// p = a/d, T = p/(rho R) and 1/(R T) = rho/p all come from the one division 1/(rho a d).
template <class V> [[gnu::always_inline]] inline Cell<V> state_of(const Constants<V>& k, const V& rho, const V& a,
                                                                  const V& d) noexcept {
  const V reciprocal = V(1) / (rho * (a * d));
  const V a_squared_r = a * a * reciprocal;
  return {rho * a_squared_r, rho, a_squared_r * k.inverse_R, rho * rho * (d * d * reciprocal)};
}

/// Where the guards let a cell pass.
template <class V> [[gnu::always_inline]] inline Mask<V> sound_cell(const Cell<V>& cell) noexcept {
  return (cell.density >= V(1e-3)) & (cell.temperature >= V(150)) & (cell.temperature <= V(600));
}

}  // namespace pneuservo::line_scheme
