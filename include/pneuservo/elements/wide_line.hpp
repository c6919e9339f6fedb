// Line on a pack wider than a register: two lines on the halves of its lanes.
#pragma once
#include <pneuservo/elements/line.hpp>

namespace pneuservo {

/// Lines in lanes do not see each other, so the halves are computed one after the other: all that a pass keeps in
/// registers would not fit twice.
template <class T, int N>
  requires(!detail::single_register<T, N>)
class Line<Pack<T, N>> : public LineSteps<Line<Pack<T, N>>, Pack<T, N>> {
 public:
  using S = Pack<T, N>;

  void configure(const LineParameters<S>& line, const AirParameters<S>& air_parameters, int cells) {
    air_ = Air<S>(air_parameters);
    length_ = line.length_m;
    low_.configure(half_of<LineParameters<Half>, false>(line), half_of<AirParameters<Half>, false>(air_parameters),
                   cells);
    high_.configure(half_of<LineParameters<Half>, true>(line), half_of<AirParameters<Half>, true>(air_parameters),
                    cells);
  }
  void set_effects(const LineEffects<S>& effects) noexcept {
    low_.set_effects(half_of<false>(effects));
    high_.set_effects(half_of<true>(effects));
  }
  void set_port_tolerance(double tolerance) noexcept {
    low_.set_port_tolerance(tolerance);
    high_.set_port_tolerance(tolerance);
  }
  bool is_cushioned() const noexcept { return low_.is_cushioned() || high_.is_cushioned(); }
  void set_piston_distance(const S& distance_m) noexcept {
    low_.set_piston_distance(low(distance_m));
    high_.set_piston_distance(high(distance_m));
  }
  void set_inflow(const S& inflow_kgps) noexcept {
    low_.set_inflow(low(inflow_kgps));
    high_.set_inflow(high(inflow_kgps));
  }
  void set_adiabatic(bool adiabatic) noexcept {
    low_.set_adiabatic(adiabatic);
    high_.set_adiabatic(adiabatic);
  }
  void set_isothermal(bool isothermal) noexcept {
    low_.set_isothermal(isothermal);
    high_.set_isothermal(isothermal);
  }
  void set_frictionless(bool frictionless) noexcept {
    low_.set_frictionless(frictionless);
    high_.set_frictionless(frictionless);
  }
  void reset(const S& pressure_Pa, const S& temperature_K) noexcept {
    low_.reset(low(pressure_Pa), low(temperature_K));
    high_.reset(high(pressure_Pa), high(temperature_K));
  }
  void set_cell_state(int i, const S& pressure_Pa, const S& temperature_K) noexcept {
    low_.set_cell_state(i, low(pressure_Pa), low(temperature_K));
    high_.set_cell_state(i, high(pressure_Pa), high(temperature_K));
  }
  void set_face_velocity(int j, const S& velocity_mps) noexcept {
    low_.set_face_velocity(j, low(velocity_mps));
    high_.set_face_velocity(j, high(velocity_mps));
  }
  void scale_gas(const S& pressure, const S& temperature) noexcept {
    low_.scale_gas(low(pressure), low(temperature));
    high_.scale_gas(high(pressure), high(temperature));
  }
  void set_time_step(double step_s) noexcept {
    low_.set_time_step(step_s);
    high_.set_time_step(step_s);
  }
  double largest_speed() const noexcept { return std::max(low_.largest_speed(), high_.largest_speed()); }

  LineFlow<S> advance_ends_prescribed(const S& port_pressure_Pa, const ChamberEnd<S>& chamber) noexcept {
    const auto a =
        low_.advance_ends_prescribed(low(port_pressure_Pa), {low(chamber.pressure_Pa), low(chamber.temperature_K)});
    const auto b =
        high_.advance_ends_prescribed(high(port_pressure_Pa), {high(chamber.pressure_Pa), high(chamber.temperature_K)});
    return joined(a, b);
  }
  LineFlow<S> advance_ends_valve(const ValvePort<S>& valve, const ChamberEnd<S>& chamber) noexcept {
    const auto a = low_.advance_ends_valve({low(valve.supply_area_m2), low(valve.exhaust_area_m2),
                                            low(valve.supply_pressure_Pa), low(valve.critical_pressure_ratio)},
                                           {low(chamber.pressure_Pa), low(chamber.temperature_K)});
    const auto b = high_.advance_ends_valve({high(valve.supply_area_m2), high(valve.exhaust_area_m2),
                                             high(valve.supply_pressure_Pa), high(valve.critical_pressure_ratio)},
                                            {high(chamber.pressure_Pa), high(chamber.temperature_K)});
    return joined(a, b);
  }
  void advance_inside() noexcept {
    low_.advance_inside();
    high_.advance_inside();
  }

  int cells() const noexcept { return low_.cells(); }
  S cell_length() const noexcept { return length_ / S(cells()); }
  S cross_section() const noexcept { return join(low_.cross_section(), high_.cross_section()); }
  S volume() const noexcept { return join(low_.volume(), high_.volume()); }
  const Air<S>& air() const noexcept { return air_; }
  S cell_pressure(int i) const noexcept { return join(low_.cell_pressure(i), high_.cell_pressure(i)); }
  S cell_density(int i) const noexcept { return join(low_.cell_density(i), high_.cell_density(i)); }
  S cell_temperature(int i) const noexcept { return join(low_.cell_temperature(i), high_.cell_temperature(i)); }
  S face_velocity(int j) const noexcept { return join(low_.face_velocity(j), high_.face_velocity(j)); }
  S port_pressure() const noexcept { return join(low_.port_pressure(), high_.port_pressure()); }
  S mass() const noexcept { return join(low_.mass(), high_.mass()); }
  S internal_energy() const noexcept { return join(low_.internal_energy(), high_.internal_energy()); }
  std::int64_t guard_actions() const noexcept { return low_.guard_actions() + high_.guard_actions(); }
  S leak_mass_flow() const noexcept { return join(low_.leak_mass_flow(), high_.leak_mass_flow()); }
  S branch_mass() const noexcept { return join(low_.branch_mass(), high_.branch_mass()); }

 private:
  using Half = Pack<T, N / 2>;

  template <bool upper> static Half half_of(const S& both) noexcept {
    if constexpr (upper) return high(both);
    else return low(both);
  }
  template <class To, bool upper, class From> static To half_of(const From& both) noexcept {
    To out{};
    To::visit(
        [](const Field&, auto& to, const auto& from) {
          if constexpr (std::is_enum_v<std::remove_cvref_t<decltype(from)>>) to = from;
          else to = half_of<upper>(from);
        },
        out, both);
    return out;
  }
  template <bool upper> static LineEffects<Half> half_of(const LineEffects<S>& both) noexcept {
    LineEffects<Half> out;
    LineEffects<Half>::visit(
        [](auto& to, const auto& from) { to = half_of<std::remove_cvref_t<decltype(to)>, upper>(from); }, out, both);
    out.critical_pressure_ratio = half_of<upper>(both.critical_pressure_ratio);
    return out;
  }
  static LineFlow<S> joined(const LineFlow<Half>& a, const LineFlow<Half>& b) noexcept {
    return {join(a.port_mass_flow_kgps, b.port_mass_flow_kgps),
            join(a.chamber_mass_flow_kgps, b.chamber_mass_flow_kgps),
            join(a.chamber_enthalpy_flow_W, b.chamber_enthalpy_flow_W)};
  }

  Line<Half> low_, high_;
  Air<S> air_;
  S length_{};
};

}  // namespace pneuservo
