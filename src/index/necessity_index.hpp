// Necessity index (chapter 4): does an axis need the pipeline model? Largest line loss over 10 kPa (4.12 to 4.16).
#pragma once
#include <array>
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// P_re: the line loss that the thesis takes as the limit.
inline constexpr double necessity_loss_limit_Pa = 10000.0;
/// The thesis' switch from 64/Re to Blasius.
inline constexpr double necessity_reynolds = 2300.0;
/// Viscosity with which the thesis' tables were computed: it reproduces every printed digit but one.
inline constexpr double thesis_viscosity_Pas = 1.73e-5;

/// What the index of one side depends on.
struct NecessitySide {
  double gas_constant_J_per_kgK = 287.0, temperature_K = 293.0, viscosity_Pas = 1.8e-5;
  double pressure_Pa = 0.0;     ///< P_0: chamber pressure at rest
  double piston_area_m2 = 0.0;
  double length_m = 0.0, diameter_m = 0.0;
};

/// Index of one side and what it comes from.
struct NecessityIndex {
  double index = 0.0;
  double loss_Pa = 0.0;
  double reynolds = 0.0;
  double line_velocity_mps = 0.0;
  bool turbulent = false;
};

/// u = 4 A v/(pi D^2), Re = rho u D/mu, loss 32 mu L u/D^2 (Re <= 2300) or 0.1582 mu Re^0.75 L u/D^2. All inputs > 0;
/// peak_speed_mps >= 0.
NecessityIndex necessity_index(const NecessitySide& side, double peak_speed_mps);
/// Line length [m] at which the index is 1 (it is proportional to the length).
double limit_length_m(NecessitySide side, double peak_speed_mps);

/// The thesis' own axis, side 1 (470 kPa, 1257 mm2, the larger) or 2 (530 kPa, 1056 mm2), with its viscosity.
NecessitySide thesis_side(int side, double length_m, double diameter_m);
/// Peak speed of its reference: 80 mm sine of that frequency.
double thesis_peak_speed_mps(double frequency_Hz);

/// One entry of Table 4.2 (diameter and length at 1 Hz) or 4.3 (frequency at 6.10 mm x 10 m).
struct PrintedIndex {
  const char* table;
  double diameter_m, length_m, frequency_Hz;
  double printed;
  const char* remark = "";   ///< why ours differs, where it does
};
const std::vector<PrintedIndex>& printed_indices();
/// Does our value round to the printed digits?
bool reproduces(const PrintedIndex& entry);

/// (4.16) with 4.3: at an index of 1 or more.
constexpr bool is_pipeline_model_needed(double index) { return index >= 1.0; }

/// The index of a config: both sides at the peak speed of its reference over the run.
struct RigNecessity {
  double peak_speed_mps = 0.0;
  std::string motion;                      ///< what the speed comes from, in words
  std::array<NecessitySide, 2> side;
  std::array<NecessityIndex, 2> index;
  int dominating = 0;                      ///< 0: side 1, 1: side 2
  bool needed = false;                     ///< larger index at least 1
};
/// P_0 are the initial pressures (side 2 balances the piston unless given). Throws std::invalid_argument for a
/// reference that cannot be built.
RigNecessity rig_necessity(const Rig& rig, const LoadPositions& load = {});

}  // namespace pneuservo
