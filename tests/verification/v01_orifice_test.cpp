// V01: the orifice as a function: choked, subsonic, reverse, joints, the straight piece near equal pressures.
#include "gas_rig.hpp"

using namespace verification;

namespace {
Answer answer(const Check& check) {
  const Air<double> air{nominal_air()};
  const auto given = [&](const char* key, double otherwise) { return check.has(key) ? check.number(key) : otherwise; };
  const double S = given("S_m2", 1.3e-5), b = given("b", 0.35), T_1 = given("T_1_K", 293.0), T_2 = 310.0;
  if (check.quantity == "K_f") return air.flow_constant;
  if (check.quantity == "psi") return orifice_psi(check.number("r"), b);
  if (check.quantity == "psi_slope_in_linear_part") return (orifice_psi(0.9999, b) - orifice_psi(0.9995, b)) / 4e-4;
  if (check.quantity == "psi_slope_just_below_linear_part")
    return (orifice_psi(0.999, b) - orifice_psi(0.999 - 1e-7, b)) / 1e-7;
  if (check.quantity == "conductance_C_ISO6358")
    return S * air.flow_constant / std::sqrt(air.R * check.number("T_0_K")) / check.number("rho_0");
  const double G = orifice_mass_flow(air, S, b, check.number("p_1_Pa"), T_1, check.number("p_2_Pa"), T_2);
  if (check.quantity == "mass_flow") return G;
  if (check.quantity == "enthalpy_flow") return orifice_enthalpy_flow(air, G, T_1, T_2);
  throw std::runtime_error("quantity is unknown");
}
}  // namespace

TEST_CASE("V01 orifice", "[V01]") {
  Case v01("V01");
  v01.run(Resolution::normal, answer);
  v01.run(Resolution::fine, answer);
}
