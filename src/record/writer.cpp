// Writes a recording while a run goes on: in a thread of its own (real time) or in the caller's (simulated time).
#include "record/writer.hpp"

#include <atomic>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "record/ordinary_thread.hpp"
#include "record/row_text.hpp"

namespace pneuservo {

namespace {

constexpr std::size_t buffer_size = 1 << 16;
constexpr std::chrono::milliseconds idle_time{5};  // 25 rows at 200 us, of a ring of thousands
constexpr std::int64_t rows_between_clock_reads = 512;

/// The file's name decides how others open it, so it has to tell the truth.
std::string checked(std::string path) {
  if (!path.ends_with(".csv.gz")) throw InputError(path + ": a recording's name must end in .csv.gz");
  return path;
}

}  // namespace

/// The file and what is on its way into it.
struct RecordingWriter::Work {
  Work(std::string path, const RecordingHeader& header, const std::vector<std::string>& columns,
       RecordingOptions chosen)
      : options(std::move(chosen)), text(columns, options.terms), head(header.comment_lines() + text.header_line()),
        buffer(buffer_size) {
    open(options.series ? options.series->begin_part() : std::move(path));
    name = file->path();
    flush();
    if (!file->error().empty()) throw InputError(file->error());
  }

  void open(std::string path) {
    file = std::make_unique<GzipFile>(checked(std::move(path)), options.existing);
    file->write(head);
  }

  /// The next file of a series. Where it cannot be made the rows up to the next one after it are lost, and it is told.
  void next_part() {
    pass_on();
    file->close();
    note_error(file->error());
    try {
      open(options.series->begin_part());
    } catch (const std::exception& problem) { note_error(problem.what()); }
    flush();
  }

  void note_error(const std::string& sentence) {
    if (sentence.empty()) return;
    options.series->note_trouble(sentence);
    if (error.empty()) error = sentence;
  }

  void run() {
    become_ordinary_thread("recording");
    while (!closing.load(std::memory_order_acquire)) {
      if (!drain()) std::this_thread::sleep_for(idle_time);
      flush_when_due();
    }
    while (drain()) {}
    end();
    done.store(true, std::memory_order_release);
  }

  /// Bounded, so that flushes stay due even while rows keep coming. False: the ring is empty.
  bool drain() {
    Row row;
    std::int64_t count = 0;
    while (count < rows_between_clock_reads && options.ring->pop(row)) {
      append(row);
      ++count;
    }
    return count == rows_between_clock_reads;
  }

  void append(const Row& row) {
    if (buffer.size() - used < RowText::line_size_max) pass_on();
    char* const start = buffer.data() + used;
    used += static_cast<std::size_t>(text.line(start, row) - start);
    ++rows;
    if (options.live) options.live->send(row);
    const bool fault = (row.flags & row_fault) != 0;
    if (fault && !in_fault) flush();
    in_fault = fault;
    if (options.series && options.series->after(row)) next_part();
  }

  void pass_on() {
    file->write({buffer.data(), used});
    used = 0;
  }

  void flush() {
    pass_on();
    // A simulation can be run again: it need not survive a loss of power and does not wait for the disk.
    file->flush(options.ring != nullptr);
    flushed = std::chrono::steady_clock::now();
    rows_flushed.store(rows, std::memory_order_relaxed);
  }

  void flush_when_due() {
    if (std::chrono::steady_clock::now() - flushed >= flush_interval) flush();
  }

  void end() {
    if (options.ring) flush();
    pass_on();
    file->close();
    if (error.empty()) error = file->error();
  }

  RecordingOptions options;
  RowText text;
  std::string head, error;
  std::string name;  ///< of the first file
  std::unique_ptr<GzipFile> file;
  std::vector<char> buffer;
  std::size_t used = 0;
  std::int64_t rows = 0;
  bool in_fault = false;
  std::chrono::steady_clock::time_point flushed;
  std::atomic<bool> closing{false}, done{false};
  std::atomic<std::int64_t> rows_flushed{0};
};

RecordingWriter::RecordingWriter(std::string path, const RecordingHeader& header,
                                 const std::vector<std::string>& columns, RecordingOptions options)
    : work_(std::make_shared<Work>(std::move(path), header, columns, std::move(options))) {
  if (work_->options.ring) thread_ = std::thread([work = work_] { work->run(); });
}

// Throws where memory has run out, and there is no way on from that.
RecordingWriter::~RecordingWriter() { close(); }  // NOLINT(bugprone-exception-escape)

void RecordingWriter::write(const Row& row) {
  work_->append(row);
  if (work_->rows % rows_between_clock_reads == 0) work_->flush_when_due();
}

RecordingRing* RecordingWriter::ring() const noexcept { return work_->options.ring.get(); }

const std::string& RecordingWriter::path() const noexcept { return work_->name; }

bool RecordingWriter::wait_for_thread(const std::function<bool()>& give_up) const {
  const auto limit = std::chrono::steady_clock::now() + closing_limit;
  while (!work_->done.load(std::memory_order_acquire)) {
    if (std::chrono::steady_clock::now() > limit || (give_up && give_up())) return false;
    std::this_thread::sleep_for(idle_time);
  }
  return true;
}

RecordingSummary RecordingWriter::close(const std::function<bool()>& give_up) {
  work_->closing.store(true, std::memory_order_release);
  if (thread_.joinable()) {
    abandoned_ = !wait_for_thread(give_up);
    abandoned_ ? thread_.detach() : thread_.join();
  }
  const std::int64_t dropped = work_->options.ring ? work_->options.ring->dropped() : 0;
  if (abandoned_) {
    const std::int64_t pushed = work_->options.ring->pushed(), there = work_->rows_flushed;
    return {there, dropped,
            fmt::format("{}: the recording could not be ended, its disk or reader takes nothing: {} of {} rows are in "
                        "the file for certain, the others may be missing",
                        path(), there, pushed)};
  }
  if (!work_->options.ring) work_->end();
  return {work_->rows, dropped, work_->error};
}

}  // namespace pneuservo
