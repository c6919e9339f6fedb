// Gas courses of many hypotheses over all recordings: sides, lanes, threads, what was run already, the grid's own
// error.
#pragma once
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/residuals/gas_sides.hpp"
#include "diagnosis/residuals/residual_model.hpp"

namespace pneuservo {

/// Calls work(i) for i = 0 .. count - 1 from `jobs` threads, this one among them; the first exception ends
/// them and is thrown on.
void in_parallel(std::size_t count, int jobs, const std::function<void(std::size_t)>& work);

/// Hypotheses that differ on one side alone share the gas of the other.
class GasRuns {
 public:
  GasRuns(const Rig& owner, const std::vector<CylinderRecording>& recordings, int jobs, StopQuestion stop = {});

  /// Asked within every run; true ends it with DiagnosisStopped.
  void set_stop(StopQuestion stop) { stop_ = std::move(stop); }
  /// Course of hypothesis i over recording r at [i][r], with the grid's error at the working point taken out.
  std::vector<std::vector<SidedCourse>> of(std::span<const Hypothesis> hypotheses);
  /// The hypothesis' rig at each recording, with the supply as it swings there.
  RecordedRigs rigs_of(const Hypothesis& hypothesis) const;
  static ImposedRun run_of(const RecordedRigs& rigs, const Hypothesis& hypothesis, std::size_t recording);
  /// Takes the difference of a fine grid and the work grid at this hypothesis for the grid's error.
  void set_working_point(const Hypothesis& hypothesis);

 private:
  using Key = std::vector<double>;  ///< every number that the gas of a side depends on
  struct Stored {
    SidedCourse::Half half;
    std::list<const Key*>::iterator use;
  };
  /// The gas of one side of one recording by its numbers; the last used ones.
  struct Known {
    std::map<Key, Stored> halves;
    std::list<const Key*> order;  ///< the last used first
    SidedCourse::Half find(const Key& key);
    void add(const Key& key, SidedCourse::Half half);
  };
  bool is_flow_wanted(std::size_t recording) const {
    return !recordings_[recording].measured[Signal::supply_flow].empty();
  }
  /// Simulates runs of a recording and takes the grid's error out.
  std::vector<SidedCourse> simulate(std::size_t recording, std::span<const ImposedRun> runs) const;

  const std::vector<CylinderRecording>& recordings_;
  int jobs_;
  StopQuestion stop_;
  std::vector<PlantGrid> work_grid_, fine_grid_;  ///< of each recording, whose line may be another
  std::vector<std::array<Known, 2>> known_;       ///< of each recording and side
  std::vector<GasCourse> grid_error_;             ///< of each recording: fine less work; empty: none
};

}  // namespace pneuservo
