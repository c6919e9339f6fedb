// Gas courses of many hypotheses over all recordings: lanes, threads, what was run already, and the grid's own error.
#pragma once
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/residuals/residual_model.hpp"

namespace pneuservo {

/// Calls work(i) for i = 0 .. count - 1 from `jobs` threads, this one among them; the first exception ends
/// them and is thrown on.
void in_parallel(std::size_t count, int jobs, const std::function<void(std::size_t)>& work);

/// Every number of a parameter struct, in its order: what a memory of results goes by.
struct NumberCollector {
  std::vector<double>& numbers;
  template <class T> void operator()(const Field&, const T& value) const {
    if constexpr (std::is_arithmetic_v<T>) numbers.push_back(static_cast<double>(value));
    else if constexpr (std::is_enum_v<T>) numbers.push_back(static_cast<double>(static_cast<int>(value)));
    else T::visit(*this, value);
  }
};

class GasRuns {
 public:
  using Course = std::shared_ptr<const GasCourse>;

  GasRuns(const Rig& owner, const std::vector<CylinderRecording>& recordings, int jobs, StopQuestion stop = {});

  /// Asked within every run; true ends it with DiagnosisStopped.
  void set_stop(StopQuestion stop) { stop_ = std::move(stop); }
  /// Course of hypothesis i over recording r at [i][r], with the grid's error at the working point taken out.
  std::vector<std::vector<Course>> of(std::span<const Hypothesis> hypotheses);
  static ImposedRun run_of(const RecordedRigs& rigs, const Hypothesis& hypothesis, std::size_t recording);
  /// Takes the difference of a fine grid and the work grid at this hypothesis for the grid's error.
  void set_working_point(const Hypothesis& hypothesis);

 private:
  using Key = std::vector<double>;  ///< every number that the gas depends on
  struct Stored {
    Course course;
    std::list<const Key*>::iterator use;
  };
  /// Hypotheses that are simulated side by side over one recording.
  struct Batch {
    std::size_t recording;
    std::vector<std::size_t> hypotheses;
    std::vector<ImposedRun> runs;
    std::vector<Key> keys;
    std::vector<Course> courses;
  };
  /// Simulates a batch and takes the grid's error out.
  void compute(Batch& batch) const;
  Key key_of(const ImposedRun& run, std::size_t recording) const;
  void remember(std::size_t recording, Key key, Course course);

  const std::vector<CylinderRecording>& recordings_;
  int jobs_;
  StopQuestion stop_;
  std::vector<PlantGrid> work_grid_, fine_grid_;     ///< of each recording, whose line may be another
  std::vector<std::map<Key, Stored>> known_;         ///< of each recording, without the grid's error
  std::vector<std::list<const Key*>> order_;         ///< of each recording, the last used first
  std::vector<GasCourse> grid_error_;                ///< of each recording: fine less work; empty: none
};

}  // namespace pneuservo
