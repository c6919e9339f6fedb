// Verb command: tells a served axis what to do, and shows how it is.
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/key_suggestion.hpp"
#include "config/units.hpp"
#include "loop/realtime_stop.hpp"
#include "program/verbs.hpp"
#include "service/command_client.hpp"
#include "service/commanded_quantity.hpp"
#include "service/sockets.hpp"

namespace pneuservo {
namespace {

using Json = nlohmann::ordered_json;

struct CommandOptions {
  std::string word, value, speed, rate, socket;
  double interval_s = 0.5;
  std::uint16_t tcp = 0;
  bool wait = false, json = false;
};

/// A word of the command line, the protocol's command and what its number is.
struct Word {
  std::string_view word, command;
  Field CommandedQuantity::* value = nullptr;
  bool is_motion = false;
  std::string_view done = "";  ///< told when it is
};
constexpr std::array command_words{
    Word{"enable", "enable", nullptr, false, "active: moves are obeyed"},
    Word{"disable", "disable", nullptr, false, "safe output: nothing moves before the next enable"},
    Word{"reset", "reset", nullptr, false, "the fault is acknowledged; enable leads on"},
    Word{"move", "move_to", &CommandedQuantity::target, true},
    Word{"move-by", "move_by", &CommandedQuantity::way, true},
    Word{"jog", "jog", &CommandedQuantity::rate, true},
    Word{"stop", "stop", nullptr, true},
    Word{"hold", "hold", nullptr, true},
    Word{"resume", "resume", nullptr, true},
    Word{"mark", "mark", nullptr, false, "marked: the recording around now is kept"},
    Word{"status", "status"},
    Word{"watch", "watch"}};

std::vector<std::string> names_of_words() {
  std::vector<std::string> names;
  for (const Word& word : command_words) names.emplace_back(word.word);
  return names;
}

/// The one axis that is served here.
std::filesystem::path only_socket() {
  const auto found = seen_sockets();
  if (found.size() == 1) return found.front();
  throw InputError(fmt::format("--socket: found {} served axes, expected one, or --socket PATH", found.size()));
}

Descriptor connect_by(const CommandOptions& options) {
  if (options.tcp != 0) return connect_to_loopback(options.tcp);
  return connect_to(options.socket.empty() ? only_socket() : std::filesystem::path(options.socket));
}

/// What is commanded there, and from where gauge pressures count.
struct Commanded {
  const CommandedQuantity& quantity;
  Datums datums;
};

Commanded commanded_at(CommandClient& client) {
  const Json status = client.ask({{"command", "status"}})["status"];
  if (!status.contains(std::string(commanded_pressure.measured))) return {commanded_position, {}};
  return {commanded_pressure, {.atmosphere_Pa = status["atmosphere_Pa"].get<double>()}};
}

/// A number in the SI unit of its key, or with a unit: 0.1, "100 mm", "3 bar gauge".
double number_of(const std::string& name, const std::string& text, const Field& field, const Datums& datums) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc() && end == text.data() + text.size() && std::isfinite(number)) return number;
  const ReadQuantity read = read_quantity(field, text, datums);
  if (read.value) return *read.value;
  throw InputError(fmt::format("{}: found '{}', expected {} or a number in {}", name, text, read.expected, field.unit));
}

Json request_of(const CommandOptions& options, const Word& word, const Commanded& commanded) {
  Json request{{"command", word.command}};
  if (word.value != nullptr) {
    const Field& field = commanded.quantity.*word.value;
    if (options.value.empty())
      throw InputError(fmt::format("{}: found nothing after it, expected a number: {}", word.word, field.key));
    request[std::string(field.key)] = number_of(options.word, options.value, field, commanded.datums);
  }
  const bool has_rate = word.value == &CommandedQuantity::target || word.value == &CommandedQuantity::way;
  for (const auto& [option, text] : {std::pair{"--speed", &options.speed}, std::pair{"--rate", &options.rate}}) {
    if (text->empty()) continue;
    if (!has_rate) throw InputError(fmt::format("{}: found with {}, expected move or move-by", option, word.word));
    if (option != commanded.quantity.rate_option)
      throw InputError(fmt::format("{}: found where {} is commanded, expected {}", option,
                                   commanded.quantity.target.key, commanded.quantity.rate_option));
    const Field& field = commanded.quantity.rate;
    request[std::string(field.key)] = number_of(option, *text, field, commanded.datums);
  }
  if (word.command == "watch") request["interval_s"] = options.interval_s;
  return request;
}

std::string shown(const Json& value, const CommandedQuantity& quantity) {
  if (!value.is_number()) return "-";
  return fmt::format("{:.3f} {}", quantity.shown * value.get<double>(), quantity.shown_unit);
}

std::string status_text(const Json& s, const CommandedQuantity& quantity) {
  const auto part = [&](std::string_view key) { return shown(s[std::string(key)], quantity); };
  std::string text =
      fmt::format("{:.3f} s  {}{}  {} {}  set point {}  target {}", s["t_s"].get<double>(),
                  s["state"].get<std::string>(), s["moving"].get<bool>() ? ", moving" : "", quantity.shown_name,
                  part(quantity.measured), part(quantity.set_point), part(quantity.answer_target));
  for (const auto& fault : s["faults"]) text += "  fault " + fault.get<std::string>();
  if (s["commander"].is_string()) text += "  commanded by " + s["commander"].get<std::string>();
  if (s["recording"]["trouble"].is_string()) text += "  recording: " + s["recording"]["trouble"].get<std::string>();
  return text;
}

void show_status(const Json& status, const CommandedQuantity& quantity, bool json) {
  std::cout << (json ? status.dump() : status_text(status, quantity)) << std::endl;
}

/// Until `done(status)` of a tick at `since_s` or later; false: a fault, or the axis is not active any more. The answer
/// to a command comes before the status of its tick.
template <class Done> bool wait_until(CommandClient& client, double since_s, const Done& done, Json& status) {
  constexpr std::chrono::milliseconds between{20};
  while (!StopRequest::requested()) {
    status = client.ask({{"command", "status"}})["status"];
    const bool is_new = status["t_s"].get<double>() >= since_s;
    if (is_new && done(status)) return true;
    if (is_new && (!status["faults"].empty() || status["state"] == "safe_stop")) return false;
    std::this_thread::sleep_for(between);
  }
  return false;
}

int watch(CommandClient& client, const CommandedQuantity& quantity, bool json) {
  while (!StopRequest::requested()) {
    const Json line = client.next();
    if (line.contains("status")) show_status(line["status"], quantity, json);
  }
  return 0;
}

int command(const CommandOptions& options) {
  const auto names = names_of_words();
  const auto place = std::ranges::find(command_words, options.word, &Word::word);
  if (place == command_words.end()) {
    const auto near = near_names(options.word, names);
    throw InputError(fmt::format("command: found {}, expected one of {}", options.word,
                                 fmt::join(near.empty() ? names : near, ", ")));
  }
  if (place->value == nullptr && !options.value.empty())
    throw InputError(fmt::format("{}: found a number, expected none after it", place->word));
  StopRequest stop;
  CommandClient client(connect_by(options));
  const Commanded commanded = commanded_at(client);
  const CommandedQuantity& quantity = commanded.quantity;
  const Json request = request_of(options, *place, commanded);
  const Json answer = client.ask(request);
  if (!answer.value("ok", false)) {
    client.ask({{"command", "release"}});
    std::cerr << fmt::format("{}: {}\n", options.word, answer.value("error", "no answer"));
    return 1;
  }
  if (place->word == "watch") return watch(client, quantity, options.json);
  if (place->word == "status") {
    show_status(answer["status"], quantity, options.json);
    return 0;
  }
  Json status;
  bool good = true;
  const double since_s = answer["t_s"].get<double>();
  if (place->word == "enable")
    good =
        wait_until(
            client, since_s, [](const Json& s) { return s["state"] == "active" || s["enabled"] == false; }, status) &&
        status["state"] == "active";
  if (options.wait && place->is_motion)
    good = wait_until(client, since_s, [](const Json& s) { return s["moving"] == false; }, status);
  client.ask({{"command", "release"}});
  if (options.json) std::cout << answer.dump() << "\n";
  else if (place->is_motion)
    std::cout << fmt::format("to {}, there at {:.3f} s (now {:.3f} s)\n",
                             shown(answer[std::string(quantity.answer_target)], quantity),
                             answer["ends_s"].get<double>(), answer["t_s"].get<double>());
  else if (good) std::cout << place->done << "\n";
  if (!good && !status.is_null()) std::cerr << options.word << ": " << status_text(status, quantity) << "\n";
  return good ? 0 : 1;
}

}  // namespace

void add_command(CommandLine& app, int& status) {
  auto o = std::make_shared<CommandOptions>();
  Verb verb = app.add_verb("command", "tells a served axis what to do, or shows how it is");
  verb.add_option("WORD", o->word,
                  "enable, disable, reset (a fault), move TARGET, move-by WAY, jog RATE, stop, hold, resume, mark, "
                  "status, watch")
      .required();
  verb.add_option("NUMBER", o->value,
                  "of move, move-by and jog: in m and m/s, of a pressure in Pa (absolute) and Pa/s, or with a unit: "
                  "'20 mm', '3 bar gauge'");
  verb.add_option("--speed", o->speed, "speed of the move [m/s] [default: reference.speed_mps]");
  verb.add_option("--rate", o->rate, "rate of a pressure [Pa/s] [default: reference.rate_Pa_per_s]");
  verb.add_flag("--wait", o->wait, "until the set point rests; whoever waits is the commander");
  verb.add_option("--socket", o->socket, "Unix socket of the axis [default: that of the only one that is served here]");
  verb.add_option("--tcp", o->tcp, "port of the axis on this machine instead").within(1, 65535);
  verb.add_option("--interval", o->interval_s, "of watch [s]").within(0.01, 3600.0);
  verb.add_flag("--json", o->json, "what the axis answered, as JSON");
  verb.footer("Without --wait the axis is released again after the answer, and goes on to its target.\n"
              "Exit status: 0 done, 1 refused or a fault, 2 unusable input or no axis there.");
  verb.callback([o, &status] { status = command(*o); });
}

}  // namespace pneuservo
