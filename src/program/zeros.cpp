// Zeros of channels from files.
#include "program/zeros.hpp"

#include <cmath>
#include <cstdint>
#include <sstream>

#include <fmt/format.h>

#include <pneuservo/core/field.hpp>

#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/number_text.hpp"
#include "config/read_rig.hpp"
#include "config/section_reader.hpp"
#include "program/output_files.hpp"
#include "record/result_file.hpp"

namespace pneuservo {
namespace {

struct ZeroFile {
  std::string rig, machine;
  std::map<std::string, double> zeros;
  std::optional<CommissionSection> commission;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"rig", "", 0, 0, "name of the rig that they were found on"}, p.rig...);
    v(Field{"machine", "", 0, 0, "its cylinder, encoder and channels in short"}, p.machine...);
    v(Field{"zeros", "", -1e7, 1e7, "by channel"}, p.zeros...);
    v(Field{"commission", "", 0, 0, "what the verb commission found", Presence::optional}, p.commission...);
  }
};

/// FNV-1a: short, the same on every machine; it guards against a mistake, not against an attacker.
std::uint64_t digest(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

void require_same_rig(const std::string& file, const ZeroFile& read, const std::string& config, const Rig& rig) {
  const std::string machine = machine_of(rig);
  if (read.rig == rig.name && read.machine == machine) return;
  const bool renamed = read.rig != rig.name;
  throw InputError(fmt::format("{}: {}: found {}, expected {} of {}: zeros hold for the machine that they were found "
                               "on, so find them again with this config (pneuservo zero, home)",
                               file, renamed ? "rig" : "machine", renamed ? read.rig : read.machine,
                               renamed ? rig.name : machine, config));
}

void add_commission(const std::string& file, const CommissionSection& found, const Rig& rig,
                    std::vector<std::string>& sets) {
  if (!found.passed)
    throw InputError(file +
                     ": commission.passed: found false, expected true: mend what pneuservo commission called wrong, "
                     "and commission again");
  const bool differs = std::fabs(found.neutral_V - rig.safe_output.command_V) > found.neutral_error_V;
  if (found.neutral_error_V > 0.0 && differs && rig.safe_output.action == SafeAction::hold)
    sets.push_back("safe_output.command_V=" + number_text(found.neutral_V));
}

}  // namespace

std::string machine_of(const Rig& rig) {
  Rig machine;
  machine.name = "machine";
  machine.kind = rig.kind;
  machine.axis.cylinder = rig.axis.cylinder;
  machine.sensors.position = rig.sensors.position;
  machine.hal = rig.hal;
  if (machine.hal && machine.hal->can) machine.hal->can->interface.clear();
  return fmt::format("{:016x}", digest(dump_rig(machine)));
}

std::vector<std::string> with_zeros(const std::string& config, std::vector<std::string> sets,
                                    const std::vector<std::string>& files) {
  if (files.empty()) return sets;
  const Rig rig = read_rig(config, sets);
  for (const std::string& file : files) {
    ZeroFile read;
    read_document(read_config_tree(file, "a file that home, zero or commission wrote"), read);
    require_same_rig(file, read, config, rig);
    for (const auto& [channel, zero] : read.zeros) sets.push_back("zeros." + channel + "=" + number_text(zero));
    if (read.commission) add_commission(file, *read.commission, rig, sets);
  }
  return sets;
}

void write_zeros(const std::string& file, const Rig& rig, const std::map<std::string, double>& zeros,
                 const std::string& comment, const std::optional<CommissionSection>& commission) {
  std::ostringstream out;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) out << "# " << line << "\n";
  out << "rig: " << rig.name << "\nmachine: '" << machine_of(rig) << "'\nzeros:" << (zeros.empty() ? " {}" : "")
      << "\n";
  for (const auto& [channel, zero] : zeros) out << "  " << channel << ": " << number_text(zero) << "\n";
  if (commission)
    out << "commission:\n  passed: " << (commission->passed ? "true" : "false")
        << "\n  neutral_V: " << number_text(commission->neutral_V)
        << "\n  neutral_error_V: " << number_text(commission->neutral_error_V) << "\n";
  write_result(file, out.str());
}

}  // namespace pneuservo
