// A diagnosis from code: a rig and its recordings in, what the model lacks out.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/diagnosis.hpp"
#include "diagnosis/search/fit.hpp"
#include "diagnosis/self_test.hpp"
#include "diagnosis/verdict/decision.hpp"
#include "diagnosis/verdict/next_experiment.hpp"
#include "record/reader.hpp"

namespace pneuservo {

struct DiagnoseOptions {
  int jobs = 0;                                                    ///< threads; 0: as many as the machine has
  std::function<void(double share, const std::string& what)> progress;
  StopQuestion stop;                                               ///< true ends early with what is there
  DecisionRules rules;
  std::vector<std::string> left_out;  ///< names that are not tried: what is said where the list has a gap
  bool with_curve = false;  ///< of an unknown: the table that stands best for it
  bool is_whole = true;  ///< recordings are compared from their start on, so that time is theirs
  int self_test = 0;  ///< machines as the answer has them that are diagnosed, too
  FollowingMachine following_machine;  ///< plays them
  VirtualMachine
      virtual_machine;  ///< makes the recordings that a next experiment is chosen by; empty: none is proposed
};

/// The comparison of a rig's recordings with its model. Throws InputError: columns missing, another rig's recording.
std::unique_ptr<ResidualModel> make_residual_model(const Rig& rig, const std::vector<Recording>& recordings, int jobs,
                                                   const StopQuestion& stop = {});

/// Recordings that were doubted and cut, and their comparison with the rig.
struct PreparedDiagnosis {
  Rig rig;
  std::unique_ptr<ResidualModel> model;
  std::vector<std::string> recordings, warnings;
  Coverage coverage;
};
/// The recordings are let go once their pieces are taken. Throws InputError for recordings that cannot be used.
PreparedDiagnosis prepare_diagnosis(const Rig& configured, std::vector<Recording> recordings, std::string_view verb,
                                    const DiagnoseOptions& options);
/// Throws InputError where there is nothing to compare: no row, or no finite course of the rig as configured.
void require_comparison(const Rig& rig, FittedRows& rows);

/// The recordings are let go once their pieces are taken. Throws InputError for recordings that cannot be used, and
/// DiagnosisStopped where nothing is known yet.
Diagnosis diagnose(const Rig& configured, std::vector<Recording> recordings, const DiagnoseOptions& options = {});
/// The same on a comparison that is there already.
Diagnosis diagnose(const Rig& rig, ResidualModel& model, const DiagnoseOptions& options = {});

}  // namespace pneuservo
