// A recording without end as a series of files: their names, when the next begins, which are kept and which go.
#pragma once
#include <cstdint>
#include <deque>
#include <filesystem>
#include <limits>
#include <mutex>
#include <string>

#include <pneuservo/record/row.hpp>

namespace pneuservo {

struct SeriesSettings {
  std::filesystem::path folder;
  std::string stem;          ///< of the names, with the time of the start: STEM-000001.csv.gz
  double part_s = 60.0;
  double budget_MB = 1000.0; ///< of the files that may go
  double kept_MB = 1000.0;   ///< of those in the folder `kept`, which never go
  double around_s = 10.0;    ///< before and after each event
};

/// What is to be told of a series.
struct SeriesState {
  std::int64_t parts = 0, kept = 0, deleted = 0;
  double kept_MB = 0.0;
  std::string trouble;  ///< the last, empty: none
};

/// Events are faults that begin, and the command `mark`. The files that hold the time around one are moved to the
/// folder `kept` at once, as long as its size allows. Others go, the oldest first, where all of the folder's, also of
/// earlier starts, are larger than the budget. No file is ever written over. Of the thread that writes but for state().
class RecordingSeries {
 public:
  /// Value of the column `command_kind` that is a mark; it stands in recordings and does not change.
  static constexpr std::uint32_t mark_command = 10;

  /// Creates both folders. Throws InputError where that cannot be, or a file of this start is there already.
  explicit RecordingSeries(SeriesSettings settings);

  /// Where the next file goes; the one before it is closed.
  std::string begin_part();
  /// After each row; true: time for the next file.
  bool after(const Row& row) noexcept;
  /// Something that could not be done, for state().
  void note_trouble(const std::string& sentence);
  /// From any thread.
  SeriesState state() const;

 private:
  struct Part {
    std::filesystem::path path;
    double begin_s = 0.0, end_s = 0.0;
    bool is_kept = false;
  };
  void keep(Part& part);
  void make_room();
  double size_MB(const std::filesystem::path& path) const noexcept;

  SeriesSettings settings_;
  std::deque<Part> parts_;  // the present one last; those before it as far as an event may reach
  bool begins_ = true, in_fault_ = false;
  std::int64_t rows_ = 0;
  double keep_until_s_ = -std::numeric_limits<double>::infinity();
  mutable std::mutex mutex_;  // guards state_
  SeriesState state_;
};

/// UTC as 20260131T235959Z.
std::string utc_stamp();

}  // namespace pneuservo
