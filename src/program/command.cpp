// Verb command: tells a served axis what to do, and shows how it is.
#include <array>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/key_suggestion.hpp"
#include "loop/realtime_stop.hpp"
#include "program/verbs.hpp"
#include "service/command_client.hpp"
#include "service/sockets.hpp"

namespace pneuservo {
namespace {

using Json = nlohmann::ordered_json;

struct CommandOptions {
  std::string word, socket;
  std::optional<double> value, speed_mps;
  double interval_s = 0.5;
  std::uint16_t tcp = 0;
  bool wait = false, json = false;
};

/// A word of the command line, the protocol's command and the key of its number.
struct Word {
  std::string_view word, command, value;
  bool is_motion = false;
  std::string_view done = "";  ///< told when it is
};
constexpr std::array command_words{
    Word{"enable", "enable", "", false, "active: moves are obeyed"},
    Word{"disable", "disable", "", false, "safe output: nothing moves before the next enable"},
    Word{"reset", "reset", "", false, "the fault is acknowledged; enable leads on"},
    Word{"move", "move_to", "position_m", true},
    Word{"move-by", "move_by", "way_m", true},
    Word{"jog", "jog", "speed_mps", true},
    Word{"stop", "stop", "", true},
    Word{"hold", "hold", "", true},
    Word{"resume", "resume", "", true},
    Word{"mark", "mark", "", false, "marked: the recording around now is kept"},
    Word{"status", "status", ""},
    Word{"watch", "watch", ""}};

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

Json request_of(const CommandOptions& options, const Word& word) {
  Json request{{"command", word.command}};
  if (word.value.empty() && options.value)
    throw InputError(fmt::format("{}: found a number, expected none after it", word.word));
  if (!word.value.empty() && !options.value)
    throw InputError(fmt::format("{}: found nothing after it, expected a number: {}", word.word, word.value));
  if (!word.value.empty()) request[std::string(word.value)] = *options.value;
  if (options.speed_mps) {
    if (word.value != "position_m" && word.value != "way_m")
      throw InputError(fmt::format("--speed: found with {}, expected move or move-by", word.word));
    request["speed_mps"] = *options.speed_mps;
  }
  if (word.command == "watch") request["interval_s"] = options.interval_s;
  return request;
}

std::string status_text(const Json& s) {
  const auto mm = [&](const char* key) {
    return s[key].is_number() ? fmt::format("{:.3f} mm", 1e3 * s[key].get<double>()) : std::string("-");
  };
  std::string text = fmt::format("{:.3f} s  {}{}  x {}  set point {}  target {}", s["t_s"].get<double>(),
                                 s["state"].get<std::string>(), s["moving"].get<bool>() ? ", moving" : "", mm("x_m"),
                                 mm("x_ref_m"), mm("target_m"));
  for (const auto& fault : s["faults"]) text += "  fault " + fault.get<std::string>();
  if (s["commander"].is_string()) text += "  commanded by " + s["commander"].get<std::string>();
  if (s["recording"]["trouble"].is_string()) text += "  recording: " + s["recording"]["trouble"].get<std::string>();
  return text;
}

void show_status(const Json& status, bool json) {
  std::cout << (json ? status.dump() : status_text(status)) << std::endl;
}

/// Until `done(status)`; false: a fault, or the axis is not active any more.
template <class Done> bool wait_until(CommandClient& client, const Done& done, Json& status) {
  constexpr std::chrono::milliseconds between{20};
  while (!StopRequest::requested()) {
    status = client.ask({{"command", "status"}})["status"];
    if (done(status)) return true;
    if (!status["faults"].empty() || status["state"] == "safe_stop") return false;
    std::this_thread::sleep_for(between);
  }
  return false;
}

int watch(CommandClient& client, const CommandOptions& options) {
  while (!StopRequest::requested()) {
    const Json line = client.next();
    if (line.contains("status")) show_status(line["status"], options.json);
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
  const Json request = request_of(options, *place);
  StopRequest stop;
  CommandClient client(connect_by(options));
  const Json answer = client.ask(request);
  if (!answer.value("ok", false)) {
    client.ask({{"command", "release"}});
    std::cerr << fmt::format("{}: {}\n", options.word, answer.value("error", "no answer"));
    return 1;
  }
  if (place->word == "watch") return watch(client, options);
  if (place->word == "status") {
    show_status(answer["status"], options.json);
    return 0;
  }
  Json status;
  bool good = true;
  if (place->word == "enable")
    good = wait_until(
               client, [](const Json& s) { return s["state"] == "active" || s["enabled"] == false; }, status) &&
           status["state"] == "active";
  if (options.wait && place->is_motion)
    good = wait_until(client, [](const Json& s) { return s["moving"] == false; }, status);
  client.ask({{"command", "release"}});
  if (options.json) std::cout << answer.dump() << "\n";
  else if (place->is_motion)
    std::cout << fmt::format("to {:.3f} mm, there at {:.3f} s (now {:.3f} s)\n", 1e3 * answer["target_m"].get<double>(),
                             answer["ends_s"].get<double>(), answer["t_s"].get<double>());
  else if (good) std::cout << place->done << "\n";
  if (!good && !status.is_null()) std::cerr << options.word << ": " << status_text(status) << "\n";
  return good ? 0 : 1;
}

}  // namespace

void add_command(CommandLine& app, int& status) {
  auto o = std::make_shared<CommandOptions>();
  Verb verb = app.add_verb("command", "tells a served axis what to do, or shows how it is");
  verb.add_option("WORD", o->word,
                  "enable, disable, reset (a fault), move X_M, move-by WAY_M, jog SPEED_MPS, stop, hold, resume, mark, "
                  "status, watch")
      .required();
  verb.add_option("NUMBER", o->value, "of move, move-by and jog");
  verb.add_option("--speed", o->speed_mps, "speed of the move [m/s] [default: reference.speed_mps]");
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
