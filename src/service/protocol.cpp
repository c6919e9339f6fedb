// The language between an axis that is served and those who command it.
#include "service/protocol.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pneuservo/loop/fault.hpp>

#include "config/input_error.hpp"
#include "config/key_suggestion.hpp"

namespace pneuservo {
namespace {

using nlohmann::json;

static_assert(static_cast<std::uint32_t>(CommandKind::mark) == RecordingSeries::mark_command);

/// Of a stream: what a bus or a program can keep up, and beyond which set points are moves.
constexpr double shortest_interval_s = 1e-4, longest_interval_s = 1.0;

constexpr std::array<std::string_view, 3> other_requests{"status", "watch", "release"};

std::vector<std::string> known_requests() {
  std::vector<std::string> names(command_kind_names.begin() + 1, command_kind_names.end());
  names.insert(names.end(), other_requests.begin(), other_requests.end());
  return names;
}

/// Keys that a request may have beside version, id and command.
std::vector<std::string_view> keys_of(std::string_view command) {
  if (command == "move_to") return {"position_m", "speed_mps"};
  if (command == "move_by") return {"way_m", "speed_mps"};
  if (command == "jog") return {"speed_mps"};
  if (command == "watch") return {"interval_s"};
  if (command == "follow") return {"position_m", "interval_s"};
  return {};
}

json parsed(std::string_view line) {
  if (line.size() > longest_line)
    throw InputError(fmt::format("found a line of more than {} bytes, expected a request", longest_line));
  json request = json::parse(line, nullptr, false);
  if (!request.is_object())
    throw InputError(R"(found a line that is no JSON object, expected {"version":1,"command":"status"})");
  return request;
}

void check_head(const json& request) {
  const auto version = request.find("version");
  if (version == request.end() || !version->is_number_integer() || *version != protocol_version)
    throw InputError(fmt::format("version: found {}, expected {}",
                                 version == request.end() ? "nothing" : version->dump(), protocol_version));
  const auto command = request.find("command");
  if (command == request.end() || !command->is_string())
    throw InputError(fmt::format("command: found {}, expected one of {}",
                                 command == request.end() ? "nothing" : command->dump(),
                                 fmt::join(known_requests(), ", ")));
}

void check_keys(const json& request, std::string_view command) {
  const auto allowed = keys_of(command);
  for (const auto& [key, value] : request.items()) {
    if (key == "version" || key == "id" || key == "command") continue;
    if (std::ranges::find(allowed, key) != allowed.end()) continue;
    throw InputError(fmt::format("{}: found an unknown key of {}, expected {}", key, command,
                                 allowed.empty() ? "none" : fmt::format("{}", fmt::join(allowed, ", "))));
  }
}

/// NaN is no JSON number.
json number_or_null(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

}  // namespace

RequestReader::RequestReader(const Rig& rig)
    : lowest_m_(rig.reference.lowest_m), highest_m_(rig.reference.highest_m), speed_mps_(rig.reference.speed_mps) {}

double RequestReader::number(const json& line, const char* key, double lowest, double highest,
                             std::optional<double> usual) const {
  const auto found = line.find(key);
  if (found == line.end() && usual) return *usual;
  const std::string text = found == line.end() ? "nothing" : found->dump();
  const double value = found != line.end() && found->is_number() ? found->get<double>() : std::nan("");
  if (value >= lowest && value <= highest) return value;
  throw InputError(fmt::format("{}: found {}, expected {:g} to {:g}", key, text.substr(0, 40), lowest, highest));
}

AxisCommand RequestReader::motion(const json& line, CommandKind kind) const {
  AxisCommand command{kind};
  const double slowest_mps = 1e-3 * speed_mps_, range_m = highest_m_ - lowest_m_;
  if (kind == CommandKind::move_to || kind == CommandKind::follow)
    command.position_m = number(line, "position_m", lowest_m_, highest_m_);
  if (kind == CommandKind::move_by) command.position_m = number(line, "way_m", -range_m, range_m);
  if (kind == CommandKind::move_to || kind == CommandKind::move_by)
    command.speed_mps = number(line, "speed_mps", slowest_mps, speed_mps_, speed_mps_);
  if (kind == CommandKind::follow)
    command.interval_s = number(line, "interval_s", shortest_interval_s, longest_interval_s);
  if (kind != CommandKind::jog) return command;
  command.speed_mps = number(line, "speed_mps", -speed_mps_, speed_mps_);
  if (std::fabs(command.speed_mps) < slowest_mps)
    throw InputError(
        fmt::format("speed_mps: found {:g}, expected at least {:g} either way", command.speed_mps, slowest_mps));
  return command;
}

Request RequestReader::read(std::string_view line, json& id) const {
  const json request = parsed(line);
  if (const auto found = request.find("id"); found != request.end()) {
    if (!found->is_number() && !found->is_string())
      throw InputError("id: found " + found->dump().substr(0, 40) + ", expected a number or text");
    id = *found;
  }
  check_head(request);
  const auto name = request["command"].get<std::string>();
  check_keys(request, name);
  Request out;
  out.id = id;
  const auto command = std::ranges::find(command_kind_names, name);
  if (command != command_kind_names.end() && command != command_kind_names.begin()) {
    out.command = motion(request, static_cast<CommandKind>(command - command_kind_names.begin()));
  } else if (name == "status") out.kind = RequestKind::status;
  else if (name == "release") out.kind = RequestKind::release;
  else if (name == "watch") {
    out.kind = RequestKind::watch;
    out.interval_s = number(request, "interval_s", 0.01, 3600.0, out.interval_s);
  } else {
    const auto near = near_names(name, known_requests());
    throw InputError(fmt::format("command: found {}, expected {}", request["command"].dump().substr(0, 40),
                                 near.empty() ? fmt::format("one of {}", fmt::join(known_requests(), ", "))
                                              : fmt::format("a known one (did you mean {}?)", fmt::join(near, ", "))));
  }
  return out;
}

/// A time without the last digits of its sum: 12.78 instead of 12.780000000000001.
static double whole_nanoseconds(double time_s) { return std::round(time_s * 1e9) / 1e9; }

std::string answer_line(const json& id, const AxisAnswer& answer, std::int64_t waited, double period_s) {
  if (answer.result != CommandResult::taken) return error_line(id, text_of(answer.result));
  nlohmann::ordered_json line{{"version", protocol_version}};
  if (!id.is_null()) line["id"] = id;
  line["ok"] = true;
  line["tick"] = answer.tick;
  line["waited_ticks"] = waited;
  line["t_s"] = whole_nanoseconds(static_cast<double>(answer.tick) * period_s);
  line["target_m"] = answer.target_m;
  line["ends_s"] = whole_nanoseconds(static_cast<double>(answer.end_tick) * period_s);
  return line.dump();
}

std::string error_line(const json& id, std::string_view sentence) {
  nlohmann::ordered_json line{{"version", protocol_version}};
  if (!id.is_null()) line["id"] = id;
  line["ok"] = false;
  line["error"] = sentence;
  return line.dump(-1, ' ', true, json::error_handler_t::replace);
}

nlohmann::ordered_json status_json(const AxisStatus& s, double period_s, std::string_view commander,
                                   const SeriesState& recording) {
  nlohmann::ordered_json faults = json::array();
  for (const FaultText& text : fault_texts)
    if ((s.faults & text.bit) != 0) faults.push_back(text.name);
  const bool active = s.state == SupervisorState::active;
  nlohmann::ordered_json status = {
      {"t_s", whole_nanoseconds(s.t_s)},
      {"state", supervisor_state_names[static_cast<std::size_t>(s.state)]},
      {"enabled", s.enabled},
      {"start_proven", active && s.proven},
      {"moving", active && s.tick < s.end_tick},
      {"x_ref_m", number_or_null(active ? s.x_ref_m : std::nan(""))},
      {"v_ref_mps", number_or_null(active ? s.v_ref_mps : std::nan(""))},
      {"target_m", number_or_null(active ? s.target_m : std::nan(""))},
      {"ends_s", number_or_null(active ? whole_nanoseconds(static_cast<double>(s.end_tick) * period_s) : std::nan(""))},
      {"late", s.is_late},
      {"u_V", number_or_null(s.u_V)},
      {"faults", faults},
      {"commander", commander.empty() ? json(nullptr) : json(commander)},
      {"recording",
       {{"parts", recording.parts},
        {"kept", recording.kept},
        {"kept_MB", recording.kept_MB},
        {"deleted", recording.deleted},
        {"trouble", recording.trouble.empty() ? json(nullptr) : json(recording.trouble)}}}};
  for (const Signal signal : channel_signals)
    status[std::string(info(signal).column)] = number_or_null(s.measured[signal]);
  return status;
}

}  // namespace pneuservo
