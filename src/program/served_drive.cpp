// The thread that keeps an axis on a CAN bus as a drive.
#include "program/served_drive.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "can/open_carrier.hpp"
#include "record/ordinary_thread.hpp"

namespace pneuservo {
namespace {

constexpr std::int64_t longest_wait_ns = 1'000'000;  // answers and status of the axis are looked for so often
constexpr int most_frames_a_look = 256;              // a flood must not stop heartbeats

std::string name_of(const Rig& rig) {
  return fmt::format("node {} on {}", rig.serve->drive->node_id, rig.serve->drive->interface);
}

}  // namespace

ServedDrive::ServedDrive(const Rig& rig)
    : name_(name_of(rig)), drive_(rig),
      bus_(open_carrier(rig.serve->drive->interface, rig.serve->drive->bit_rate_bps, true)),
      commander_("the drive, " + name_) {
  out_.reserve(64);
}

ServedDrive::~ServedDrive() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void ServedDrive::start() {
  thread_ = std::jthread([this](const std::stop_token& ends) { serve(ends); });
}

void ServedDrive::serve(const std::stop_token& ends) {
  become_ordinary_thread("drive");
  drive_.power_on(bus_->now_ns(), out_);
  while (!ends.stop_requested()) {
    send();
    bus_->wait(std::clamp<std::int64_t>(drive_.next_due_ns() - bus_->now_ns(), 1, longest_wait_ns));
    take_from_axis();
    take_frames();
    drive_.on_link(bus_->is_up(), out_);
    drive_.on_time(bus_->now_ns(), out_);
  }
}

void ServedDrive::take_frames() {
  int taken = 0;
  for (ReceivedFrame received; taken < most_frames_a_look && bus_->receive(received); ++taken) {
    drive_.on_frame(received.frame, received.received_ns, out_);
    send();
  }
}

void ServedDrive::take_from_axis() {
  for (AxisAnswer answer; commander_.take_answer(answer);) drive_.on_answer(answer, out_);
  if (AxisStatus status; commander_.take_status(status)) drive_.on_status(status, out_);
}

// A frame that finds no room is lost, as on any bus; words to the axis wait.
void ServedDrive::send() {
  for (const CanFrame& frame : out_)
    if (bus_->is_up()) bus_->send(frame);
  out_.clear();
  const std::vector<CommanderWord> newest = drive_.take_words();
  words_.insert(words_.end(), newest.begin(), newest.end());
  const auto refused = std::ranges::find_if(words_, [&](const CommanderWord& word) { return !commander_.say(word); });
  words_.erase(words_.begin(), refused);
}

}  // namespace pneuservo
