// A recording as a series of files: names, lengths, what is kept around faults and marks, what goes, and that nothing
// is written over.
#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>

#include "config/input_error.hpp"
#include "record/files.hpp"
#include "record/reader.hpp"
#include "record/series.hpp"
#include "record/writer.hpp"

using namespace pneuservo;
namespace fs = std::filesystem;

namespace {

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) names.insert(entry.path().filename().string());
  return names;
}

/// Rows of 10 ms from a time on; an event at event_s: a fault of 0.1 s, or a mark.
void write_rows(RecordingWriter& writer, double from_s, double to_s, double event_s = -1.0, bool mark = false) {
  for (std::int64_t k = std::llround(from_s / 0.01); k < std::llround(to_s / 0.01); ++k) {
    Row row;
    row.t_s = 0.01 * static_cast<double>(k);
    const double since_s = row.t_s - event_s;
    if (mark && std::fabs(since_s) < 0.005) row.command_kind = RecordingSeries::mark_command;
    if (!mark && event_s >= 0.0 && since_s >= 0.0 && since_s < 0.1) row.flags = row_fault;
    writer.write(row);
  }
}

RecordingWriter writer_of(const std::shared_ptr<RecordingSeries>& series) {
  return RecordingWriter("", RecordingHeader("rig", 0.01), {"t_s", "flags", "command_kind"}, {.series = series});
}

}  // namespace

TEST_CASE("a series begins a file each part_s, and its rows are all there") {
  const TemporaryFolder temporary;
  const fs::path folder = temporary.file("series");
  auto series = std::make_shared<RecordingSeries>(SeriesSettings{.folder = folder, .stem = "axis-a", .part_s = 2.0});
  {
    RecordingWriter writer = writer_of(series);
    write_rows(writer, 0.0, 7.0);
    CHECK(writer.close().whole());
  }
  CHECK(names_in(folder) == std::set<std::string>{"axis-a-000001.csv.gz", "axis-a-000002.csv.gz",
                                                  "axis-a-000003.csv.gz", "axis-a-000004.csv.gz"});
  std::size_t rows = 0;
  for (const std::string& name : names_in(folder)) rows += read_recording((folder / name).string()).rows();
  CHECK(rows == 700);
  CHECK_THROWS_AS(RecordingSeries(SeriesSettings{.folder = folder, .stem = "axis-a"}), InputError);
  CHECK(series->state().parts == 4);
}

TEST_CASE("files within around_s of a fault or mark are kept at once, others are not") {
  for (const bool mark : {false, true}) {
    const TemporaryFolder temporary;
    const fs::path folder = temporary.file("series");
    auto series = std::make_shared<RecordingSeries>(
        SeriesSettings{.folder = folder, .stem = "axis-a", .part_s = 2.0, .around_s = 3.0});
    RecordingWriter writer = writer_of(series);
    write_rows(writer, 0.0, 20.0, 9.0, mark);
    // 6 to 12 s: the fourth file (6.0 to 8.0 s) up to the one that holds 12 s.
    const auto kept = names_in(folder / "kept");
    CHECK(kept.contains("axis-a-000004.csv.gz"));
    CHECK(kept.contains("axis-a-000005.csv.gz"));
    CHECK(kept.contains("axis-a-000006.csv.gz"));
    CHECK(!kept.contains("axis-a-000002.csv.gz"));
    CHECK(!kept.contains("axis-a-000008.csv.gz"));
    CHECK(series->state().kept == static_cast<std::int64_t>(kept.size()));
    write_rows(writer, 20.0, 21.0);
    CHECK(writer.close().whole());
    double first_s = 1e9, last_s = 0.0;
    for (const std::string& name : kept) {
      const Recording part = read_recording((folder / "kept" / name).string());
      first_s = std::min(first_s, part.t_s().front());
      last_s = std::max(last_s, part.t_s().back());
    }
    CHECK(first_s <= 6.0);
    CHECK(last_s >= 12.0);
  }
}

TEST_CASE("the oldest files go beyond the budget, kept ones stay, a full folder of kept ones is told") {
  const TemporaryFolder temporary;
  const fs::path folder = temporary.file("series");
  fs::create_directories(folder / "kept");
  const auto fill = [](const fs::path& path, std::size_t bytes) { std::ofstream(path) << std::string(bytes, 'x'); };
  for (int i = 0; i < 5; ++i) fill(folder / ("axis-2020-00000" + std::to_string(i) + ".csv.gz"), 300'000);
  fill(folder / "kept" / "axis-2020-000009.csv.gz", 900'000);
  auto series = std::make_shared<RecordingSeries>(SeriesSettings{
      .folder = folder, .stem = "axis-2021", .part_s = 2.0, .budget_MB = 1.0, .kept_MB = 0.9, .around_s = 1.0});
  RecordingWriter writer = writer_of(series);
  write_rows(writer, 0.0, 8.0, 5.0, true);
  CHECK(writer.close().whole());
  const auto left = names_in(folder);
  CHECK(!left.contains("axis-2020-000000.csv.gz"));
  CHECK(!left.contains("axis-2020-000002.csv.gz"));
  CHECK(left.contains("axis-2020-000004.csv.gz"));
  CHECK(names_in(folder / "kept") == std::set<std::string>{"axis-2020-000009.csv.gz"});
  CHECK(series->state().trouble.find("serve.kept_MB") != std::string::npos);
}
