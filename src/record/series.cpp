// A recording without end as a series of files: their names, when the next begins, which are kept and which go.
#include "record/series.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "config/input_error.hpp"

namespace pneuservo {

namespace fs = std::filesystem;

namespace {

constexpr double bytes_per_MB = 1e6;
constexpr std::int64_t rows_between_looks = 4096;
/// A part that alone takes this share of the budget ends early, so that deleting whole parts can hold it.
constexpr double largest_part_share = 0.25;

void create(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw InputError(fmt::format("{}: found no way to create this folder ({}), expected one that can be written",
                                 folder.string(), error.message()));
}

}  // namespace

std::string utc_stamp() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &utc);
  return text.data();
}

RecordingSeries::RecordingSeries(SeriesSettings settings) : settings_(std::move(settings)) {
  create(settings_.folder);
  create(settings_.folder / "kept");
  for (const fs::path& folder : {settings_.folder, settings_.folder / "kept"})
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().filename().string().starts_with(settings_.stem + "-"))
        throw InputError(fmt::format("{}: found a recording of the same start, expected none: the clock stands still",
                                     entry.path().string()));
  for (const auto& entry : fs::directory_iterator(settings_.folder / "kept")) state_.kept_MB += size_MB(entry.path());
}

double RecordingSeries::size_MB(const fs::path& path) const noexcept {
  std::error_code error;
  const auto size = fs::file_size(path, error);
  return error ? 0.0 : static_cast<double>(size) / bytes_per_MB;
}

std::string RecordingSeries::begin_part() {
  make_room();
  while (parts_.size() > 1 && parts_.front().end_s < parts_.back().end_s - settings_.around_s) parts_.pop_front();
  std::int64_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    number = ++state_.parts;
  }
  parts_.push_back({settings_.folder / fmt::format("{}-{:06}.csv.gz", settings_.stem, number)});
  begins_ = true;
  rows_ = 0;
  return parts_.back().path.string();
}

bool RecordingSeries::after(const Row& row) noexcept try {
  Part& now = parts_.back();
  if (begins_) now.begin_s = row.t_s;
  const bool fault = (row.flags & row_fault) != 0;
  const bool event = (fault && !in_fault_) || row.command_kind == mark_command;
  in_fault_ = fault;
  now.end_s = row.t_s;
  if (event) {
    keep_until_s_ = row.t_s + settings_.around_s;
    for (Part& part : parts_)
      if (part.end_s >= row.t_s - settings_.around_s) keep(part);
  } else if (begins_ && now.begin_s <= keep_until_s_) keep(now);
  begins_ = false;
  ++rows_;
  if (row.t_s - now.begin_s >= settings_.part_s) return true;
  return rows_ % rows_between_looks == 0 && size_MB(now.path) > largest_part_share * settings_.budget_MB;
} catch (const std::exception& error) {  // no memory for a path: the rows go on
  return false;
}

// At once, so that a crash of the program leaves it there.
void RecordingSeries::keep(Part& part) {
  if (part.is_kept) return;
  const double size = size_MB(part.path);
  {
    const std::lock_guard lock(mutex_);
    if (state_.kept_MB + size > settings_.kept_MB) {
      state_.trouble =
          fmt::format("{}: found {:.4g} MB of kept recordings, expected at most serve.kept_MB ({:g}): move "
                      "them away, nothing more is kept until then",
                      (settings_.folder / "kept").string(), state_.kept_MB, settings_.kept_MB);
      return;
    }
  }
  const fs::path to = settings_.folder / "kept" / part.path.filename();
  std::error_code error;
  fs::create_hard_link(part.path, to, error);  // refuses to replace, as a rename would not
  if (!error) fs::remove(part.path, error);
  if (error)
    return note_trouble(
        fmt::format("{}: cannot be moved to the folder kept ({})", part.path.string(), error.message()));
  part.path = to;
  part.is_kept = true;
  const std::lock_guard lock(mutex_);
  state_.kept_MB += size;
  ++state_.kept;
}

void RecordingSeries::make_room() {
  struct Found {
    fs::path path;
    double MB;
  };
  std::vector<Found> files;
  double all_MB = 0.0, kept_MB = 0.0;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(settings_.folder / "kept", error)) kept_MB += size_MB(entry.path());
  for (const auto& entry : fs::directory_iterator(settings_.folder, error)) {
    if (!entry.path().filename().string().ends_with(".csv.gz")) continue;
    files.push_back({entry.path(), size_MB(entry.path())});
    all_MB += files.back().MB;
  }
  // Names begin with the axis and the time: their order is that of their age.
  std::ranges::sort(files, {}, &Found::path);
  std::int64_t deleted = 0;
  const double most_MB = (1.0 - largest_part_share) * settings_.budget_MB;  // the next part has its place
  for (const Found& file : files) {
    if (all_MB <= most_MB) break;
    const bool is_near = std::ranges::any_of(parts_, [&](const Part& part) {
      return part.path == file.path && part.end_s >= parts_.back().end_s - settings_.around_s;
    });
    if (is_near || !fs::remove(file.path, error)) continue;
    all_MB -= file.MB;
    ++deleted;
  }
  const std::lock_guard lock(mutex_);
  state_.deleted += deleted;
  state_.kept_MB = kept_MB;
}

void RecordingSeries::note_trouble(const std::string& sentence) {
  const std::lock_guard lock(mutex_);
  state_.trouble = sentence;
}

SeriesState RecordingSeries::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

}  // namespace pneuservo
