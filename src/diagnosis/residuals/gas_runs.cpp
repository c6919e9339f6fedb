// Gas courses of many hypotheses over all recordings.
#include "diagnosis/residuals/gas_runs.hpp"

#include <atomic>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <mutex>
#include <new>
#include <thread>

namespace pneuservo {

namespace {

// Cells times sub-steps a second and line: what a hypothesis costs, and what shows the error of that. The error is
// taken out, so verdicts and sizes are those of 100e3; with 25e3 a volume at a port comes out a quarter too small.
constexpr double work_effort_per_s = 40e3, fine_effort_per_s = 2000e3;
constexpr std::size_t most_known = 64;  // courses kept of each recording, 0.3 MB each for 8 s

bool finite(const GasCourse& course) { return std::isfinite(course[Signal::p1_port].back()); }

/// As run_imposed; a rig that an element refuses has a course of NaN, which drops that hypothesis and no other.
std::vector<GasCourse> run_or_drop(const ImposedInputs& inputs, std::span<const ImposedRun> runs, const PlantGrid& grid,
                                   const StopQuestion& stop) {
  try {
    return run_imposed(inputs, runs, grid, stop);
  } catch (const std::bad_alloc&) { throw; } catch (const DiagnosisStopped&) {
    throw;
  } catch (const std::exception&) {
    GasCourse nothing;
    for (const Signal signal : gas_signals)
      nothing[signal].assign(inputs.samples(), std::numeric_limits<double>::quiet_NaN());
    if (runs.size() == 1) return {nothing};
    std::vector<GasCourse> out;
    for (const ImposedRun& run : runs) out.push_back(run_or_drop(inputs, std::span(&run, 1), grid, stop)[0]);
    return out;
  }
}

}  // namespace

void in_parallel(std::size_t count, int jobs, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> has_failed{false};
  std::exception_ptr failure;
  std::mutex mutex;
  const auto take = [&] {
    for (std::size_t i = next++; i < count && !has_failed; i = next++) try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        has_failed = true;
      }
  };
  std::vector<std::jthread> threads;
  for (std::size_t i = 1; i < std::min(count, static_cast<std::size_t>(std::max(1, jobs))); ++i)
    threads.emplace_back(take);
  take();
  threads.clear();
  if (failure) std::rethrow_exception(failure);
}

GasRuns::GasRuns(const Rig& owner, const std::vector<CylinderRecording>& recordings, int jobs, StopQuestion stop)
    : recordings_(recordings), jobs_(jobs), stop_(std::move(stop)), known_(recordings.size()),
      order_(recordings.size()), grid_error_(recordings.size()) {
  const RecordedRigs rigs(owner, recordings);
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const double step_s = recordings[r].inputs.step_s();
    work_grid_.push_back(grid_for(rigs[r], work_effort_per_s * step_s, step_s));
    fine_grid_.push_back(grid_for(rigs[r], fine_effort_per_s * step_s, step_s));
  }
  set_working_point({owner, {}});
}

GasRuns::Key GasRuns::key_of(const ImposedRun& run, std::size_t recording) const {
  AxisParameters<double> axis = run.rig->axis;
  axis.slider = {};
  axis.effects.motion = {};
  Key key;
  const NumberCollector collect{key};
  AxisParameters<double>::visit(collect, axis);
  SensorEffects<double>::visit(collect, run.rig->sensor_effects[Signal::x]);
  if (!recordings_[recording].inputs.supply_Pa.empty())
    SensorEffects<double>::visit(collect, run.rig->sensor_effects[Signal::p_supply]);
  for (const Signal sensor : recordings_[recording].inputs.start_sensor)
    SensorEffects<double>::visit(collect, run.rig->sensor_effects[sensor]);
  for (const double factor : run.start_factor) key.push_back(factor);
  return key;
}

ImposedRun GasRuns::run_of(const RecordedRigs& rigs, const Hypothesis& hypothesis, std::size_t recording) {
  ImposedRun run{&rigs[recording], {}};
  const std::vector<double>& factors = hypothesis.start_factors;
  for (std::size_t side = 0; side < 2; ++side)
    if (2 * recording + side < factors.size()) run.start_factor[side] = factors[2 * recording + side];
  return run;
}

void GasRuns::remember(std::size_t recording, Key key, Course course) {
  const auto [at, added] = known_[recording].emplace(std::move(key), Stored{std::move(course), {}});
  if (!added) return;
  order_[recording].push_front(&at->first);
  at->second.use = order_[recording].begin();
  if (order_[recording].size() <= most_known) return;
  const Key* oldest = order_[recording].back();
  order_[recording].pop_back();
  known_[recording].erase(known_[recording].find(*oldest));
}

void GasRuns::compute(Batch& batch) const {
  const GasCourse& error = grid_error_[batch.recording];
  for (GasCourse& course :
       run_or_drop(recordings_[batch.recording].inputs, batch.runs, work_grid_[batch.recording], stop_)) {
    for (const Signal signal : gas_signals)
      for (std::size_t k = 0; k < error[signal].size(); ++k) course[signal][k] += error[signal][k];
    batch.courses.push_back(std::make_shared<const GasCourse>(std::move(course)));
  }
}

std::vector<std::vector<GasRuns::Course>> GasRuns::of(std::span<const Hypothesis> hypotheses) {
  std::vector<std::vector<Course>> out(hypotheses.size(), std::vector<Course>(recordings_.size()));
  std::vector<RecordedRigs> rigs;
  rigs.reserve(hypotheses.size());
  for (const Hypothesis& hypothesis : hypotheses) rigs.emplace_back(hypothesis.rig, recordings_);
  std::vector<Batch> batches;
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> repeats(recordings_.size());  // hypothesis, first alike
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    std::map<Key, std::size_t> wanted;
    for (std::size_t i = 0; i < hypotheses.size(); ++i) {
      const ImposedRun run = run_of(rigs[i], hypotheses[i], r);
      Key key = key_of(run, r);
      if (const auto found = known_[r].find(key); found != known_[r].end()) {
        order_[r].splice(order_[r].begin(), order_[r], found->second.use);
        out[i][r] = found->second.course;
      } else if (const auto [first, added] = wanted.emplace(key, i); !added) {
        repeats[r].emplace_back(i, first->second);
      } else {
        if (batches.empty() || batches.back().recording != r || batches.back().hypotheses.size() == imposed_lanes)
          batches.push_back({r, {}, {}, {}, {}});
        batches.back().hypotheses.push_back(i);
        batches.back().runs.push_back(run);
        batches.back().keys.push_back(std::move(key));
      }
    }
  }
  in_parallel(batches.size(), jobs_, [&](std::size_t b) { compute(batches[b]); });
  for (Batch& batch : batches)
    for (std::size_t i = 0; i < batch.hypotheses.size(); ++i) {
      out[batch.hypotheses[i]][batch.recording] = batch.courses[i];
      remember(batch.recording, std::move(batch.keys[i]), batch.courses[i]);
    }
  for (std::size_t r = 0; r < recordings_.size(); ++r)
    for (const auto& [hypothesis, first] : repeats[r]) out[hypothesis][r] = out[first][r];
  return out;
}

void GasRuns::set_working_point(const Hypothesis& hypothesis) {
  std::vector<GasCourse> fine(recordings_.size()), work(recordings_.size());
  const RecordedRigs rigs(hypothesis.rig, recordings_);
  in_parallel(2 * recordings_.size(), jobs_, [&](std::size_t i) {  // the long ones first
    const std::size_t r = i % recordings_.size();
    const bool is_fine = i < recordings_.size();
    const std::array<ImposedRun, 1> run{run_of(rigs, hypothesis, r)};
    (is_fine ? fine : work)[r] =
        run_imposed(recordings_[r].inputs, run, (is_fine ? fine_grid_ : work_grid_)[r], stop_)[0];
  });
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    if (!finite(fine[r]) || !finite(work[r])) continue;
    for (const Signal signal : gas_signals)
      for (std::size_t k = 0; k < fine[r][signal].size(); ++k) fine[r][signal][k] -= work[r][signal][k];
    grid_error_[r] = std::move(fine[r]);
    known_[r].clear();
    order_[r].clear();
  }
}

}  // namespace pneuservo
