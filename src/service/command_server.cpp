// Takes commands of an axis over sockets and passes them to its loop.
#include "service/command_server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <pneuservo/loop/fault.hpp>

#include "config/input_error.hpp"
#include "record/ordinary_thread.hpp"
#include "service/sockets.hpp"

namespace pneuservo {
namespace {

constexpr int busy_ms = 1, idle_ms = 10;
/// Of the link's queues: the answer to each command has its place, and the server's own stop, too.
constexpr std::size_t most_unanswered = CommandLink::most_waiting - 2;

ServeParameters serve_parameters(const Rig& rig) { return rig.serve.value_or(ServeParameters{}); }

}  // namespace

CommandServer::CommandServer(const Rig& rig, std::filesystem::path socket, CommandLink& link,
                             const RecordingSeries* series, std::function<void(const std::string&)> say)
    : rig_(rig), reader_(rig_), settings_(serve_parameters(rig)), path_(std::move(socket)), link_(link),
      series_(series), say_(std::move(say)), local_(listen_at(path_)) {
  if (settings_.tcp_port != 0) tcp_ = listen_on_loopback(static_cast<std::uint16_t>(settings_.tcp_port));
}

CommandServer::~CommandServer() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  std::error_code error;
  std::filesystem::remove(path_, error);
}

void CommandServer::add(LocalCommander& commander) {
  commander.number_ = ++numbers_;
  local_commander_ = &commander;
}

void CommandServer::start() {
  thread_ = std::jthread([this](const std::stop_token& ends) { serve(ends); });
}

void CommandServer::serve(const std::stop_token& ends) {
  become_ordinary_thread("commands");
  bool is_ready = false;
  while (!ends.stop_requested()) {
    wait();
    take_status();
    take_answers();
    take_local_words();
    if (!is_ready && status_.tick >= 0) notice_.ready(fmt::format("commands at {}", path_.string()));
    is_ready = status_.tick >= 0;
    notice_.alive(status_.tick);
    const auto now = Clock::now();
    for (Client& client : clients_) {
      watch(client, now);
      send_out(client);
      const std::chrono::duration<double> silent = now - client.heard;
      if (client.number == commander_ && settings_.commander_silent_s > 0.0 &&
          silent.count() > settings_.commander_silent_s)
        lose_commander(fmt::format("said nothing for {:g} s", settings_.commander_silent_s));
    }
    drop_ended();
    post_owed();
  }
  notice_.stopping();
}

void CommandServer::wait() {
  std::vector<pollfd> polled{{local_.number(), POLLIN, 0}};
  if (tcp_) polled.push_back({tcp_.number(), POLLIN, 0});
  const std::size_t listeners = polled.size();
  if (local_commander_ != nullptr) polled.push_back({local_commander_->wake_.number(), POLLIN, 0});
  const std::size_t before_clients = polled.size();
  for (const Client& client : clients_)
    polled.push_back(
        {client.descriptor.number(), static_cast<short>(client.out.empty() ? POLLIN : POLLIN | POLLOUT), 0});
  const bool busy = local_commander_ != nullptr || !asked_.empty() || owed_ != CommandKind::none;
  if (poll(polled.data(), polled.size(), busy ? busy_ms : idle_ms) <= 0) return;
  std::size_t i = before_clients;
  for (Client& client : clients_)
    if ((polled[i++].revents & (POLLIN | POLLHUP | POLLERR)) != 0) receive(client);
  if (polled[0].revents != 0) accept_from(local_);
  if (listeners > 1 && polled[1].revents != 0) accept_from(tcp_);
}

void CommandServer::accept_from(const Descriptor& listener) {
  Descriptor descriptor(accept4(listener.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!descriptor) return;
  Client client;
  client.descriptor = std::move(descriptor);
  client.number = ++numbers_;
  client.name = peer_name(client.descriptor.number());
  client.heard = Clock::now();
  if (clients_.size() >= most_clients) {
    put(client,
        error_line({}, fmt::format("{} connections are open, expected at most {}", clients_.size(), most_clients)));
    send_out(client);
    return;
  }
  clients_.push_back(std::move(client));
}

void CommandServer::receive(Client& client) {
  std::array<char, longest_line> bytes;
  const ssize_t count = recv(client.descriptor.number(), bytes.data(), bytes.size(), 0);
  if (count <= 0) {
    const bool goes_on = count < 0 && (errno == EAGAIN || errno == EINTR);
    if (!goes_on) client.descriptor = Descriptor();
    return;
  }
  client.in.append(bytes.data(), static_cast<std::size_t>(count));
  client.heard = Clock::now();
  std::size_t begin = 0;
  for (std::size_t end; !client.ends && (end = client.in.find('\n', begin)) != std::string::npos; begin = end + 1)
    if (end > begin) handle(client, client.in.substr(begin, end - begin));
  client.in.erase(0, begin);
  if (client.in.size() <= longest_line) return;
  put(client, error_line({}, fmt::format("found a line of more than {} bytes, expected a request", longest_line)));
  client.in.clear();
  client.ends = true;
}

void CommandServer::handle(Client& client, const std::string& line) {
  nlohmann::json id;
  try {
    const Request request = reader_.read(line, id);
    switch (request.kind) {
      case RequestKind::command: return command(client, request);
      case RequestKind::release:
        if (commander_ == client.number) commander_ = 0;
        break;
      case RequestKind::watch:
        client.watch_s = request.interval_s;
        client.next_watch = Clock::now();
        break;
      case RequestKind::status: break;
    }
    nlohmann::ordered_json answer{{"version", protocol_version}};
    if (!id.is_null()) answer["id"] = id;
    answer["ok"] = true;
    if (request.kind == RequestKind::status) {
      take_status();
      answer["status"] = status_json(rig_, status_, commander_name(), series_ ? series_->state() : SeriesState{});
    }
    put(client, answer.dump());
  } catch (const InputError& error) { put(client, error_line(id, error.what())); }
}

void CommandServer::command(Client& client, const Request& request) {
  switch (pass_on(request.command, {client.number, request.id, 0, 0})) {
    case CommandResult::other_commander:
      return put(client, error_line(request.id, fmt::format("commanded by {}, expected one commander: it has to "
                                                            "release or end first",
                                                            commander_name())));
    case CommandResult::too_many:
      return put(client, error_line(request.id, fmt::format("{} commands are without an answer, expected fewer: wait "
                                                            "for answers",
                                                            asked_.size())));
    default: break;
  }
}

CommandResult CommandServer::pass_on(AxisCommand command, Asked asked) {
  const bool takes = needs_command(command.kind);
  if (takes && commander_ != 0 && commander_ != asked.client) return CommandResult::other_commander;
  take_status();
  command.number = ++commands_;
  if (asked_.size() >= most_unanswered || !link_.commands.push(command)) return CommandResult::too_many;
  asked.tick = status_.tick;
  if (takes && commander_ == 0) {
    commander_ = asked.client;
    last_motion_ = CommandKind::none;
  }
  if (is_motion(command.kind)) last_motion_ = command.kind;
  asked_[command.number] = std::move(asked);
  return CommandResult::taken;
}

void CommandServer::take_local_words() {
  if (local_commander_ == nullptr) return;
  LocalCommander& local = *local_commander_;
  std::uint64_t wakes = 0;
  [[maybe_unused]] const ssize_t count = read(local.wake_.number(), &wakes, sizeof wakes);
  for (CommanderWord word; local.words_.pop(word);) {
    const bool has_axis = commander_ == local.number_;
    switch (word.kind) {
      case CommanderWord::Kind::command: {
        Asked asked;
        asked.client = local.number_;
        asked.number = word.command.number;
        const CommandResult result = pass_on(word.command, std::move(asked));
        if (result != CommandResult::taken) local.answers_.push({word.command.number, result, status_.tick});
        break;
      }
      case CommanderWord::Kind::release:
        if (has_axis) commander_ = 0;
        break;
      case CommanderWord::Kind::lost:
        if (has_axis) lose_commander("is gone");
        break;
    }
  }
}

/// Commands of the server's own, which nobody waits for.
void CommandServer::post_owed() {
  if (owed_ == CommandKind::none) return;
  AxisCommand command{owed_};
  command.number = ++commands_;
  if (!link_.commands.push(command)) return;
  asked_[command.number] = {};
  owed_ = CommandKind::none;
}

void CommandServer::take_answers() {
  for (AxisAnswer answer; link_.answers.pop(answer);) {
    const auto asked = asked_.find(answer.number);
    if (asked == asked_.end()) continue;
    if (local_commander_ != nullptr && asked->second.client == local_commander_->number_) {
      AxisAnswer own = answer;
      own.number = asked->second.number;
      local_commander_->answers_.push(own);
    }
    for (Client& client : clients_) {
      if (client.number != asked->second.client) continue;
      client.obeyed = client.obeyed || answer.result == CommandResult::taken;
      put(client, answer_line(rig_, asked->second.id, answer, answer.tick - asked->second.tick));
    }
    asked_.erase(asked);
  }
}

void CommandServer::take_status() {
  AxisStatus now = status_;
  if (!link_.status.take(now)) return;
  if (local_commander_ != nullptr) local_commander_->status_.post(now);
  if (now.state != status_.state)
    say_(fmt::format("{:.3f} s: {}", now.t_s, supervisor_state_names[static_cast<std::size_t>(now.state)]));
  if (now.faults != 0 && status_.faults == 0)
    for (const FaultText& text : fault_texts)
      if ((now.first_faults & text.bit) != 0)
        say_(fmt::format("{:.3f} s: fault: {}: {}", now.t_s, text.name, text.meaning));
  status_ = now;
}

void CommandServer::watch(Client& client, Clock::time_point now) {
  if (client.watch_s <= 0.0 || now < client.next_watch || !client.out.empty()) return;
  const auto interval = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(client.watch_s));
  client.next_watch = std::max(client.next_watch + interval, now);
  nlohmann::ordered_json line{{"version", protocol_version}};
  line["status"] = status_json(rig_, status_, commander_name(), series_ ? series_->state() : SeriesState{});
  put(client, line.dump());
}

void CommandServer::put(Client& client, const std::string& line) {
  client.out += line;
  client.out += '\n';
}

void CommandServer::send_out(Client& client) {
  if (!client.out.empty() && client.descriptor) {
    const ssize_t sent = send(client.descriptor.number(), client.out.data(), client.out.size(), MSG_NOSIGNAL);
    if (sent > 0) client.out.erase(0, static_cast<std::size_t>(sent));
    else if (errno != EAGAIN && errno != EINTR) client.descriptor = Descriptor();
  }
  if (client.out.size() > most_unread || (client.ends && client.out.empty())) client.descriptor = Descriptor();
}

void CommandServer::drop_ended() {
  for (auto client = clients_.begin(); client != clients_.end();) {
    if (client->descriptor) {
      ++client;
      continue;
    }
    // Who was refused alone moved nothing: what another one began goes on.
    const bool waits =
        std::ranges::any_of(asked_, [&](const auto& asked) { return asked.second.client == client->number; });
    if (client->number == commander_) {
      if (client->obeyed || waits) lose_commander("is gone");
      else commander_ = 0;
    }
    client = clients_.erase(client);
  }
}

void CommandServer::lose_commander(const std::string& why) {
  const std::string name = commander_name();
  commander_ = 0;
  switch (settings_.commander_lost) {
    case CommanderLost::finish: owed_ = last_motion_ == CommandKind::jog ? CommandKind::stop : CommandKind::none; break;
    case CommanderLost::stop: owed_ = CommandKind::stop; break;
    case CommanderLost::safe: owed_ = CommandKind::disable; break;
  }
  say_(fmt::format("{:.3f} s: the commander ({}) {}: {}", status_.t_s, name, why,
                   commander_lost_names[static_cast<std::size_t>(settings_.commander_lost)]));
}

std::string CommandServer::commander_name() const {
  if (local_commander_ != nullptr && commander_ == local_commander_->number_ && commander_ != 0)
    return local_commander_->name_;
  for (const Client& client : clients_)
    if (client.number == commander_) return client.name;
  return {};
}

}  // namespace pneuservo
