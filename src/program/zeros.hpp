// Zeros of channels from files that home, zero and commission wrote, as overrides of the config's section zeros.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <pneuservo/core/field.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Which machine a rig is: its cylinder, encoder and channels with their objects and scales; sixteen hexadecimal
/// digits. Gains, references, limits and the name of the bus interface do not change it.
std::string machine_of(const Rig& rig);

/// What the verb commission found, in a file for run --zeros.
struct CommissionSection {
  bool passed = false;
  double neutral_V = 0.0, neutral_error_V = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"passed", "", 0, 0, "no check was wrong"}, p.passed...);
    v(Field{"neutral_V", "V", -1000, 1000, "command at which the valve is closed", Presence::optional}, p.neutral_V...);
    v(Field{"neutral_error_V", "V", 0, 1000, "what is not known of it; 0: not found", Presence::optional},
      p.neutral_error_V...);
  }
};

/// `sets` and after them one zeros.CHANNEL=VALUE for each zero of the files. Throws InputError naming file and line,
/// and where a file was found on another rig than that of `config` with `sets`, or its commissioning failed. A closing
/// command that differs by more than its error becomes safe_output.command_V of `hold`.
std::vector<std::string> with_zeros(const std::string& config, std::vector<std::string> sets,
                                    const std::vector<std::string>& files);

/// Writes a file for with_zeros, `comment` one or more lines without their mark. Throws InputError.
void write_zeros(const std::string& file, const Rig& rig, const std::map<std::string, double>& zeros,
                 const std::string& comment, const std::optional<CommissionSection>& commission = {});

}  // namespace pneuservo
