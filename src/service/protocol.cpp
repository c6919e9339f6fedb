// The language between an axis that is served and those who command it.
#include "service/protocol.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
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
std::vector<std::string_view> keys_of(const CommandedQuantity& quantity, std::string_view command) {
  if (command == "move_to") return {quantity.target.key, quantity.rate.key};
  if (command == "move_by") return {quantity.way.key, quantity.rate.key};
  if (command == "jog") return {quantity.rate.key};
  if (command == "watch") return {"interval_s"};
  if (command == "follow") return {quantity.target.key, "interval_s"};
  return {};
}

json parsed(std::string_view line) {
  if (line.size() > longest_line)
    throw InputError(fmt::format("found a line of more than {} bytes, expected a request", longest_line));
  std::set<std::string> keys;
  std::optional<std::string> twice;
  const auto note = [&](int depth, json::parse_event_t event, const json& key) {
    if (depth == 1 && event == json::parse_event_t::key && !keys.insert(key.get<std::string>()).second)
      twice = key.get<std::string>();
    return true;
  };
  json request = json::parse(line, note, false);
  if (!request.is_object())
    throw InputError(R"(found a line that is no JSON object, expected {"version":1,"command":"status"})");
  if (twice) throw InputError(fmt::format("{}: found twice, expected each key once", *twice));
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

/// NaN is no JSON number.
json number_or_null(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

}  // namespace

void RequestReader::check_keys(const json& request, std::string_view command) const {
  const auto allowed = keys_of(rig_.quantity, command);
  for (const auto& [key, value] : request.items()) {
    if (key == "version" || key == "id" || key == "command") continue;
    if (std::ranges::find(allowed, key) != allowed.end()) continue;
    throw InputError(fmt::format("{}: found an unknown key of {}, expected {}", key, command,
                                 allowed.empty() ? "none" : fmt::format("{}", fmt::join(allowed, ", "))));
  }
}

double RequestReader::number(const json& line, std::string_view key, double lowest, double highest,
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
  const CommandedQuantity& quantity = rig_.quantity;
  const double lowest = rig_.limits.lowest_m, highest = rig_.limits.highest_m, range = highest - lowest;
  const double fastest = rig_.limits.speed_mps, slowest = 1e-3 * fastest;
  if (kind == CommandKind::move_to || kind == CommandKind::follow)
    command.target = number(line, quantity.target.key, lowest, highest);
  if (kind == CommandKind::move_by) command.target = number(line, quantity.way.key, -range, range);
  if (kind == CommandKind::move_to || kind == CommandKind::move_by)
    command.rate = number(line, quantity.rate.key, slowest, fastest, fastest);
  if (kind == CommandKind::follow)
    command.interval_s = number(line, "interval_s", shortest_interval_s, longest_interval_s);
  if (kind != CommandKind::jog) return command;
  command.rate = number(line, quantity.rate.key, -fastest, fastest);
  if (std::fabs(command.rate) < slowest)
    throw InputError(
        fmt::format("{}: found {:g}, expected at least {:g} either way", quantity.rate.key, command.rate, slowest));
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

std::string answer_line(const CommandedRig& rig, const json& id, const AxisAnswer& answer, std::int64_t waited) {
  if (answer.result != CommandResult::taken) return error_line(id, text_of(answer.result));
  nlohmann::ordered_json line{{"version", protocol_version}};
  if (!id.is_null()) line["id"] = id;
  line["ok"] = true;
  line["tick"] = answer.tick;
  line["waited_ticks"] = waited;
  line["t_s"] = whole_nanoseconds(static_cast<double>(answer.tick) * rig.period_s);
  line[std::string(rig.quantity.answer_target)] = answer.target;
  line["ends_s"] = whole_nanoseconds(static_cast<double>(answer.end_tick) * rig.period_s);
  return line.dump();
}

std::string error_line(const json& id, std::string_view sentence) {
  nlohmann::ordered_json line{{"version", protocol_version}};
  if (!id.is_null()) line["id"] = id;
  line["ok"] = false;
  line["error"] = sentence;
  return line.dump(-1, ' ', true, json::error_handler_t::replace);
}

nlohmann::ordered_json status_json(const CommandedRig& rig, const AxisStatus& s, std::string_view commander,
                                   const SeriesState& recording) {
  nlohmann::ordered_json faults = json::array();
  for (const FaultText& text : fault_texts)
    if ((s.faults & text.bit) != 0) faults.push_back(text.name);
  const bool active = s.state == SupervisorState::active;
  const auto commanded = [active](double value) { return number_or_null(active ? value : std::nan("")); };
  const auto key = [](std::string_view name) { return std::string(name); };
  nlohmann::ordered_json status = {
      {"t_s", whole_nanoseconds(s.t_s)},
      {"state", supervisor_state_names[static_cast<std::size_t>(s.state)]},
      {"enabled", s.enabled},
      {"start_proven", active && s.proven},
      {"moving", active && s.tick < s.end_tick},
      {key(rig.quantity.set_point), commanded(s.set_point)},
      {key(rig.quantity.set_point_rate), commanded(s.set_point_rate)},
      {key(rig.quantity.answer_target), commanded(s.target)},
      {"ends_s", commanded(whole_nanoseconds(static_cast<double>(s.end_tick) * rig.period_s))},
      {"follows_pass", active && s.follows_pass},
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
    if (rig.has_sensor[signal]) status[key(info(signal).column)] = number_or_null(s.measured[signal]);
  if (!rig.is_pressure()) return status;
  status[key(rig.quantity.measured)] = number_or_null(s.p_Pa);
  status["atmosphere_Pa"] = rig.atmosphere_Pa;
  return status;
}

}  // namespace pneuservo
