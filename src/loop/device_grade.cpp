// Grades what closes the valves of a rig on devices when this program is gone.
#include "loop/device_grade.hpp"

#include <fmt/format.h>

namespace pneuservo {
namespace {

using Level = FindingLevel;

/// `section`: comedi or iio, whose devices keep their outputs.
Finding board_finding(const Rig& rig, const std::string& topic, const std::string& section, BoardWatchdog watchdog) {
  switch (watchdog) {
    case BoardWatchdog::board:
      return {Level::good, topic, fmt::format("its own watchdog acts after {:g} s", rig.hal->comedi->watchdog_s), ""};
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
          "wire a relay with a watchdog or an enable line, or run pneuservo guard; then state hal." + section +
              ".watchdog"};
}

}  // namespace

std::vector<Finding> grade_devices(const Rig& rig) {
  std::vector<Finding> findings;
  if (!rig.hal) return findings;
  bool on_board = false, on_iio = false, on_bus = false, on_line = false, is_real = false;
  rig.hal->channels.for_each_command([&](std::string_view, std::size_t, const auto& valve) {
    on_board = on_board || valve.comedi;
    on_iio = on_iio || valve.iio;
    on_bus = on_bus || valve.can;
    on_line = on_line || valve.gpio;
    is_real = is_real || valve.is_real();
  });
  const auto none = BoardWatchdog::none;
  if (on_board)
    findings.push_back(board_finding(rig, "board without program", "comedi", rig.hal->comedi->watchdog.value_or(none)));
  if (on_iio)
    findings.push_back(board_finding(rig, "I/O device without program", "iio", rig.hal->iio->watchdog.value_or(none)));
  if (on_line)
    findings.push_back(board_finding(rig, "lines without program", "gpio", rig.hal->gpio->watchdog.value_or(none)));
  if (on_bus)
    findings.push_back({Level::good, "bus without program",
                        fmt::format("its devices give their substitute output after {:g} s", rig.hal->can->watchdog_s),
                        ""});
  if (rig.hal->bench && is_real)
    findings.push_back({Level::acceptable, "hal.bench", "a real valve may follow simulated sensors",
                        "leave it out on a machine that moves"});
  if (!rig.concealed.empty())
    findings.push_back({Level::acceptable, "concealed",
                        fmt::format("found {}, which the simulated machine alone has", rig.concealed.begin()->first),
                        "leave the section out with devices"});
  return findings;
}

std::string device_warning(const Rig& rig) {
  std::string text;
  for (const Finding& finding : grade_devices(rig))
    if (finding.level == Level::bad || finding.topic == "concealed")
      text += fmt::format("WARNING: {}: {}\n  {}\n", finding.topic, finding.what, finding.remedy);
  return text;
}

}  // namespace pneuservo
