// Storage of the line's staggered grid: rows of cells and faces, several neighbours in a group.
#pragma once
#include <vector>

#include <pneuservo/core/group.hpp>
#include <pneuservo/elements/line_scheme.hpp>

namespace pneuservo::line_scheme {

/// Cells in rows, one a quantity, in groups of neighbours.
template <class S> struct Cells {
  using G = Group<S>;
  std::vector<G> pressure, density, pressure_per_density, density_per_pressure, a, d;  // R T = a/d

  void resize(std::size_t groups) {
    for (auto* row : {&pressure, &density, &pressure_per_density, &density_per_pressure, &a, &d})
      row->assign(groups, G(0));
  }
  Cell<G> group(std::size_t q) const noexcept {
    return {pressure[q], density[q], pressure_per_density[q], density_per_pressure[q]};
  }
  void fill(std::size_t q, const Mask<G>& places, const Cell<S>& with) noexcept {
    pressure[q] = select(places, replicate(with.pressure), pressure[q]);
    density[q] = select(places, replicate(with.density), density[q]);
    pressure_per_density[q] = select(places, replicate(with.pressure_per_density), pressure_per_density[q]);
    density_per_pressure[q] = select(places, replicate(with.density_per_pressure), density_per_pressure[q]);
  }
};
/// Faces, likewise; density and Reynolds number belong to the step under way.
template <class S> struct Faces {
  using G = Group<S>;
  std::vector<G> velocity, mass_flux, pressure_flux, friction_coefficient, nusselt, density, reynolds, reynolds_root;

  void resize(std::size_t groups) {
    for (auto* row :
         {&velocity, &mass_flux, &pressure_flux, &friction_coefficient, &nusselt, &density, &reynolds, &reynolds_root})
      row->assign(groups, G(0));
  }
  void fill(std::size_t q, const Mask<G>& places, const Face<S>& with) noexcept {
    velocity[q] = select(places, replicate(with.velocity), velocity[q]);
    mass_flux[q] = select(places, replicate(with.mass_flux), mass_flux[q]);
    pressure_flux[q] = select(places, replicate(with.pressure_flux), pressure_flux[q]);
    friction_coefficient[q] = select(places, replicate(with.friction_coefficient), friction_coefficient[q]);
    nusselt[q] = select(places, replicate(with.nusselt), nusselt[q]);
  }
};
/// The rows' addresses, held in registers during a pass.
template <class S> struct CellRow {
  using G = Group<S>;
  explicit CellRow(Cells<S>& c) noexcept
      : pressure(c.pressure.data()), density(c.density.data()), pressure_per_density(c.pressure_per_density.data()),
        density_per_pressure(c.density_per_pressure.data()), a(c.a.data()), d(c.d.data()) {}
  Cell<G> operator[](int q) const noexcept {
    return {pressure[q], density[q], pressure_per_density[q], density_per_pressure[q]};
  }
  G *const pressure, *const density, *const pressure_per_density, *const density_per_pressure, *const a, *const d;
};
template <class S> struct FaceRow {
  using G = Group<S>;
  explicit FaceRow(Faces<S>& f) noexcept
      : velocity(f.velocity.data()), mass_flux(f.mass_flux.data()), pressure_flux(f.pressure_flux.data()),
        friction_coefficient(f.friction_coefficient.data()), nusselt(f.nusselt.data()), density(f.density.data()),
        reynolds(f.reynolds.data()), reynolds_root(f.reynolds_root.data()) {}
  Face<G> operator[](int q) const noexcept {
    return {velocity[q], mass_flux[q], pressure_flux[q], friction_coefficient[q], nusselt[q]};
  }
  G *const velocity, *const mass_flux, *const pressure_flux,
                                           *const friction_coefficient,
                                               *const nusselt, *const density, *const reynolds, *const reynolds_root;
};
/// Every cell's neighbour behind it.
template <class S> Cell<Group<S>> one_cell_after(const Cell<Group<S>>& c, const Cell<Group<S>>& next) noexcept {
  return {one_after<S>(c.pressure, next.pressure), one_after<S>(c.density, next.density),
          one_after<S>(c.pressure_per_density, next.pressure_per_density),
          one_after<S>(c.density_per_pressure, next.density_per_pressure)};
}
/// Every face's neighbour before it; its friction stays its own.
template <class S>
Face<Group<S>> one_face_before(const Face<Group<S>>& previous, const Face<Group<S>>& f) noexcept {
  return {one_before<S>(previous.velocity, f.velocity), one_before<S>(previous.mass_flux, f.mass_flux),
          one_before<S>(previous.pressure_flux, f.pressure_flux), f.friction_coefficient,
          one_before<S>(previous.nusselt, f.nusselt)};
}

}  // namespace pneuservo::line_scheme
