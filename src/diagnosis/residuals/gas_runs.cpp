// Gas courses of many hypotheses over all recordings.
#include "diagnosis/residuals/gas_runs.hpp"

#include <atomic>
#include <cmath>
#include <deque>
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
constexpr std::size_t most_known = 64;  // halves of courses kept of each side of each recording, 0.25 MB each for 8 s

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

/// A side of a recording that no run had yet, for the first hypothesis that asks for it.
struct Missing {
  std::size_t hypothesis;
  std::vector<double> of_both;  ///< numbers that act on both sides
  const std::vector<double>* key;
  SidedCourse::Half* half;
};

/// A side 1 and a side 2 that one run can have, for the numbers of both are the same; null: nobody asks for this one.
using Together = std::array<const Missing*, 2>;

std::vector<Together> put_together(const std::array<std::vector<Missing>, 2>& missing) {
  std::map<std::vector<double>, std::vector<const Missing*>> second;
  for (const Missing& side : missing[1]) second[side.of_both].push_back(&side);
  std::vector<Together> out;
  for (const Missing& side : missing[0]) {
    std::vector<const Missing*>& partners = second[side.of_both];
    out.push_back({&side, partners.empty() ? nullptr : partners.back()});
    if (!partners.empty()) partners.pop_back();
  }
  for (const auto& [of_both, alone] : second)
    for (const Missing* side : alone) out.push_back({nullptr, side});
  return out;
}

/// Runs that are simulated side by side over one recording.
struct Batch {
  std::size_t recording;
  std::vector<Together> sides;  ///< of each run
  std::vector<ImposedRun> runs;
  std::deque<Rig> rigs;  ///< of runs with sides of two hypotheses
  std::vector<SidedCourse> courses;
};

/// What is asked of one recording in one call: a run for each hypothesis, and the halves of their courses.
struct Asked {
  std::vector<ImposedRun> runs;
  std::array<std::map<std::vector<double>, SidedCourse::Half>, 2> halves;  ///< by numbers; null: not simulated yet
  std::vector<std::array<const SidedCourse::Half*, 2>> of_run;
  std::array<std::vector<Missing>, 2> missing;
};

void add_batches(const Asked& asked, const ImposedInputs& inputs, std::size_t recording, std::deque<Batch>& batches) {
  for (const Together& sides : put_together(asked.missing)) {
    if (batches.empty() || batches.back().recording != recording || batches.back().runs.size() == imposed_lanes)
      batches.push_back({recording, {}, {}, {}, {}});
    Batch& batch = batches.back();
    const auto run_of = [&](const Missing* side) -> const ImposedRun& { return asked.runs[side->hypothesis]; };
    const bool is_one = !sides[0] || !sides[1] || sides[0]->hypothesis == sides[1]->hypothesis;
    batch.sides.push_back(sides);
    batch.runs.push_back(is_one ? run_of(sides[0] ? sides[0] : sides[1])
                                : side_by_side(run_of(sides[0]), run_of(sides[1]), inputs, batch.rigs.emplace_back()));
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
      grid_error_(recordings.size()) {
  const RecordedRigs rigs(owner, recordings);
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const double step_s = recordings[r].inputs.step_s();
    work_grid_.push_back(grid_for(rigs[r], work_effort_per_s * step_s, step_s));
    fine_grid_.push_back(grid_for(rigs[r], fine_effort_per_s * step_s, step_s));
  }
  set_working_point({owner, {}});
}

RecordedRigs GasRuns::rigs_of(const Hypothesis& hypothesis) const {
  RecordedRigs rigs(hypothesis.rig, recordings_);
  for (std::size_t r = 0; 2 * r + 1 < hypothesis.swing_Pa.size(); ++r) {
    const double sine = hypothesis.swing_Pa[2 * r], cosine = hypothesis.swing_Pa[2 * r + 1];
    rigs.own(r).axis.effects.supply_swing = {std::hypot(sine, cosine), hypothesis.swing_Hz, std::atan2(cosine, sine)};
  }
  return rigs;
}

ImposedRun GasRuns::run_of(const RecordedRigs& rigs, const Hypothesis& hypothesis, std::size_t recording) {
  ImposedRun run{&rigs[recording], {}};
  const std::vector<double>& factors = hypothesis.start_factors;
  for (std::size_t side = 0; side < 2; ++side)
    if (2 * recording + side < factors.size()) run.start_factor[side] = factors[2 * recording + side];
  return run;
}

SidedCourse::Half GasRuns::Known::find(const Key& key) {
  const auto found = halves.find(key);
  if (found == halves.end()) return {};
  order.splice(order.begin(), order, found->second.use);
  return found->second.half;
}

void GasRuns::Known::add(const Key& key, SidedCourse::Half half) {
  const auto [at, added] = halves.emplace(key, Stored{std::move(half), {}});
  if (!added) return;
  order.push_front(&at->first);
  at->second.use = order.begin();
  if (order.size() <= most_known) return;
  const Key* oldest = order.back();
  order.pop_back();
  halves.erase(halves.find(*oldest));
}

std::vector<SidedCourse> GasRuns::simulate(std::size_t recording, std::span<const ImposedRun> runs) const {
  const GasCourse& error = grid_error_[recording];
  std::vector<SidedCourse> out;
  for (GasCourse& course : run_or_drop(recordings_[recording].inputs, runs, work_grid_[recording], stop_)) {
    for (const Signal signal : gas_signals)
      for (std::size_t k = 0; k < error[signal].size(); ++k) course[signal][k] += error[signal][k];
    out.emplace_back(std::move(course));
  }
  return out;
}

std::vector<std::vector<SidedCourse>> GasRuns::of(std::span<const Hypothesis> hypotheses) {
  std::vector<RecordedRigs> rigs;
  rigs.reserve(hypotheses.size());
  for (const Hypothesis& hypothesis : hypotheses) rigs.push_back(rigs_of(hypothesis));
  std::vector<Asked> asked(recordings_.size());
  std::deque<Batch> batches;  // runs point to rigs in them
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    for (std::size_t i = 0; i < hypotheses.size(); ++i) {
      asked[r].runs.push_back(run_of(rigs[i], hypotheses[i], r));
      GasNumbers numbers = gas_numbers(asked[r].runs.back(), recordings_[r].inputs, is_flow_wanted(r));
      asked[r].of_run.emplace_back();
      for (std::size_t side = 0; side < 2; ++side) {
        Key key = numbers.of_both;
        key.insert(key.end(), numbers.of_side[side].begin(), numbers.of_side[side].end());
        const auto [at, added] = asked[r].halves[side].try_emplace(std::move(key));
        asked[r].of_run.back()[side] = &at->second;
        if (added && !(at->second = known_[r][side].find(at->first)))
          asked[r].missing[side].push_back({i, numbers.of_both, &at->first, &at->second});
      }
    }
    add_batches(asked[r], recordings_[r].inputs, r, batches);
  }
  in_parallel(batches.size(), jobs_,
              [&](std::size_t b) { batches[b].courses = simulate(batches[b].recording, batches[b].runs); });
  for (const Batch& batch : batches)
    for (std::size_t i = 0; i < batch.runs.size(); ++i)
      for (std::size_t side = 0; side < 2; ++side) {
        const Missing* wanted = batch.sides[i][side];
        if (wanted == nullptr || !is_finite(*batch.courses[i].half(side), side)) continue;
        *wanted->half = batch.courses[i].half(side);
        known_[batch.recording][side].add(*wanted->key, *wanted->half);
      }
  // Gas that left all bounds takes the other side of its run with it: each such hypothesis once more by itself.
  std::vector<std::vector<SidedCourse>> out(hypotheses.size(), std::vector<SidedCourse>(recordings_.size()));
  std::vector<std::pair<std::size_t, std::size_t>> by_itself;
  for (std::size_t i = 0; i < hypotheses.size(); ++i)
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      const auto& [first, second] = asked[r].of_run[i];
      if (*first && *second) out[i][r] = SidedCourse(*first, *second);
      else by_itself.emplace_back(i, r);
    }
  in_parallel(by_itself.size(), jobs_, [&](std::size_t at) {
    const auto [i, r] = by_itself[at];
    out[i][r] = simulate(r, std::span(&asked[r].runs[i], 1)).front();
  });
  return out;
}

void GasRuns::set_working_point(const Hypothesis& hypothesis) {
  std::vector<GasCourse> fine(recordings_.size()), work(recordings_.size());
  const RecordedRigs rigs = rigs_of(hypothesis);
  in_parallel(2 * recordings_.size(), jobs_, [&](std::size_t i) {  // the long ones first
    const std::size_t r = i % recordings_.size();
    const bool is_fine = i < recordings_.size();
    const std::array<ImposedRun, 1> run{run_of(rigs, hypothesis, r)};
    (is_fine ? fine : work)[r] =
        run_imposed(recordings_[r].inputs, run, (is_fine ? fine_grid_ : work_grid_)[r], stop_)[0];
  });
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    const auto is_whole = [](const GasCourse& gas) { return is_finite(gas, 0) && is_finite(gas, 1); };
    if (!is_whole(fine[r]) || !is_whole(work[r])) continue;
    for (const Signal signal : gas_signals)
      for (std::size_t k = 0; k < fine[r][signal].size(); ++k) fine[r][signal][k] -= work[r][signal][k];
    grid_error_[r] = std::move(fine[r]);
    known_[r] = {};
  }
}

}  // namespace pneuservo
