// Writes a recording while a run goes on: in a thread of its own (real time) or in the caller's (simulated time).
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <pneuservo/record/ring.hpp>

#include "record/gzip_file.hpp"
#include "record/header.hpp"
#include "record/live_values.hpp"
#include "record/series.hpp"

namespace pneuservo {

/// What a closed recording holds.
struct RecordingSummary {
  std::int64_t rows = 0;     ///< written
  std::int64_t dropped = 0;  ///< lost, because the writer came too late; never any of the last before the end
  std::string error;         ///< empty, or one sentence: what is missing from the file and why
  bool whole() const noexcept { return dropped == 0 && error.empty(); }
};

/// How a recording is written beside its path, header and columns.
struct RecordingOptions {
  std::shared_ptr<RecordingRing> ring{};  ///< real time: rows come from here; none: from write()
  std::shared_ptr<LiveValues> live{};  ///< gets each row after it was written, in the writing thread
  ExistingFile existing = ExistingFile::refuse;
  std::span<const std::string_view> terms{};  ///< columns of Row::terms
  std::shared_ptr<RecordingSeries> series{};  ///< without end, a file after the other; they have their paths from here
};

/// A file is created, its header written and flushed in the constructor, so an unusable path shows before the run.
///
/// Real time: give a ring. A thread (ordinary priority, all signals blocked) drains it, flushes to disk every
/// `flush_interval`, and at once when a fault begins. Simulated time: no ring; call write() for every row.
/// Signals are the loop's: it ends and calls close().
class RecordingWriter {
 public:
  static constexpr std::chrono::milliseconds flush_interval{200};
  /// Longest wait for the thread at the end: three times the 3 s that the ring bridges at 200 us, for a disk that is
  /// slow and not hung.
  static constexpr std::chrono::seconds closing_limit{10};

  /// `path` is not used for a series. `columns`: names of the columns that this run has, empty = all. Throws
  /// InputError.
  RecordingWriter(std::string path, const RecordingHeader& header, const std::vector<std::string>& columns,
                  RecordingOptions options = {});
  /// Closes.
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Simulated time only (with a ring, push into the ring).
  void write(const Row& row);
  /// Writes what is left in the ring, ends the file. Call after the producer's last push. Repeatable. A thread that is
  /// not done within `closing_limit`, or when `give_up` says so, is left to itself with all that it uses; the summary
  /// then says what is not in the file.
  RecordingSummary close(const std::function<bool()>& give_up = {});
  const std::string& path() const noexcept;
  /// Real time: where the rows come from; null in simulated time.
  RecordingRing* ring() const noexcept;

 private:
  struct Work;
  bool wait_for_thread(const std::function<bool()>& give_up) const;

  std::shared_ptr<Work> work_;  // shared with a thread that may outlive this object
  std::thread thread_;
  bool abandoned_ = false;
};

}  // namespace pneuservo
