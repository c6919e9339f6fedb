// The files that a verb reads and writes, judged before the work: no result is lost, and no file either.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "record/gzip_file.hpp"

namespace pneuservo {

/// What an older result looks like that a new one may replace.
enum class ResultKind { json, page, config, import_section, zeros, picture, commission, eds, pass, fmu, learned_move };

/// First line of what the verb import writes.
inline constexpr std::string_view import_mark = "# Columns of a recording as pneuservo import understood them.";

/// Name what is read first, then what is written. Each call throws InputError with one sentence: a file that cannot be
/// written, that is read or written by another option (the same file under any name), or that holds something else than
/// an older result of its kind. Empty paths and "-" are no files; pipes and devices hold nothing that could be lost.
class OutputFiles {
 public:
  OutputFiles& reads(const std::string& option, const std::string& path);
  OutputFiles& reads(const std::string& option, const std::vector<std::string>& paths);
  /// The files that a config names: a reference, the EDS files of the nodes.
  OutputFiles& reads_of(const Rig& rig);
  /// A result that can be made again: it may replace an older one. One that a person may have worked on, or that took a
  /// moving machine: only where that is said.
  OutputFiles& writes(const std::string& option, const std::string& path, ResultKind kind,
                      ExistingFile existing = ExistingFile::replace);
  /// A recording cannot be made again: a file that is there is refused unless it may be replaced.
  OutputFiles& records(const std::string& option, const std::string& path, ExistingFile existing);

 private:
  struct Named {
    std::string option, path;
  };
  /// False: no file, nothing to judge.
  bool add_output(const std::string& option, const std::string& path);

  std::vector<Named> inputs_, outputs_;
};

}  // namespace pneuservo
