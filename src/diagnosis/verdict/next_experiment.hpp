// The recording that would tell rival explanations apart, found by making it on a virtual machine under each of them.
#pragma once
#include <functional>
#include <memory>
#include <optional>

#include "diagnosis/diagnosis.hpp"
#include "diagnosis/search/search.hpp"
#include "diagnosis/verdict/decision.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// Runs a rig in closed loop, with its own controller and sensors, for its reference and duration. Nothing where the
/// run ends in a fault or this kind of rig cannot be simulated.
using VirtualMachine = std::function<std::optional<Recording>(const Rig& rig)>;
/// Compares one recording with hypotheses of the owner's rig.
using CompareRecording = std::function<std::unique_ptr<ResidualModel>(const Recording& recording)>;

/// Separations below it [noise floors] are no proposal: the rivals are the same model, or no safe move tells them
/// apart.
inline constexpr double least_separation = 5.0;

/// Squared misfit with priors of an added recording after one linear step of all that is free. before: the same
/// explanation's fit to the recordings so far, at its minimum; parameters that both have move against its curvature
/// too, and only what the added recording adds is counted.
double refitted_misfit(const Fit& added, const Fit& before);

/// Of safe_references the one whose recording, made under the chosen explanation, leaves most of the nearest rival's
/// misfit after the rival's own refit beside the recordings so far (its parameters, the tolerances and the start free,
/// linearly). The separation is the root of what is left in chi2, the smaller of both directions. Nothing where no
/// rival is within rules.ambiguous_distance(). shown_speed_mps: largest speed of the recordings so far.
std::optional<ProposedExperiment> propose_experiment(const Rig& owner, const Decision& decision, const Search& search,
                                                     const DecisionRules& rules, double shown_speed_mps,
                                                     const VirtualMachine& machine, const CompareRecording& compare,
                                                     const StopQuestion& stop = {});

/// The config with the proposed recording's reference, length and changes of the machine: `run` takes it as it is.
Rig experiment_rig(const Rig& owner, const ProposedExperiment& experiment);

}  // namespace pneuservo
