// What a line loses along its length, beside its ends: a leak, dead-end branches, what a hose that swells stores, an
// imposed inflow.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include <pneuservo/core/scalar.hpp>
#include <pneuservo/elements/branch.hpp>
#include <pneuservo/elements/line_ends.hpp>
#include <pneuservo/elements/line_scheme.hpp>
#include <pneuservo/elements/orifice.hpp>

namespace pneuservo {

/// The state of these effects; what they take from each cell in a step goes into the cells' balances. Their parameters
/// are the line's, which each step takes as an argument beside them; of it the public interface alone is used.
template <class S> class LineLosses {
 public:
  using CellLoss = line_scheme::CellLoss<Group<S>>;
  using Constants = line_scheme::Constants<S>;

  /// Allocates.
  void resize(std::size_t cell_groups) {
    loss_.assign(cell_groups, {});
    swollen_.assign(cell_groups * static_cast<std::size_t>(GroupOf<S>::elements), {});
  }
  /// Which of them the line has from now on.
  void set_effects(const LineEffects<S>& effects) noexcept {
    leaking_ = any(effects.leak.area_m2 > S(0));
    branched_ = any(effects.branch.volume_m3 > S(0));
    has_port_volume_ = any(effects.port_volume.volume_m3 > S(0));
    swells_ = any(effects.compliance.section_growth_per_Pa > S(0));
    is_swollen_ = false;
    leak_flow_ = S(0);
  }
  /// Gas that comes into the middle of the line from here on [kg/s]; negative: is taken.
  void set_inflow(const S& inflow_kgps) noexcept {
    inflow_ = inflow_kgps;
    fed_ = true;
  }
  bool are_present() const noexcept { return leaking_ || branched_ || has_port_volume_ || swells_ || fed_; }

  /// Gas at rest in the branches.
  void reset(const S& pressure_Pa, const S& density_kg_per_m3) noexcept {
    branch_.reset(pressure_Pa, density_kg_per_m3);
    port_volume_.reset(pressure_Pa, density_kg_per_m3);
    is_swollen_ = false;
  }
  /// Multiplies pressure and temperature of the gas in the branches.
  void scale_gas(const S& pressure, const S& temperature) noexcept {
    branch_.scale_gas(pressure, temperature);
    port_volume_.scale_gas(pressure, temperature);
    is_swollen_ = false;
  }

  /// One sub-step beside the line as it stands, its faces already at their new velocities.
  template <class Line>
  void step(const Line& line, const LineEffects<S>& effects, const Constants& k, double step_s) noexcept {
    std::fill(loss_.begin(), loss_.end(), CellLoss{});
    if (leaking_) step_leak(line, effects, k, step_s);
    if (branched_) step_branch(line, branch_, effects.branch, k, step_s);
    if (has_port_volume_) step_branch(line, port_volume_, effects.port_volume.as_branch(), k, step_s);
    if (swells_) step_compliance(line, effects.compliance.section_growth_per_Pa, k);
    if (fed_) step_inflow(line, k, step_s);
  }
  /// What the last sub-step took from a group of cells.
  const CellLoss& in_cells(int group) const noexcept { return loss_[static_cast<std::size_t>(group)]; }

  /// Mass flow lost through the leak in the last sub-step [kg/s].
  S leak_mass_flow() const noexcept { return leak_flow_; }
  /// Gas behind the necks of branch and port [kg].
  S branch_mass(const LineEffects<S>& effects) const noexcept {
    return branch_.mass(effects.branch) + port_volume_.mass(effects.port_volume.as_branch());
  }

  /// Gas that the line holds beyond its bore at the start [kg]; negative where the pressure has fallen.
  template <class Line> S swollen_mass(const Line& line) const noexcept {
    S sum(0);
    if (is_swollen_)
      for (int i = 0; i < line.cells(); ++i) sum += swollen_[static_cast<std::size_t>(i)].density;
    return sum * line.cross_section() * line.cell_length();
  }

 private:
  // What a cell holds beyond its bore at the start, over the volume of that; its pressure stands for the energy.
  struct Swollen {
    S density{}, pressure{}, share{}, start_Pa{};
  };
  // The gas beyond the bore has the state of its cell. Its change within the step is foretold as an adiabatic one,
  // which keeps the wave of a soft hose stable; the next step books what that missed.
  template <class Line> void step_compliance(const Line& line, const S& growth_per_Pa, const Constants& k) noexcept {
    constexpr int per_group = GroupOf<S>::elements;
    const Air<S>& air = line.air();
    for (int i = 0; i < line.cells(); ++i) {
      const S p = line.cell_pressure(i), rho = line.cell_density(i);
      Swollen& held = swollen_[static_cast<std::size_t>(i)];
      if (!is_swollen_) held = {S(0), S(0), S(0), p};
      const S share = growth_per_Pa * (p - held.start_Pa);
      const S spread = k.grid_ratio * (line.face_velocity(i + 1) - line.face_velocity(i));
      const S change = -air.kappa * spread / (S(1) + share + air.kappa * p * growth_per_Pa);  // of p over p
      const S p_new = p * (S(1) + change), share_new = share + growth_per_Pa * p * change;
      const Swollen next{rho * (S(1) + change / air.kappa) * share_new, p_new * share_new, share_new, held.start_Pa};
      CellLoss& loss = loss_[static_cast<std::size_t>(i / per_group)];
      const int at = i % per_group;
      const S work = k.kappa_minus_one * S(0.5) * (p + p_new) * (next.share - held.share);
      set_element<S>(loss.density, at, element<S>(loss.density, at) + next.density - held.density);
      set_element<S>(loss.pressure, at, element<S>(loss.pressure, at) + next.pressure - held.pressure + work);
      held = next;
    }
    is_swollen_ = true;
  }
  // Orifice to atmosphere in the cell that holds the leak's position.
  template <class Line>
  void step_leak(const Line& line, const LineEffects<S>& effects, const Constants& k, double step_s) noexcept {
    const Air<S>& air = line.air();
    const S place = minimum(effects.leak.position * S(line.cells()), S(line.cells() - 0.5));
    leak_flow_ = S(0);
    for (int i = 0; i < line.cells(); ++i) {
      const S share = select((place >= S(i)) & (place < S(i + 1)), S(1), S(0));
      const S u = S(0.5) * (line.face_velocity(i) + line.face_velocity(i + 1)), T = line.cell_temperature(i);
      const S stagnation_K = T + u * u * k.half_inverse_cp;
      const S flow = orifice_mass_flow(air, effects.leak.area_m2 * share, effects.critical_pressure_ratio,
                                       line.cell_pressure(i), stagnation_K, air.atmosphere_Pa, air.temperature_K);
      leak_flow_ += flow;
      add(i, air.cp, k, flow * S(step_s) / (line.cross_section() * line.cell_length()), T);
    }
  }

  // A branch shares its flow between the two cells whose middles lie beside it.
  template <class Line>
  void step_branch(const Line& line, Branch<S>& gas, const LineBranch<S>& branch, const Constants& k,
                   double step_s) noexcept {
    const int n = line.cells();
    const S place = clamp(branch.position * S(n) - S(0.5), S(0), S(n - 1));
    const auto share = [&](int i) { return maximum(S(0), S(1) - absolute(place - S(i))); };
    S pressure(0), density(0);
    for (int i = 0; i < n; ++i) {
      pressure += share(i) * line.cell_pressure(i);
      density += share(i) * line.cell_density(i);
    }
    const Air<S>& air = line.air();
    const S cell_volume = line.cross_section() * line.cell_length(), from_branch_K = gas.temperature(air);
    const S flow = gas.step(branch, air, line.friction(), step_s, {pressure, density, cell_volume});
    for (int i = 0; i < n; ++i)
      add(i, air.cp, k, share(i) * flow * S(step_s) / cell_volume,
          select(flow > S(0), line.cell_temperature(i), from_branch_K));
  }

  // The middle cells take the inflow at their own temperature.
  template <class Line> void step_inflow(const Line& line, const Constants& k, double step_s) noexcept {
    const int n = line.cells(), first = (n - 1) / 2, last = n / 2;
    const S each = inflow_ * S(-step_s / (last - first + 1)) / (line.cross_section() * line.cell_length());
    for (int i = first; i <= last; ++i) add(i, line.air().cp, k, each, line.cell_temperature(i));
  }

  // What cell i loses in this sub-step [kg/m3], with the enthalpy of gas of temperature_K from its internal energy (the
  // gas's kinetic energy is not part of that).
  void add(int i, const S& cp, const Constants& k, const S& density, const S& temperature_K) noexcept {
    constexpr int per_group = GroupOf<S>::elements;
    CellLoss& loss = loss_[static_cast<std::size_t>(i / per_group)];
    const int at = i % per_group;
    set_element<S>(loss.density, at, element<S>(loss.density, at) + density);
    set_element<S>(loss.pressure, at, element<S>(loss.pressure, at) + density * k.kappa_minus_one * cp * temperature_K);
  }

  S leak_flow_{}, inflow_{};
  Branch<S> branch_, port_volume_;
  std::vector<CellLoss> loss_;
  std::vector<Swollen> swollen_;
  bool leaking_ = false, branched_ = false, has_port_volume_ = false, swells_ = false, is_swollen_ = false,
       fed_ = false;
};

}  // namespace pneuservo
