// References that a rig can follow without harm, each good at showing something else: the menu of the next experiment.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// One recording that could be made.
struct ExperimentChoice {
  ReferenceSpec reference;
  double duration_s = 0;
  std::string setup;                                 ///< a change of the machine in words; empty: none
  std::vector<std::pair<std::string, double>> keys;  ///< the same as config paths and values
};

/// Some twelve of them: sines, steps with rests, dithers, creeps, the same at another supply pressure and with a known
/// payload. All stay within 85 % of the stroke, 30 % of the drive's force for acceleration and 1.5 times the speed that
/// the recordings have shown [m/s, > 0]. They begin and rest at the middle of the stroke.
std::vector<ExperimentChoice> safe_references(const Rig& rig, double shown_speed_mps);

}  // namespace pneuservo
