// The files that a verb reads and writes.
#include "program/output_files.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "pass/learned_move.hpp"

namespace pneuservo {
namespace {

namespace fs = std::filesystem;

bool is_file(const std::string& path) { return !path.empty() && path != "-"; }

bool holds_data(const std::string& path) {
  struct stat found{};
  return stat(path.c_str(), &found) == 0 && S_ISREG(found.st_mode);
}

/// One file under two names: by its inode where it is there, by its place where it is not yet. A device is no file.
bool same_file(const std::string& a, const std::string& b) {
  struct stat of_a{}, of_b{};
  const bool is_a = stat(a.c_str(), &of_a) == 0, is_b = stat(b.c_str(), &of_b) == 0;
  if (is_a && is_b) return !S_ISCHR(of_a.st_mode) && of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
  std::error_code ignored;
  return is_a == is_b && fs::weakly_canonical(a, ignored) == fs::weakly_canonical(b, ignored);
}

void require_writable(const std::string& option, const std::string& path) {
  struct stat found{};
  const bool was_there = stat(path.c_str(), &found) == 0;
  // Opening and closing a pipe would end it for its reader.
  const bool only_look = was_there && !S_ISREG(found.st_mode) && !S_ISDIR(found.st_mode);
  // O_EXCL: what another program creates in between is not ours to take away again.
  const int create = was_there ? 0 : O_CREAT | O_EXCL;
  const int file = only_look ? access(path.c_str(), W_OK) : open(path.c_str(), O_WRONLY | O_CLOEXEC | create, 0666);
  if (file < 0)
    throw InputError(fmt::format("{}: {} cannot be written: {}; expected a file in a folder that is there", option,
                                 path, std::strerror(errno)));
  if (only_look) return;
  close(file);
  if (!was_there) unlink(path.c_str());
}

std::string_view name_of(ResultKind kind) {
  switch (kind) {
    case ResultKind::json: return "JSON result";
    case ResultKind::page: return "HTML page";
    case ResultKind::config: return "config that this program wrote";
    case ResultKind::import_section: return "result of import";
    case ResultKind::zeros: return "file of zeros";
    case ResultKind::eds: return "EDS file";
    case ResultKind::picture: return "picture of an unknown";
    case ResultKind::pass: return "command pass";
    case ResultKind::learned_move: return "learned move";
    case ResultKind::fmu: return "FMU that this program wrote";
    case ResultKind::commission: break;
  }
  return "commissioning";
}

/// The comment lines before its first key; of anything else its first line.
std::string head_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string head, line;
  while (head.size() < 65536 && std::getline(file, line)) {
    head += line.substr(0, 4096) + "\n";
    if (!line.starts_with('#')) break;
  }
  return head;
}

/// The first entry of an FMU's archive, not compressed, which python/pneuservo/fmu.py writes: 30 bytes, then its name.
bool begins_as_fmu(const std::string& path) {
  constexpr std::string_view archive = "PK\x03\x04", entry = "resources/fmu.json{\"pneuservo\":";
  std::string head(30 + entry.size(), '\0');
  std::ifstream(path, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.starts_with(archive) && head.ends_with(entry);
}

/// By what this program writes at its beginning. A config that a person wrote is none.
bool is_older_result(const std::string& path, ResultKind kind) {
  const std::string head = head_of(path);
  if (head.empty()) return true;
  switch (kind) {
    case ResultKind::json: return head.starts_with('{');
    case ResultKind::page: return head.starts_with("<!DOCTYPE html>");
    case ResultKind::config: return head.find(dumped_rig_mark) != std::string::npos;
    case ResultKind::import_section: return head.starts_with(import_mark);
    case ResultKind::zeros: return head.starts_with("# Zeros of ");
    case ResultKind::eds: return head.starts_with("[FileInfo]");
    case ResultKind::picture: return head.starts_with("# Missing: ");
    case ResultKind::pass: return head.starts_with("# Command pass ");
    case ResultKind::learned_move: return head.starts_with(learned_move_mark);
    case ResultKind::fmu: return begins_as_fmu(path);
    case ResultKind::commission: break;
  }
  return head.starts_with("# Commissioning of ");
}

void add_paths(const ReferenceSpec& reference, std::vector<std::string>& paths) {
  if (reference.kind == ReferenceKind::file) paths.push_back(reference.path);
  for (const ReferenceSpec& part : reference.parts) add_paths(part, paths);
}

}  // namespace

OutputFiles& OutputFiles::reads(const std::string& option, const std::string& path) {
  if (is_file(path)) inputs_.push_back({option, path});
  return *this;
}

OutputFiles& OutputFiles::reads(const std::string& option, const std::vector<std::string>& paths) {
  for (const std::string& path : paths) reads(option, path);
  return *this;
}

OutputFiles& OutputFiles::reads_of(const Rig& rig) {
  std::vector<std::string> references;
  add_paths(rig.reference, references);
  reads("reference.path", references);
  if (rig.hal && rig.hal->can)
    for (const auto& [name, node] : rig.hal->can->nodes) reads("hal.can.nodes." + name + ".eds", node.eds);
  return *this;
}

bool OutputFiles::add_output(const std::string& option, const std::string& path) {
  if (!is_file(path)) return false;
  const auto refuse = [&](const Named& other, const char* use) {
    throw InputError(fmt::format("{}: found {}, which {} {} ({}), expected another file", option, path, other.option,
                                 use, other.path));
  };
  for (const Named& input : inputs_)
    if (same_file(input.path, path)) refuse(input, "reads");
  for (const Named& output : outputs_)
    if (same_file(output.path, path)) refuse(output, "writes");
  outputs_.push_back({option, path});
  return true;
}

OutputFiles& OutputFiles::writes(const std::string& option, const std::string& path, ResultKind kind,
                                 ExistingFile existing) {
  if (!add_output(option, path)) return *this;
  if (holds_data(path) && !is_older_result(path, kind))
    throw InputError(fmt::format("{}: found {}, which holds something else, expected a new name or an older {}", option,
                                 path, name_of(kind)));
  if (existing == ExistingFile::refuse && holds_data(path) && !head_of(path).empty())
    throw InputError(fmt::format("{}: found {}, an older {}, expected a new name, or --force to replace it", option,
                                 path, name_of(kind)));
  require_writable(option, path);
  return *this;
}

OutputFiles& OutputFiles::records(const std::string& option, const std::string& path, ExistingFile existing) {
  if (!add_output(option, path)) return *this;
  if (existing == ExistingFile::refuse && holds_data(path))
    throw InputError(fmt::format("{}: {}: {}", option, path, existing_recording_words));
  require_writable(option, path);
  return *this;
}

}  // namespace pneuservo
