// Takes commands of an axis over sockets and passes them to its loop; says what came of them and how the axis is.
#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
#include <map>
#include <string>
#include <thread>

#include <nlohmann/json.hpp>

#include <pneuservo/loop/axis_command.hpp>
#include <pneuservo/rig/rig.hpp>

#include "record/series.hpp"
#include "service/descriptor.hpp"
#include "service/local_commander.hpp"
#include "service/protocol.hpp"
#include "service/service_notice.hpp"

namespace pneuservo {

/// One thread of ordinary priority for all connections and for a commander in this program. The first that commands is
/// the commander until it releases or ends; the others may look, stop, disable and mark.
class CommandServer {
 public:
  static constexpr std::size_t most_clients = 16;
  /// What a client may leave unread before it is let go.
  static constexpr std::size_t most_unread = 1 << 16;

  /// Opens the sockets; throws InputError where they cannot be opened or another axis answers there. `rig` has the
  /// section serve. `say` gets one line for the log each time something happens.
  CommandServer(const Rig& rig, std::filesystem::path socket, CommandLink& link, const RecordingSeries* series,
                std::function<void(const std::string&)> say);
  /// Ends the thread, closes all and takes the socket's name away.
  ~CommandServer();
  CommandServer(const CommandServer&) = delete;
  CommandServer& operator=(const CommandServer&) = delete;
  /// Before start(): another commander, which lives at least as long as the server.
  void add(LocalCommander& commander);
  void start();

 private:
  using Clock = std::chrono::steady_clock;
  struct Client {
    Descriptor descriptor;
    std::uint64_t number = 0;
    std::string name, in, out;
    bool ends = false;  // once `out` is sent
    bool obeyed = false;  // a command of its own was taken
    double watch_s = 0.0;
    Clock::time_point next_watch, heard;
  };
  struct Asked {
    std::uint64_t client = 0;
    nlohmann::json id;
    std::int64_t tick = 0;  // the last that was over when it came
    std::uint64_t number = 0;  // of a local commander's command
  };

  void serve(const std::stop_token& ends);
  void wait();
  void accept_from(const Descriptor& listener);
  void receive(Client& client);
  void handle(Client& client, const std::string& line);
  void command(Client& client, const Request& request);
  CommandResult pass_on(AxisCommand command, Asked asked);
  void take_local_words();
  void post_owed();
  void take_answers();
  void take_status();
  void watch(Client& client, Clock::time_point now);
  void send_out(Client& client);
  void drop_ended();
  void lose_commander(const std::string& why);
  void put(Client& client, const std::string& line);
  std::string commander_name() const;

  CommandedRig rig_;
  RequestReader reader_;
  ServeParameters settings_;
  std::filesystem::path path_;
  CommandLink& link_;
  const RecordingSeries* series_;
  std::function<void(const std::string&)> say_;
  ServiceNotice notice_;
  Descriptor local_, tcp_;
  std::list<Client> clients_;
  LocalCommander* local_commander_ = nullptr;
  std::map<std::uint64_t, Asked> asked_;  // by number of command
  CommandKind owed_ = CommandKind::none, last_motion_ = CommandKind::none;
  std::uint64_t commands_ = 0, numbers_ = 0, commander_ = 0;
  AxisStatus status_;
  std::jthread thread_;
};

}  // namespace pneuservo
