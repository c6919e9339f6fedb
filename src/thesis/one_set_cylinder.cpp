// The family of cylinder axes: one set of gains, mass, friction, valve and chambers against Figs 3.13 to 3.21.
#include <cmath>

#include <fmt/format.h>

#include "thesis/groups.hpp"
#include "thesis/one_set.hpp"

namespace pneuservo {
namespace {

struct CylinderKey {
  enum Number : std::size_t {
    position_gain,
    velocity_gain,
    filter,
    force_gain,
    force_integral,
    area,
    mass,
    viscous,
    dead_volume,
    wall,
    dry,
    start
  };
};

std::vector<FreeNumber> cylinder_numbers() {
  return {{"position gain", "N/m", 100.0, 1e4, true, 691.991211},
          {"velocity gain", "N s/m", 1.0, 500.0, true, 21.4656196},
          {"filter of the velocity", "s", 5e-4, 2e-2, true, 0.00330351769},
          {"force gain", "V/N", 1e-3, 0.1, true, 0.0076739638},
          {"integral of the force", "V/(N s)", 0.01, 5.0, true, 1.47261272},
          {"area per volt", "m2/V", 5e-7, 1e-5, true, 2.47988477e-06},
          {"moving mass", "kg", 0.5, 5.0, true, 0.598045953},
          {"viscous friction", "N s/m", 0.1, 300.0, true, 0.422813719},
          {"dead volume of a chamber", "m3", 5e-6, 1e-4, true, 2.13703319e-05},
          {"wall heat of a chamber", "W/(m2 K)", 5.0, 500.0, true, 73.224244},
          {"dry friction", "N", 0.0, 60.0, false, 0.505858774},
          {"pressure of chamber 1 at the start", "Pa", 2.5e5, 6e5, false, 475549.581}};
}

ThesisRig member_of(const std::vector<double>& at, const char* source, double payload_kg) {
  ThesisRig which{"thesis/picture-10m-7.65mm", unguarded};
  which.sets.insert(which.sets.end(),
                    {fmt::format("controller.pressure_source={}", source),
                     fmt::format("slider.payload_kg={:g}", payload_kg),
                     fmt::format("controller.position_gain_N_per_m={:.9g}", at[CylinderKey::position_gain]),
                     fmt::format("controller.velocity_gain_Ns_per_m={:.9g}", at[CylinderKey::velocity_gain]),
                     fmt::format("controller.velocity_filter_s={:.9g}", at[CylinderKey::filter]),
                     fmt::format("controller.force_gain_V_per_N={:.9g}", at[CylinderKey::force_gain]),
                     fmt::format("controller.force_integral_V_per_Ns={:.9g}", at[CylinderKey::force_integral]),
                     fmt::format("valve.area_per_volt_m2_per_V={:.9g}", at[CylinderKey::area]),
                     fmt::format("valve.area_max_m2={:.9g}", 5.0 * at[CylinderKey::area]),
                     fmt::format("slider.mass_kg={:.9g}", at[CylinderKey::mass]),
                     fmt::format("slider.viscous_friction_Ns_per_m={:.9g}", at[CylinderKey::viscous]),
                     fmt::format("cylinder.dead_volume_1_m3={:.9g}", at[CylinderKey::dead_volume]),
                     fmt::format("cylinder.dead_volume_2_m3={:.9g}", at[CylinderKey::dead_volume]),
                     fmt::format("cylinder.wall_heat_W_per_m2K={:.9g}", at[CylinderKey::wall]),
                     fmt::format("effects.coulomb_friction.force_N={:.9g}", at[CylinderKey::dry]),
                     fmt::format("initial.pressure_1_Pa={:.9g}", at[CylinderKey::start])});
  return which;
}

auto error_mm(const char* source, double payload_kg) {
  return [=](ThesisBench& bench, const std::vector<double>& at) {
    const ThesisCourse& course = bench.run(member_of(at, source, payload_kg));
    return course.fault.empty() ? 1e3 * course.max_error_m : std::nan("");
  };
}

}  // namespace

ThesisRig found_cylinder(const char* source, double payload_kg) {
  return member_of(found_numbers(cylinder_set()), source, payload_kg);
}

OneSet cylinder_set() {
  return {
      "cylinder",
      "Figs 3.13 to 3.21 on one axis, free and with 1.25 kg",
      "no figure is printed for the payload: asked is an error at most half larger than the free one",
      cylinder_numbers(),
      {{"Fig 3.13", "position error on port pressures, free", "mm", "56.6", error_mm("valve", 0.0)},
       {"Fig 3.14", "position error on chamber pressures, free", "mm", "13.0", error_mm("chamber", 0.0)},
       {"Fig 3.20", "position error on estimated pressures, free", "mm", "13.0", error_mm("estimated", 0.0)},
       {"Fig 3.21", "position error on chamber pressures, payload", "mm", "below 19.5", error_mm("chamber", 1.25)},
       {"Fig 3.21", "position error on estimated pressures, payload", "mm", "below 19.5", error_mm("estimated", 1.25)}},
      "5 of 5",
      "0.1231",
      "--evaluations 4000 --seed 2"};
}

}  // namespace pneuservo
