// The writer: the same bits back, both modes, kill -9, faults of the disk.
#include <catch2/catch.hpp>

#include <bit>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <memory>
#include <random>
#include <thread>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "config/input_error.hpp"
#include "core/test_seed.hpp"
#include "record/files.hpp"
#include "record/row_text.hpp"
#include "record/writer.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

constexpr std::array<std::string_view, 3> terms{"force_error_N", "u_feedforward_V", "command_limit"};

double random_bits(std::mt19937_64& generator) {
  switch (generator() % 8) {
    case 0: return std::bit_cast<double>(generator() & 0x800fffffffffffffull);  // denormal or zero of either sign
    case 1: return -0.0;
    case 2: return Row::none;
    case 3: return std::round(std::bit_cast<double>(0x4000000000000000ull | (generator() >> 12)) * 1e6) * 1e-6;
    default: return std::bit_cast<double>(generator());
  }
}

bool same_bits(double a, double b) {
  return std::isnan(a) ? std::isnan(b) : std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

std::vector<Row> random_rows(std::size_t count, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::vector<Row> rows(count);
  for (std::size_t i = 0; i < count; ++i) {
    Row::visit(
        [&](std::string_view, auto& value) {
          if constexpr (std::is_same_v<std::decay_t<decltype(value)>, double>) value = random_bits(generator);
          else value = static_cast<std::uint32_t>(generator());
        },
        rows[i]);
    for (double& term : rows[i].terms) term = random_bits(generator);
    rows[i].t_s = static_cast<double>(i) * 0.0002;
  }
  return rows;
}

/// Reads the file and compares every column; only problems of the allowed kind (inf was written) may appear.
void require_same(const std::string& path, const std::vector<Row>& rows, const std::vector<std::string>& columns) {
  const Recording recording = read_recording(path);
  REQUIRE(recording.names == columns);
  REQUIRE(recording.rows() == rows.size());
  for (const auto& problem : recording.problems) REQUIRE(problem.kind == ProblemKind::not_a_number);
  for (std::size_t i = 0; i < rows.size(); ++i)
    Row::visit_all(
        terms,
        [&](std::string_view name, const auto& value) {
          if (!recording.has(name)) return;
          INFO("row " << i << ", column " << name);
          REQUIRE(same_bits(recording.column(name)[i], static_cast<double>(value)));
        },
        rows[i]);
}

}  // namespace

TEST_CASE("any numbers read back to the same bits, from the caller's thread and from the writer's") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  const auto rows = random_rows(3000, seed);
  const TemporaryFolder folder;
  const RecordingHeader header("bits", 0.0002);

  RecordingWriter direct(folder.file("direct.csv.gz"), header, {}, {.terms = terms});
  for (const Row& row : rows) direct.write(row);
  const auto summary = direct.close();
  REQUIRE(summary.error.empty());
  REQUIRE(summary.rows == 3000);
  require_same(direct.path(), rows, row_columns(terms));

  const auto ring = std::make_shared<RecordingRing>(4096);
  RecordingWriter threaded(folder.file("threaded.csv.gz"), header, {"x_m", "flags", "u_V"}, {.ring = ring});
  for (const Row& row : rows) ring->push(row);
  REQUIRE(threaded.close().rows == 3000);
  require_same(threaded.path(), rows, {"t_s", "x_m", "u_V", "flags"});
}

TEST_CASE("a header reads back key by key, in order, a whole config as text") {
  const TemporaryFolder folder;
  const std::string config = "  first: indented\n\nname: \"a # b\"\nlist:\n  - {x: 1}\n";
  RecordingHeader header("rig: with colon", 0.001);
  header.add_yaml("reference", "{kind: steps, positions_m: [0.0, 0.1]}");
  header.add_yaml("limits", "speed_mps: 1.5\nforce:\n  max_N: 20");
  header.add_text("config", config);
  header.add_text("kernel", "6.1.0-rt, #1 SMP");
  header.add_number("start_s", 0.1);
  REQUIRE_THROWS_AS(header.add_text("rig", "again"), std::invalid_argument);
  REQUIRE_THROWS_AS(header.add_yaml("broken", "{a: "), std::invalid_argument);

  RecordingWriter writer(folder.file("h.csv.gz"), header, {"x_m"});
  writer.write(numbered_row(0));
  writer.close();
  const Recording recording = read_recording(writer.path());
  REQUIRE(problems_of(recording).empty());
  REQUIRE(recording.comments.starts_with("format: pneuservo-recording/1\nrig: "));
  REQUIRE(recording.rig == "rig: with colon");
  REQUIRE(recording.period_s == 0.001);
  REQUIRE(recording.header["reference"]["positions_m"][1].as<double>() == 0.1);
  REQUIRE(recording.header["limits"]["force"]["max_N"].as<int>() == 20);
  REQUIRE(recording.header["config"].as<std::string>() == config);
  REQUIRE(recording.header["kernel"].as<std::string>() == "6.1.0-rt, #1 SMP");
  REQUIRE(recording.header["start_s"].as<double>() == 0.1);
}

TEST_CASE("a loop that outruns the writer leaves its last cycles and the number of dropped rows in the file") {
  const TemporaryFolder folder;
  constexpr int last = 100, total = 60000;
  const auto ring = std::make_shared<RecordingRing>(last);
  RecordingWriter writer(folder.file("fast.csv.gz"), RecordingHeader("fast", 0.001), {"x_m", "u_V", "flags"},
                         {.ring = ring});
  for (int i = 0; i < total; ++i) {
    Row row = numbered_row(i);
    if (i == total - 1) row.flags = row_fault;
    ring->push(row);
    // A gap shows between two rows: the writer gets the first one.
    if (i == 0) std::this_thread::sleep_for(3 * RecordingWriter::flush_interval);
  }
  const RecordingSummary summary = writer.close();
  REQUIRE(summary.error.empty());
  REQUIRE(summary.rows + summary.dropped == total);
  REQUIRE(summary.whole() == (summary.dropped == 0));
  const Recording recording = read_recording(writer.path());
  REQUIRE(static_cast<std::int64_t>(recording.rows()) == summary.rows);
  REQUIRE(static_cast<std::int64_t>(recording.dropped_rows) == summary.dropped);
  REQUIRE(recording.missing_rows == recording.dropped_rows);
  REQUIRE(static_cast<std::uint32_t>(recording.column("flags").back()) / row_fault % 2 == 1);
  for (int i = 0; i < last; ++i) {
    const std::size_t row = recording.rows() - last + static_cast<std::size_t>(i);
    REQUIRE(recording.t_s()[row] == (total - last + i) * 1e-3);
    REQUIRE(recording.column("u_V")[row] == (total - last + i) / 3.0);
  }
}

TEST_CASE("after kill -9 the file holds everything up to the last flush") {
  const TemporaryFolder folder;
  const std::string path = folder.file("killed.csv.gz");
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const auto ring = std::make_shared<RecordingRing>();
    RecordingWriter writer(path, RecordingHeader("killed", 0.001), {"x_m", "u_V", "flags"}, {.ring = ring});
    for (int i = 0; i < 1000; ++i) ring->push(numbered_row(i));
    Row fault = numbered_row(1000);
    fault.flags = row_fault;  // is flushed at once
    ring->push(fault);
    std::this_thread::sleep_for(3 * RecordingWriter::flush_interval);
    for (int i = 1001; i < 1400; ++i) ring->push(numbered_row(i));
    if (::write(ready[1], "x", 1) != 1) ::_exit(3);
    for (;;) ::pause();
  }
  char byte;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  ::kill(child, SIGKILL);
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  REQUIRE(WIFSIGNALED(status));
  ::close(ready[0]);
  ::close(ready[1]);

  const Recording recording = read_recording(path);
  REQUIRE(recording.rows() >= 1001);
  REQUIRE(recording.problems.size() == 1);
  REQUIRE(recording.problems[0].kind == ProblemKind::truncated);
  for (std::size_t i = 0; i < recording.rows(); ++i) REQUIRE(recording.column("u_V")[i] == static_cast<int>(i) / 3.0);
}

TEST_CASE("a recording that cannot be begun is refused at once, with path and reason") {
  const TemporaryFolder folder;
  const RecordingHeader header("r", 0.001);
  const auto open = [&](const std::string& path) { RecordingWriter(path, header, {"x_m"}); };
  REQUIRE_THROWS_WITH(open(folder.file("none/r.csv.gz")),
                      Contains("none/r.csv.gz") && Contains("No such file or directory"));
  REQUIRE_THROWS_WITH(open(folder.file("r.txt")), Contains("must end in .csv.gz"));
  std::filesystem::create_directory(folder.file("d.csv.gz"));
  REQUIRE_THROWS_WITH(open(folder.file("d.csv.gz")), Contains("Is a directory"));
  std::filesystem::create_symlink("/dev/full", folder.file("full.csv.gz"));
  REQUIRE_THROWS_WITH(open(folder.file("full.csv.gz")), Contains("No space left on device"));
  REQUIRE_THROWS_AS(open(folder.file("full.csv.gz")), InputError);
  REQUIRE_THROWS_WITH(RecordingWriter(folder.file("c.csv.gz"), header, {"speed"}), Contains("speed"));
  REQUIRE_THROWS_AS(RecordingWriter(folder.file("c.csv.gz"), header, {"speed"}), InputError);
}

TEST_CASE("a recording is not overwritten, unless that is said, links to nothing are not followed") {
  const TemporaryFolder folder;
  const RecordingHeader header("r", 0.001);
  const std::string path = put_plain(folder.file("r.csv.gz"), "the only recording of a fault");
  const auto open = [&](const std::string& to, ExistingFile existing) {
    RecordingWriter(to, header, {"x_m"}, {.existing = existing});
  };
  REQUIRE_THROWS_WITH(open(path, ExistingFile::refuse), Contains("never overwritten"));
  REQUIRE(bytes_of(path) == "the only recording of a fault");
  std::filesystem::create_symlink(path, folder.file("link.csv.gz"));
  REQUIRE_THROWS_AS(open(folder.file("link.csv.gz"), ExistingFile::refuse), InputError);
  std::filesystem::create_symlink(folder.file("nothing"), folder.file("dangling.csv.gz"));
  REQUIRE_THROWS_AS(open(folder.file("dangling.csv.gz"), ExistingFile::refuse), InputError);
  REQUIRE_FALSE(std::filesystem::exists(folder.file("nothing")));
  open(path, ExistingFile::replace);
  REQUIRE(bytes_of(path).starts_with("\x1f\x8b"));
}

TEST_CASE("a writer whose reader takes nothing is left behind at the end, and the rows that are missing are told") {
  const TemporaryFolder folder;
  const std::string path = folder.file("pipe.csv.gz");
  REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
  const int reader = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
  const auto ring = std::make_shared<RecordingRing>();
  RecordingWriter writer(path, RecordingHeader("hung", 0.001), {"x_m", "u_V"}, {.ring = ring});
  for (int i = 0; i < 16000; ++i) ring->push(numbered_row(i));  // 300 kB into a pipe of 64 kB
  const RecordingSummary summary = writer.close([] { return true; });
  REQUIRE_THAT(summary.error, Contains("pipe.csv.gz") && Contains("of 16000 rows"));
  REQUIRE_FALSE(summary.whole());
  REQUIRE(summary.rows < 16000);
  REQUIRE(writer.close().error == summary.error);
  ::close(reader);  // the thread that was left behind ends by itself; a fork beside it could copy a lock that it holds
  const auto threads = [] {
    using Entries = std::filesystem::directory_iterator;
    return std::distance(Entries("/proc/self/task"), Entries());
  };
  for (int wait = 0; wait < 2000 && threads() > 1; ++wait) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

TEST_CASE("a disk that fills up later is reported by close, and what was written before is readable") {
  const TemporaryFolder folder;
  const std::string path = folder.file("limited.csv.gz");
  int answer[2];
  REQUIRE(::pipe(answer) == 0);
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    // A limit on the size of files stands for a disk with that much room.
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100000, 100000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    RecordingWriter writer(path, RecordingHeader("limited", 0.001), {"x_m", "u_V"});
    for (int i = 0; i < 50000; ++i) writer.write(numbered_row(i));
    const std::string error = writer.close().error;
    const bool told = ::write(answer[1], error.data(), error.size()) == static_cast<ssize_t>(error.size());
    ::_exit(told ? 0 : 3);
  }
  ::close(answer[1]);
  char text[1000];
  const ssize_t size = ::read(answer[0], text, sizeof text);
  ::close(answer[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  REQUIRE(size > 0);
  REQUIRE_THAT(std::string(text, static_cast<std::size_t>(size)),
               Contains("limited.csv.gz") && Contains("File too large"));
  const Recording recording = read_recording(path);
  REQUIRE(recording.rows() > 1000);
  REQUIRE(recording.rows() < 50000);
  REQUIRE(recording.problems.back().kind == ProblemKind::truncated);
}
