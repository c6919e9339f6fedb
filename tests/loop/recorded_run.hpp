// A run for tests: the loop on a backend over chosen ticks, recorded to a file, read again and replayed.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include <pneuservo/loop/axis_loop.hpp>

#include "loop/course.hpp"
#include "loop/replay.hpp"
#include "record/reader.hpp"
#include "record/writer.hpp"
#include "replay/replay_backend.hpp"

namespace pneuservo {

/// Runs until the course ends; after the ticks in `late` so many slots are skipped. Writes `path` and returns the rows.
inline std::vector<Row> recorded_run(const Rig& rig, Backend& backend, const std::string& path, int moves = 1,
                                     const std::vector<std::pair<std::int64_t, std::int64_t>>& late = {}) {
  AxisLoop loop;
  loop.configure(rig);
  Course course(rig, moves);
  backend.configure();
  backend.activate();
  RecordingHeader header(rig.name, rig.period_s);
  RecordingWriter writer(path, header, {}, {.terms = law_columns(rig.controller.kind)});
  std::int64_t skipped = 0;
  for (std::int64_t tick = 0;; ++tick) {
    loop.pass(backend, tick, skipped, nullptr, nullptr);
    writer.write(loop.row());
    if (!course.after(tick, loop)) break;
    if (loop.learning_due()) loop.learn(rig.axis);
    skipped = 0;
    for (const auto& [after, slots] : late)
      if (tick == after) skipped = slots;
    tick += skipped;
  }
  backend.deactivate();
  writer.close();
  return course.take_rows();
}

inline ReplayResult replayed(const Rig& rig, Recording recording, int moves = 1) {
  ReplayBackend backend(std::move(recording), rig.period_s);
  std::vector<std::int64_t> ticks;
  for (std::size_t i = 0; i < backend.rows(); ++i) ticks.push_back(backend.tick(i));
  std::vector<std::pair<std::string, const std::vector<double>*>> columns;
  for (const auto& name : replayed_columns(rig.controller.kind))
    columns.emplace_back(name, &backend.recording().column(name));
  backend.configure();
  backend.activate();
  return replay_loop(rig, backend, ticks, std::vector<std::uint32_t>(ticks.size()), moves, {}, columns);
}

}  // namespace pneuservo
