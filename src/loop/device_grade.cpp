// Grades what closes the valves of a rig on devices when this program is gone.
#include "loop/device_grade.hpp"

#include <fmt/format.h>

#include "rig/can_channels.hpp"

namespace pneuservo {
namespace {

using Level = FindingLevel;

Finding board_finding(const Rig& rig) {
  const ComediParameters& board = *rig.hal->comedi;
  const std::string topic = "board without program";
  switch (board.watchdog.value_or(BoardWatchdog::none)) {
    case BoardWatchdog::board:
      return {Level::good, topic, fmt::format("its own watchdog acts after {:g} s", board.watchdog_s), ""};
    case BoardWatchdog::guard:
      return {Level::good, topic, fmt::format("pneuservo guard acts after {:g} s", rig.hal->guard->timeout_s), ""};
    case BoardWatchdog::enable_line:
      return {Level::acceptable, topic,
              "keeps its outputs; hal.gpio.enable goes off at an ordered end, after kill -9 the chip decides and a "
              "stopped program holds it",
              "add hal.guard with an enable line of its own, or a relay with a watchdog"};
    case BoardWatchdog::external:
      return {Level::acceptable, topic, "keeps its outputs; something outside closes the valve, as the config says",
              "try it: kill -9 the run in a motion with the air shut off, and look at the valve"};
    case BoardWatchdog::none: break;
  }
  return {Level::bad, topic, "keeps its outputs: NOTHING closes the valve when this program dies or stops",
          "wire a relay with a watchdog or an enable line, or run pneuservo guard; then state hal.comedi.watchdog"};
}

void grade_readbacks(const Rig& rig, std::vector<Finding>& findings) {
  const HalChannels& c = rig.hal->channels;
  std::string unread;
  for (const auto& [name, valve] : {std::pair{"u", &c.u}, {"u1", &c.u1}, {"u2", &c.u2}}) {
    const bool is_read_back = (valve->can && valve->can->readback) || (valve->comedi && valve->comedi->readback);
    if ((valve->can || valve->comedi) && !is_read_back) unread += fmt::format("{}{}", unread.empty() ? "" : ", ", name);
  }
  if (unread.empty()) findings.push_back({Level::good, "readback", "each output is read back", ""});
  else
    findings.push_back({Level::acceptable, "readback",
                        unread + ": not read back, a lost command shows by the motion alone",
                        "name what shows the output: hal.channels.u.can.readback or .comedi.readback"});
}

}  // namespace

std::vector<Finding> grade_devices(const Rig& rig) {
  std::vector<Finding> findings;
  if (!rig.hal) return findings;
  const HalChannels& c = rig.hal->channels;
  const bool on_board = c.u.comedi || c.u1.comedi || c.u2.comedi, on_bus = c.u.can || c.u1.can || c.u2.can;
  if (on_board) findings.push_back(board_finding(rig));
  if (on_bus)
    findings.push_back({Level::good, "bus without program",
                        fmt::format("its devices give their substitute output after {:g} s", rig.hal->can->watchdog_s),
                        ""});
  if (on_board || on_bus) grade_readbacks(rig, findings);
  if (rig.hal->bench && (on_board || on_bus))
    findings.push_back({Level::acceptable, "hal.bench", "a real valve may follow simulated sensors",
                        "leave it out on a machine that moves"});
  return findings;
}

std::string device_warning(const Rig& rig) {
  std::string text;
  for (const Finding& finding : grade_devices(rig))
    if (finding.level == Level::bad)
      text += fmt::format("WARNING: {}: {}\n  {}\n", finding.topic, finding.what, finding.remedy);
  return text;
}

}  // namespace pneuservo
