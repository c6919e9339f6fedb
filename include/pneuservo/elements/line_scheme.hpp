// The equations of the line's staggered grid for one cell and one face, on any scalar (thesis 3.2 to 3.10).
#pragma once
#include <pneuservo/core/group.hpp>
#include <pneuservo/elements/pipe_friction.hpp>
#include <pneuservo/elements/wall_memory.hpp>

namespace pneuservo::line_scheme {

/// The guards' bounds of a cell.
inline constexpr double thinnest_kg_per_m3 = 1e-3, coldest_K = 150, hottest_K = 600;

template <class V> struct Cell {
  V pressure{}, density{}, pressure_per_density{}, density_per_pressure{};  // the last two are R T and 1/(R T)
};
/// A face after its momentum step, with what it carries: m [kg/(m2 s)], z = p u (z/(kappa-1) is internal energy).
template <class V> struct Face {
  V velocity{}, mass_flux{}, pressure_flux{}, friction_coefficient{}, nusselt{};
  V inertia{};  ///< of an end face: what divides its momentum
};

/// What does not change within a step; a = h/dx is the grid ratio. What multiplies is multiplied out beforehand: the
/// passes are bound by what multiplies and divides.
template <class V> struct Constants {
  V grid_ratio, reynolds_factor, heat_share, compression_factor;
  V flow_diffusion;  ///< mu h/R^2
  V wall_slope, wall_offset;  ///< h/(2 c_v R^2) of the gas's conductivity, over R T
  V wall_pressure_per_density, inverse_wall_pressure_per_density;  ///< R T_wall
  V coldest, hottest;  ///< the guards' bounds of R T
  V kappa_minus_one, cv, inverse_cv, inverse_R, sound_factor, half_inverse_cp, half_inverse_grid_ratio;
  PipeFriction<V> friction;  ///< phi mu h/(2 D^2)
};
template <class S> Constants<Group<S>> replicate_constants(const Constants<S>& k) noexcept {
  return {replicate(k.grid_ratio),
          replicate(k.reynolds_factor),
          replicate(k.heat_share),
          replicate(k.compression_factor),
          replicate(k.flow_diffusion),
          replicate(k.wall_slope),
          replicate(k.wall_offset),
          replicate(k.wall_pressure_per_density),
          replicate(k.inverse_wall_pressure_per_density),
          replicate(k.coldest),
          replicate(k.hottest),
          replicate(k.kappa_minus_one),
          replicate(k.cv),
          replicate(k.inverse_cv),
          replicate(k.inverse_R),
          replicate(k.sound_factor),
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
  const V m = rho * u;
  return m - k.grid_ratio * (m * du + dp);
}

/// k h/R^2, of which the wall's slope and offset are half, over c_v.
template <class V> [[gnu::always_inline]] inline V heat_diffusion(const Constants<V>& k, const V& RT) noexcept {
  return V(2) * k.cv * (k.wall_slope * RT + k.wall_offset);
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

/// Mass and energy of a cell: compression trapezoidal, wall heat implicit, friction heat of both faces. R T = a/d.
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
  const V wall = (left.nusselt + right.nusselt) * (k.wall_slope * cell.pressure_per_density + k.wall_offset);
  V heat = k.heat_share * (left_heat + right_heat) + wall * k.wall_pressure_per_density, capacity = rho + wall;
  if (memory != nullptr) {
    heat += memory->source * k.inverse_cv;
    capacity += memory->conductance * k.inverse_cv;
  }
  return {rho, x + one_plus * heat, one_plus * capacity};
}
/// p = rho R T, R T = a/d and 1/(R T) = d/a all come from the one division 1/(a d).
template <class V> [[gnu::always_inline]] inline Cell<V> state_of(const V& rho, const V& a, const V& d) noexcept {
  const V reciprocal = V(1) / (a * d), RT = a * a * reciprocal;
  return {rho * RT, rho, RT, d * d * reciprocal};
}

/// Where the guards let a cell pass.
template <class V> [[gnu::always_inline]] inline Mask<V> sound_cell(const Constants<V>& k,
                                                                    const Cell<V>& cell) noexcept {
  return (cell.density >= V(thinnest_kg_per_m3)) & (cell.pressure_per_density >= k.coldest) &
         (cell.pressure_per_density <= k.hottest);
}

}  // namespace pneuservo::line_scheme
