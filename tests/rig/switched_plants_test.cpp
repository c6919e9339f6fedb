// Plants that an on/off valve switches, against closed forms: filling and blow-down of a vessel, the steady speed of a
// cylinder behind throttles, its stop in a cushion.
#include <catch2/catch.hpp>

#include <cmath>

#include <pneuservo/rig/switched_cylinder_plant.hpp>
#include <pneuservo/rig/vessel_plant.hpp>

using namespace pneuservo;

namespace {

Rig vessel_rig() {
  Rig rig;
  rig.kind = RigKind::vessel;
  rig.vessel.volume_m3 = 0.01;
  rig.on_off_valve = {1e-6, 2e-6, 0.5};
  return rig;
}

Rig cylinder_rig() {
  Rig rig;
  rig.kind = RigKind::switched_cylinder;
  rig.axis.supply.pressure_Pa = 6e5;
  rig.throttle_1 = {4e-6, 5e-7};
  rig.throttle_2 = {4e-6, 8e-7};
  rig.axis.cylinder.stroke_m = 1.0;
  rig.axis.cylinder.area_1_m2 = 3.1e-4;
  rig.axis.cylinder.area_2_m2 = 2.6e-4;
  rig.axis.cylinder.dead_volume_1_m3 = rig.axis.cylinder.dead_volume_2_m3 = 4e-6;
  rig.axis.cylinder.wall_heat_W_per_m2K = 1e5;  // isothermal
  rig.axis.slider.mass_kg = 0.2;
  rig.axis.slider.viscous_friction_Ns_per_m = 20.0;  // both so that the swing on the gas springs is soon over
  return rig;
}

/// Flow [kg/s] over upstream pressure [Pa] and area [m2] of a choked orifice, written out anew: ISO 6358, ideal nozzle.
double choked_flux_per_Pa(const AirParameters<double>& air) {
  const double kappa = air.heat_capacity_ratio;
  const double constant = std::sqrt(kappa * std::pow(2 / (kappa + 1), (kappa + 1) / (kappa - 1)));
  return constant / std::sqrt(air.gas_constant_J_per_kgK * air.temperature_K);
}

}  // namespace

TEST_CASE("an insulated vessel fills on a straight line as long as its flow is choked") {
  const Rig rig = vessel_rig();
  const AirParameters<double>& air = rig.axis.air;
  const double supply_Pa = 7e5, start_Pa = 1e5, h = 1e-3;
  // d(m c_v T)/dt = G c_p T_supply, so dp/dt = kappa R T_supply G / V.
  const double slope = air.heat_capacity_ratio * air.gas_constant_J_per_kgK * air.temperature_K *
                       choked_flux_per_Pa(air) * 1e-6 * supply_Pa / rig.vessel.volume_m3;
  VesselPlant plant(rig, start_Pa);
  int k = 0;
  for (; plant.chamber_Pa() < 0.5 * supply_Pa; plant.step(h, 1.0, supply_Pa), ++k)
    REQUIRE(plant.chamber_Pa() == Approx(start_Pa + slope * k * h).epsilon(1e-9));
  REQUIRE(k > 100);
  const double shut_Pa = plant.chamber_Pa();
  for (int i = 0; i < 100; ++i) plant.step(h, 0.0, supply_Pa);
  CHECK(plant.chamber_Pa() == Approx(shut_Pa).epsilon(1e-12));
}

TEST_CASE("an insulated vessel empties through a choked orifice by the polytrope's power law") {
  const Rig rig = vessel_rig();
  const AirParameters<double>& air = rig.axis.air;
  const double kappa = air.heat_capacity_ratio, start_Pa = 8e5, T = rig.vessel.gas_temperature_K, h = 1e-4;
  // dm/dt = -C p / sqrt(T) with p and T on the isentrope of the gas that stays:
  // p = p_0 (1 + (kappa - 1)/2 t/tau)^(-2 kappa/(kappa - 1)), tau = m_0 / G_0.
  const double flow = choked_flux_per_Pa(air) * std::sqrt(air.temperature_K / T) * 2e-6 * start_Pa;
  const double tau = start_Pa * rig.vessel.volume_m3 / (air.gas_constant_J_per_kgK * T) / flow;
  VesselPlant plant(rig, start_Pa);
  int k = 0;
  for (; plant.chamber_Pa() > 2.1 * air.atmosphere_Pa; plant.step(h, -1.0, 0.0), ++k)
    REQUIRE(plant.chamber_Pa() ==
            Approx(start_Pa * std::pow(1 + 0.5 * (kappa - 1) * k * h / tau, -2 * kappa / (kappa - 1))).epsilon(1e-4));
  CHECK(k > 1000);
}

TEST_CASE("the steady speed of a switched cylinder is that of the choked throttle through which the air leaves") {
  const Rig rig = cylinder_rig();
  const AirParameters<double>& air = rig.axis.air;
  const double command = GENERATE(1.0, -1.0), h = 2e-4;
  // The pressure p of the chamber that shrinks is steady, so p A v / (R T) = G = S K_f p / sqrt(R T): p falls out.
  const double volume_flow = choked_flux_per_Pa(air) * air.gas_constant_J_per_kgK * air.temperature_K;
  const double speed = command > 0 ? volume_flow * rig.throttle_2.outflow_area_m2 / rig.axis.cylinder.area_2_m2
                                   : volume_flow * rig.throttle_1.outflow_area_m2 / rig.axis.cylinder.area_1_m2;
  SwitchedCylinderPlant plant(rig, -0.5 * command, -command);
  double now = 0.0, entered_s = 0.0, left_s = 0.0;
  const double enter_m = 0.0, leave_m = 0.4;
  for (; now < 10.0 && left_s == 0.0; now += h) {
    const double before = command * plant.position_m();
    plant.step(h, command);
    const double after = command * plant.position_m();
    const auto crossed_s = [&](double x) { return now + h * (x - before) / (after - before); };
    if (before < enter_m && after >= enter_m) entered_s = crossed_s(enter_m);
    if (before < leave_m && after >= leave_m) left_s = crossed_s(leave_m);
  }
  INFO("closed form " << speed << " m/s");
  REQUIRE(left_s > 0.0);
  CHECK((leave_m - enter_m) / (left_s - entered_s) == Approx(speed).epsilon(1e-3));
  // And the pressures carry the friction at that speed.
  const double p1 = plant.chamber_1_Pa() - air.atmosphere_Pa, p2 = plant.chamber_2_Pa() - air.atmosphere_Pa;
  const double force = p1 * rig.axis.cylinder.area_1_m2 - p2 * rig.axis.cylinder.area_2_m2;
  CHECK(force == Approx(20.0 * command * speed).margin(0.01));
  while (now < 30.0) plant.step(h, command), now += h;
  CHECK(plant.position_m() == 0.5 * command);  // rests at the end stop
}

TEST_CASE("a pushed slider falls in its cushion to the speed at which the damping carries the push") {
  Rig rig = cylinder_rig();
  const double end = GENERATE(1.0, -1.0), push_N = 10.0, mass = 2.0, damping = 200.0, h = 1e-5;
  rig.axis.cylinder.area_1_m2 = rig.axis.cylinder.area_2_m2 = 1e-10;  // the gas does not push
  rig.axis.slider = {.mass_kg = mass};
  rig.axis.effects.motion.constant_force.force_N = -end * push_N;
  (end > 0 ? rig.cushion_2 : rig.cushion_1) = {0.05, damping};
  SwitchedCylinderPlant plant(rig, 0.0, 0.0);
  while (end * plant.position_m() < 0.45) plant.step(h, 0.0);
  const double entered = end * plant.velocity_mps(), carried = push_N / damping;
  CHECK(entered == Approx(std::sqrt(2 * push_N * 0.45 / mass)).epsilon(1e-4));
  double now = 0.0;
  for (; end * plant.position_m() < 0.499; plant.step(h, 0.0), now += h) {
    const double left = std::exp(-damping * now / mass);  // m dv/dt = F - d v
    REQUIRE(end * plant.velocity_mps() == Approx(carried + (entered - carried) * left).epsilon(2e-3));
  }
  CHECK(now > 0.05);
  while (end * plant.position_m() < 0.5) plant.step(h, 0.0);
  plant.step(h, 0.0);
  CHECK(plant.velocity_mps() == 0.0);
}
