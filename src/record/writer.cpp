// Writes a recording while a run goes on: in a thread of its own (real time) or in the caller's (simulated time).
#include "record/writer.hpp"

#include <csignal>
#include <pthread.h>

#include "config/input_error.hpp"

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

/// A thread inherits the policy of the one that starts it; the writer must never compete with the loop.
void become_ordinary_thread() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  const sched_param parameters{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &parameters);
  pthread_setname_np(pthread_self(), "recording");
}

}  // namespace

RecordingWriter::RecordingWriter(std::string path, const RecordingHeader& header,
                                 const std::vector<std::string>& columns, LiveValues* live)
    : file_(checked(std::move(path))), text_(columns), buffer_(buffer_size), live_(live) {
  file_.write(header.comment_lines());
  file_.write(text_.header_line());
  flush();
  if (!file_.error().empty()) throw InputError(file_.error());
}

RecordingWriter::RecordingWriter(std::string path, const RecordingHeader& header,
                                 const std::vector<std::string>& columns, RecordingRing& ring, LiveValues* live)
    : RecordingWriter(std::move(path), header, columns, live) {
  ring_ = &ring;
  thread_ = std::thread([this] { run(); });
}

// Throws where memory has run out, and there is no way on from that.
RecordingWriter::~RecordingWriter() { close(); }  // NOLINT(bugprone-exception-escape)

void RecordingWriter::run() {
  become_ordinary_thread();
  while (!closing_.load(std::memory_order_acquire)) {
    if (!drain()) std::this_thread::sleep_for(idle_time);
    flush_when_due();
  }
}

bool RecordingWriter::drain() {
  // Bounded, so that flushes stay due even while rows keep coming.
  Row row;
  std::int64_t count = 0;
  while (count < rows_between_clock_reads && ring_->pop(row)) {
    append(row);
    ++count;
  }
  return count == rows_between_clock_reads;
}

void RecordingWriter::write(const Row& row) {
  append(row);
  if (rows_ % rows_between_clock_reads == 0) flush_when_due();
}

void RecordingWriter::append(const Row& row) {
  if (buffer_.size() - used_ < RowText::line_size_max) pass_on();
  char* const start = buffer_.data() + used_;
  used_ += static_cast<std::size_t>(text_.line(start, row) - start);
  ++rows_;
  if (live_ != nullptr) live_->send(row);
  const bool fault = (row.flags & row_fault) != 0;
  if (fault && !in_fault_) flush();
  in_fault_ = fault;
}

void RecordingWriter::pass_on() {
  file_.write({buffer_.data(), used_});
  used_ = 0;
}

void RecordingWriter::flush() {
  pass_on();
  // A simulation can be run again: it need not survive a loss of power and does not wait for the disk.
  file_.flush(ring_ != nullptr);
  flushed_ = std::chrono::steady_clock::now();
}

void RecordingWriter::flush_when_due() {
  if (std::chrono::steady_clock::now() - flushed_ >= flush_interval) flush();
}

RecordingSummary RecordingWriter::close() {
  closing_.store(true, std::memory_order_release);
  if (thread_.joinable()) {
    thread_.join();
    while (drain()) {}
    flush();
  }
  pass_on();
  file_.close();
  return {rows_, ring_ != nullptr ? ring_->dropped() : 0, file_.error()};
}

}  // namespace pneuservo
