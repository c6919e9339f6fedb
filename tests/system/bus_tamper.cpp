// Stands between a controller and the verb device on the local bus (unix:PATH) and spoils frames on purpose.
// usage: bus_tamper LISTEN DEVICE MODE FIRST_SYNC [ID [COUNTS]]    from SYNC number FIRST_SYNC on
//   lost_outputs          output PDOs do not reach the device
//   moved_outputs         output PDOs reach it under an identifier that it does not take
//   pre_operational       once: a foreign master sends node ID into pre-operational
//   jumps, lost_answers   of three answers with identifier ID two are COUNTS off, are lost
//   late_answers          answers with identifier ID come one SYNC late
//   second_answer         answers with identifier ID come twice, the second COUNTS off
//   second_sync           every SYNC comes twice
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <linux/can.h>
#include <poll.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

namespace {

constexpr unsigned sync_id = 0x80, function_code = 0x780;

double now_s() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

[[noreturn]] void fail(const std::string& what) {
  std::perror(("bus_tamper: " + what).c_str());
  std::exit(1);
}

int bus_socket(const std::string& path, bool listens) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) fail(path);
  path.copy(address.sun_path, path.size());
  const int made = socket(AF_UNIX, SOCK_SEQPACKET, 0);
  const auto* const to = reinterpret_cast<const sockaddr*>(&address);
  if (made < 0) fail("socket");
  if (listens) {
    if (bind(made, to, sizeof address) != 0 || listen(made, 1) != 0) fail(path);
    return made;
  }
  for (int tries = 0; connect(made, to, sizeof address) != 0; ++tries) {
    if (tries > 500) fail(path);
    usleep(10'000);
  }
  return made;
}

void put(int to, const can_frame& frame) { send(to, &frame, sizeof frame, MSG_DONTWAIT | MSG_NOSIGNAL); }

can_frame offset(can_frame frame, std::int32_t counts) {  // of the first object, as long as the frame lets it be
  std::int32_t value = 0;
  const std::size_t length = frame.can_dlc < 4 ? frame.can_dlc : 4;
  std::memcpy(&value, frame.data, length);
  value += counts;
  std::memcpy(frame.data, &value, length);
  return frame;
}

can_frame pre_operational(unsigned node) {
  can_frame frame{};
  frame.can_dlc = 2;
  frame.data[0] = 0x80;
  frame.data[1] = static_cast<std::uint8_t>(node);
  return frame;
}

struct Tamper {
  std::string mode;
  long first_sync;
  unsigned id;
  std::int32_t counts;
  int controller = -1, device = -1;
  long syncs = 0, spoiled = 0;
  double began_s = 0.0;
  bool told = false, has_held = false;
  can_frame held{};

  bool is_on() const { return syncs >= first_sync; }
  static bool is_output(unsigned frame_id) {
    const unsigned code = frame_id & function_code;
    return code == 0x200 || code == 0x300 || code == 0x400 || code == 0x500;
  }
  void from_controller(can_frame frame) {
    if (frame.can_id == sync_id) {
      ++syncs;
      if (syncs == 1) began_s = now_s();
      if (is_on() && !told) {
        std::fprintf(stderr, "spoils from SYNC %ld on, %.3f s after the first\n", syncs, now_s() - began_s);
        told = true;
        if (mode == "pre_operational") put(device, pre_operational(id));
      }
      if (is_on() && mode == "second_sync") put(device, frame), ++spoiled;
    }
    if (is_on() && is_output(frame.can_id)) {
      if (mode == "lost_outputs") return void(++spoiled);
      if (mode == "moved_outputs") frame.can_id ^= 0x40, ++spoiled;
    }
    put(device, frame);
  }
  void from_device(const can_frame& frame) {
    if (!is_on() || frame.can_id != id) return put(controller, frame);
    const bool spoils = syncs % 3 != 0;
    if (mode == "lost_answers" && spoils) return void(++spoiled);
    if (mode == "jumps" && spoils) return ++spoiled, put(controller, offset(frame, counts));
    if (mode == "late_answers") {
      if (has_held) put(controller, held), ++spoiled;
      held = frame;
      has_held = true;
      return;
    }
    put(controller, frame);
    if (mode == "second_answer") ++spoiled, put(controller, offset(frame, counts));
  }
  void run() {
    pollfd ends[2] = {{controller, POLLIN, 0}, {device, POLLIN, 0}};
    for (;;) {
      poll(ends, 2, 100);
      for (const pollfd& end : ends) {
        if ((end.revents & (POLLIN | POLLHUP)) == 0) continue;
        can_frame frame{};
        const ssize_t got = recv(end.fd, &frame, sizeof frame, MSG_DONTWAIT);
        if (got == 0) return;
        if (got != static_cast<ssize_t>(sizeof frame)) continue;
        end.fd == controller ? from_controller(frame) : from_device(frame);
      }
    }
  }
};

}  // namespace

int main(int count, char** words) {
  if (count < 5) return 2;
  Tamper tamper{.mode = words[3],
                .first_sync = std::atol(words[4]),
                .id = count > 5 ? static_cast<unsigned>(std::strtoul(words[5], nullptr, 0)) : 0,
                .counts = count > 6 ? std::atoi(words[6]) : 0};
  sched_param priority{};
  priority.sched_priority = 70;  // between the controller and its device
  sched_setscheduler(0, SCHED_FIFO, &priority);
  const int listener = bus_socket(words[1], true);
  tamper.device = bus_socket(words[2], false);
  tamper.controller = accept(listener, nullptr, nullptr);
  if (tamper.controller < 0) fail("accept");
  tamper.run();
  std::fprintf(stderr, "%ld frames spoiled\n", tamper.spoiled);
  return 0;
}
