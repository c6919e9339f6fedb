// All explanations that a diagnosis tries: effects of the vocabulary, parameters that are off, sensors at fault.
#pragma once
#include <string>
#include <vector>

#include "diagnosis/search/effect_scales.hpp"
#include "diagnosis/search/free_parameter.hpp"
#include "elements/effect_entry.hpp"

namespace pneuservo {

enum class CandidateKind { effect, parameter, sensor };

MotionRange motion_range(const std::vector<ResidualRow>& rows);

/// One name that can be given.
struct Candidate {
  std::string name;     ///< chamber_leak_1, sensor_offset:p1_port, parameter:slider.mass_kg
  std::string element;  ///< as in the vocabulary
  CandidateKind kind = CandidateKind::effect;
  std::vector<FreeParameter> parameters;
  std::vector<double> negligible;            ///< of each parameter's distance from neutral, in its own unit; 0: none
  std::vector<double> neutral;               ///< value of each parameter where the effect does nothing
  std::vector<std::vector<double>> starts;  ///< z to screen and start from; where amplitudes are neutral, z of neutral
  std::vector<char> amplitude;  ///< of each parameter: found by its derivative
  std::vector<std::vector<double>> whole_starts;  ///< z whose whole change is screened beside the derivative
  std::string family;  ///< names that mimic each other; all are refitted when one is
  /// Tells where and how much, and no law: sought alone, and its verdict is `unknown` at its element.
  bool is_description = false;
  bool is_never_added = false;  ///< to other names; every description is one such
  unsigned shown_by = 0;  ///< bits of Excitation that its recordings must have
  bool is_guessed = false;  ///< the size of an effect that the config has: no owner can read it off
  const EffectEntry* entry = nullptr;  ///< of an effect or a sensor

  /// Config path of one of its keys.
  std::string path_of(std::string_view key) const { return "effects." + name + "." + std::string(key); }
  /// Path of what it has beyond a simpler law that it contains; empty: it has no such number.
  std::string extra() const {
    return entry == nullptr || entry->contains.extra.empty() ? "" : path_of(entry->contains.extra);
  }
};

/// Every candidate that the rig and the channels allow, in the order of the vocabulary. `tolerances` of the rig name
/// the parameters that may be off.
std::vector<Candidate> all_candidates(const Rig& rig, const std::vector<ResidualChannel>& channels,
                                      const MotionRange& range);

/// The values of a table (EffectRole::table) that the rig can have, as free numbers beside what it has.
std::vector<FreeParameter> table_values(const Rig& rig, const std::string& effect, const MotionRange& range);

/// Parameters known within a tolerance, and the start factors: always free, with their priors, cut at +-3.
std::vector<FreeParameter> nuisances(const Rig& rig, std::size_t start_factor_count, double start_factor_sigma);

/// Small physics that every real machine has a little of, as nuisances with narrow priors about neutral: they take up
/// the small and leave the large, which has a name.
/// left_out: effects that are not tried, and so not granted either.
std::vector<FreeParameter> small_physics(const Rig& rig, const std::vector<ResidualChannel>& channels,
                                         const std::vector<std::string>& left_out = {});
/// Whether small physics stands for the candidate: it grants another effect of its family, or all numbers of a
/// description.
bool is_granted(const Candidate& candidate);
/// Whether a number of small physics is one of the candidate's, or the same in other words: what is named is not
/// granted as well.
bool stands_for(const FreeParameter& granted, const Candidate& candidate);

/// Element at which a config path sits: slider.mass_kg is at motion.
std::string element_of_path(const std::string& path);

}  // namespace pneuservo
