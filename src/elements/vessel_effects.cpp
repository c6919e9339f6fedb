// Entries of the effects of a vessel behind an on/off valve: heat and creep of its wall, heat of its charging, laws of
// leaks, late switching, a pump as its supply.
#include "elements/effect_entry.hpp"

namespace pneuservo {
namespace {

using enum EffectScale;

constexpr std::array<double, 4> charging_times{3, 10, 30, 100};
constexpr std::array<double, 2> drop_out_delays{1, 2.5};
constexpr std::array<double, 3> pump_resistances{0.3, 1, 3};
constexpr std::array<double, 5> creep_times{3, 10, 30, 100, 300};
constexpr std::array<double, 3> porous_orifices{0.02, 0.06, 0.2};

constexpr EffectEntry vessel_entries[] = {
    {.name = "wall_heat_exchange",
     .words = "heat between gas and wall",
     .element = "chamber_1",
     .family = "heat",
     .parameters = {amplitude("conductance_W_per_K", wall_heat, 0.3, 1e-4)}},
    // Charging warms. Emptying without heat from the wall changes the temperature most, filling by less.
    {.name = "charging_heat",
     .words = "gas that charging has warmed and that cools",
     .element = "chamber_1",
     .family = "heat",
     .parameters = {amplitude("excess_K", one, 10, 0.02).within(0, 1, adiabatic_change),
                    shape("time_constant_s", one, 1.2, charging_times).by(Variation::logarithmic)}},
    {.name = "laminar_leak",
     .words = "a leak of chamber # through narrow ways",
     .element = "chamber",
     .family = "leak",
     .parameters = {amplitude("conductance_kgps_per_Pa2", laminar_conductance, 0.01, 2.5e-5)}},
    {.name = "porous_leak",
     .words = "a leak of chamber # through a porous wall",
     .element = "chamber",
     .family = "leak",
     .parameters = {amplitude("conductance_kgps_per_Pa2", laminar_conductance, 0.01, 2.5e-5),
                    shape("orifice_area_m2", valve_area, 1.2, porous_orifices).by(Variation::logarithmic)}},
    {.name = "drop_out_delay",
     .words = "a valve that drops out later than it pulls in",
     .element = "timing",
     .family = "late",
     .parameters = {amplitude("delay_s", one, 0.01, 5e-4).whole_at(drop_out_delays)}},
    {.name = "pump_curve",
     .words = "a supply whose pressure falls with its flow, as a pump's does",
     .element = "supply",
     .family = "supply_droop",
     .parameters = {amplitude("resistance_Pa_s_per_kg", supply_resistance, 0.3, 1e-3).whole_at(pump_resistances)}},
    // Thin walls of rubber give way by 1e-7 of their volume per Pa, thick ones of hard plastic by 1e-9, metal by none.
    {.name = "wall_creep",
     .words = "a wall of plastic or rubber that gives way slowly (creep)",
     .element = "chamber_1",
     .family = "creep",
     .parameters = {amplitude("growth_per_Pa", one, 3e-8, 1e-11),
                    shape("time_constant_s", one, 1.2, creep_times).by(Variation::logarithmic)}},
};

}  // namespace

std::span<const EffectEntry> vessel_effect_entries() { return vessel_entries; }

}  // namespace pneuservo
