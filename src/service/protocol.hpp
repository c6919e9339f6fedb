// The language between an axis that is served and those who command it: JSON, a line each way (docs/serve.md).
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include <pneuservo/loop/axis_command.hpp>
#include <pneuservo/rig/rig.hpp>

#include "record/series.hpp"
#include "service/commanded_quantity.hpp"

namespace pneuservo {

inline constexpr int protocol_version = 1;
/// A longer line is no request.
inline constexpr std::size_t longest_line = 4096;

/// What a client may ask for beside commands of the axis.
enum class RequestKind { command, status, watch, release };

struct Request {
  nlohmann::json id;  ///< comes back in the answer; null: none
  RequestKind kind = RequestKind::command;
  AxisCommand command;
  double interval_s = 0.1;  ///< of watch
};

/// Moves anything, or keeps it from moving: what only the commander may. `stop` and `disable` everybody may, and
/// `mark`.
constexpr bool needs_command(CommandKind kind) noexcept {
  return kind != CommandKind::stop && kind != CommandKind::disable && kind != CommandKind::mark;
}

/// Reads requests of one rig: keys, units and its limits.
class RequestReader {
 public:
  explicit RequestReader(const CommandedRig& rig) : rig_(rig) {}
  /// Throws InputError with one sentence; `id` has what the line had, as far as it could be read.
  Request read(std::string_view line, nlohmann::json& id) const;

 private:
  double number(const nlohmann::json& line, std::string_view key, double lowest, double highest,
                std::optional<double> usual = {}) const;
  AxisCommand motion(const nlohmann::json& line, CommandKind kind) const;

  void check_keys(const nlohmann::json& request, std::string_view command) const;

  const CommandedRig& rig_;
};

/// One line without its end. `waited`: ticks from the last one that was over when the command came.
std::string answer_line(const CommandedRig& rig, const nlohmann::json& id, const AxisAnswer& answer,
                        std::int64_t waited);
std::string error_line(const nlohmann::json& id, std::string_view sentence);
nlohmann::ordered_json status_json(const CommandedRig& rig, const AxisStatus& status, std::string_view commander,
                                   const SeriesState& recording);

}  // namespace pneuservo
