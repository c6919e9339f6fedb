// The least that a loop over CAN does: wake on the grid, take what came, send a command and SYNC, and a heartbeat now
// and then. Prints its work a tick.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

namespace {

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::size_t most_frames = 16;

std::int64_t now_ns() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * second_ns + t.tv_nsec;
}

int opened(const char* interface) {
  const int file = socket(PF_CAN, SOCK_RAW, CAN_RAW);
  ifreq request{};
  std::strncpy(request.ifr_name, interface, IFNAMSIZ - 1);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  if (file < 0 || ioctl(file, SIOCGIFINDEX, &request) != 0) return -1;
  address.can_ifindex = request.ifr_ifindex;
  return bind(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? file : -1;
}

bool put(int file, canid_t id, std::initializer_list<std::uint8_t> bytes) {
  can_frame frame{};
  frame.can_id = id;
  frame.can_dlc = static_cast<std::uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), frame.data);
  return send(file, &frame, sizeof frame, MSG_DONTWAIT) == sizeof frame;
}

int taken(int file) {
  std::array<can_frame, most_frames> frames;
  std::array<iovec, most_frames> parts;
  std::array<mmsghdr, most_frames> headers{};
  for (std::size_t i = 0; i < most_frames; ++i) {
    parts[i] = {&frames[i], sizeof frames[i]};
    headers[i].msg_hdr.msg_iov = &parts[i];
    headers[i].msg_hdr.msg_iovlen = 1;
  }
  return std::max(recvmmsg(file, headers.data(), most_frames, MSG_DONTWAIT, nullptr), 0);
}

}  // namespace

int main(int count, char** words) {
  if (count != 6) {
    std::fputs("usage: bare_loop INTERFACE COMMAND_ID PERIOD_US TICKS TICKS_PER_HEARTBEAT\n", stderr);
    return 2;
  }
  const int file = opened(words[1]);
  const auto command = static_cast<canid_t>(std::strtoul(words[2], nullptr, 0));
  const std::int64_t period_ns = std::atoll(words[3]) * 1000;
  const auto ticks = static_cast<std::size_t>(std::atoll(words[4]));
  const std::int64_t ticks_per_heartbeat = std::atoll(words[5]);
  const sched_param priority{80};
  if (file < 0 || mlockall(MCL_CURRENT | MCL_FUTURE) != 0 || sched_setscheduler(0, SCHED_FIFO, &priority) != 0) {
    std::perror("bare_loop");
    return 1;
  }
  constexpr canid_t nmt = 0x000, sync = 0x080, heartbeat = 0x77F;
  put(file, nmt, {0x01, 0x00});  // start all nodes
  std::vector<std::int64_t> work_ns(ticks);
  std::int64_t slot_ns = now_ns() + 100 * period_ns, frames = 0, unsent = 0, tick = 0;
  for (std::int64_t& work : work_ns) {
    slot_ns += period_ns;
    const timespec until{slot_ns / second_ns, slot_ns % second_ns};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
    const std::int64_t began_ns = now_ns();
    frames += taken(file);
    unsent += !put(file, command, {0, 0});
    unsent += !put(file, sync, {});
    if (tick++ % ticks_per_heartbeat == 0) unsent += !put(file, heartbeat, {0x05});
    work = now_ns() - began_ns;
  }
  put(file, nmt, {0x80, 0x00});  // pre-operational again
  std::sort(work_ns.begin(), work_ns.end());
  const auto at = [&](double quantile) {
    const auto place = static_cast<std::size_t>(quantile * static_cast<double>(ticks));
    return static_cast<double>(work_ns[std::min(place, ticks - 1)]) * 1e-3;
  };
  std::printf("{\"p50\": %.3f, \"p99\": %.3f, \"p99_9\": %.3f, \"p99_99\": %.3f, \"max\": %.3f, \"frames\": %lld, "
              "\"unsent\": %lld}\n",
              at(0.5), at(0.99), at(0.999), at(0.9999), at(1.0), static_cast<long long>(frames),
              static_cast<long long>(unsent));
  return 0;
}
