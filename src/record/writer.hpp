// Writes a recording while a run goes on: in a thread of its own (real time) or in the caller's (simulated time).
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <pneuservo/record/ring.hpp>

#include "record/gzip_file.hpp"
#include "record/header.hpp"
#include "record/live_values.hpp"
#include "record/row_text.hpp"

namespace pneuservo {

/// What a closed recording holds.
struct RecordingSummary {
  std::int64_t rows = 0;     ///< written
  std::int64_t dropped = 0;  ///< lost, because the writer came too late; never any of the last before the end
  std::string error;         ///< empty, or one sentence: what is missing from the file and why
};

/// A file is created, its header written and flushed in the constructor, so an unusable path shows before the run.
///
/// Real time: give a ring. A thread (ordinary priority, all signals blocked) drains it, flushes to disk every
/// `flush_interval`, and at once when a fault begins. Simulated time: no ring; call write() for every row.
/// SIGINT and SIGTERM are the loop's: it ends and calls close().
class RecordingWriter {
 public:
  static constexpr std::chrono::milliseconds flush_interval{200};

  /// Simulated time. `columns`: names of the columns that this run has, empty = all. Throws InputError.
  /// `live`: gets each row after it was written, in the writing thread; must outlive the writer; null: nobody.
  RecordingWriter(std::string path, const RecordingHeader& header, const std::vector<std::string>& columns,
                  LiveValues* live = nullptr);
  /// Real time. The ring must outlive the writer. Throws InputError.
  RecordingWriter(std::string path, const RecordingHeader& header, const std::vector<std::string>& columns,
                  RecordingRing& ring, LiveValues* live = nullptr);
  /// Closes.
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Simulated time only (with a ring, push into the ring).
  void write(const Row& row);
  /// Writes what is left in the ring, ends the file. Call after the producer's last push. Repeatable.
  RecordingSummary close();
  const std::string& path() const noexcept { return file_.path(); }

 private:
  void run();
  bool drain();
  void append(const Row& row);
  void pass_on();
  void flush();
  void flush_when_due();

  GzipFile file_;
  RowText text_;
  std::vector<char> buffer_;
  std::size_t used_ = 0;
  std::int64_t rows_ = 0;
  bool in_fault_ = false;
  std::chrono::steady_clock::time_point flushed_;
  LiveValues* live_ = nullptr;
  RecordingRing* ring_ = nullptr;
  std::atomic<bool> closing_{false};
  std::thread thread_;
};

}  // namespace pneuservo
