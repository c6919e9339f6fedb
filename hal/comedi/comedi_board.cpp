// A DA/AD board through comedilib. comedi_absent.cpp stands in where it is not installed.
#if defined(PNEUSERVO_HAS_COMEDI)
#include "comedi/comedi_board.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include <comedilib.h>
#include <fmt/format.h>

#include <pneuservo/core/rt.hpp>

#include "device_lock.hpp"

namespace pneuservo {
namespace {

constexpr double watchdog_step_s = 0.02;

/// One line of the board: its instruction, its raw value and how that becomes volts.
struct Line {
  std::string key;
  unsigned subdevice = 0, chanspec = 0;
  lsampl_t raw = 0, last = 0;
  comedi_polynomial_t to_physical{}, from_physical{};
  double lowest_V = 0.0, highest_V = 0.0;
  std::string calibration;
};

unsigned reference_code(ComediReference reference) {
  switch (reference) {
    case ComediReference::common: return AREF_COMMON;
    case ComediReference::differential: return AREF_DIFF;
    case ComediReference::ground: break;
  }
  return AREF_GROUND;
}

std::vector<comedi_insn> instructions(std::vector<Line>& lines, unsigned kind) {
  std::vector<comedi_insn> list(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    list[i].insn = kind;
    list[i].n = 1;
    list[i].data = &lines[i].raw;
    list[i].subdev = lines[i].subdevice;
    list[i].chanspec = lines[i].chanspec;
  }
  return list;
}

}  // namespace

struct ComediBoard::Device {
  std::string name;
  comedi_t* handle = nullptr;
  std::unique_ptr<comedi_calibration_t, void (*)(comedi_calibration_t*)> calibration{nullptr,
                                                                                     comedi_cleanup_calibration};
  std::string calibration_path;
  std::vector<Line> inputs, outputs, counters;
  unsigned watchdog = 0;
  lsampl_t reload = 0;
  bool has_watchdog = false;
  // Rebuilt whenever a line is added: their data point into the lines.
  std::vector<comedi_insn> reads, counts, writes;

  ~Device() {
    if (handle != nullptr) comedi_close(handle);
  }

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw std::runtime_error(fmt::format("{}: hal.channels.{}: {}", name, key, what));
  }

  void read_calibration(const std::string& wanted) {
    calibration_path = wanted;
    if (wanted.empty()) {
      char* usual = comedi_get_default_calibration_path(handle);
      if (usual != nullptr) calibration_path = usual;
      std::free(usual);
      if (!std::filesystem::exists(calibration_path)) return;
    }
    calibration.reset(comedi_parse_calibration_file(calibration_path.c_str()));
    if (!calibration)
      throw std::runtime_error(fmt::format(
          "{}: calibration file {} cannot be read: {}; make it with comedi_calibrate or comedi_soft_calibrate, "
          "or leave hal.comedi.calibration out",
          name, calibration_path, comedi_strerror(comedi_errno())));
  }

  Line line(const std::string& key, unsigned subdevice, const char* what, std::uint32_t channel, std::uint32_t range,
            ComediReference reference) const {
    const int channels = comedi_get_n_channels(handle, subdevice);
    if (static_cast<int>(channel) >= channels)
      fail(key, fmt::format("found {} {}, expected one of 0 to {}", what, channel, channels - 1));
    const int ranges = comedi_get_n_ranges(handle, subdevice, channel);
    if (static_cast<int>(range) >= ranges) fail(key, ranges_text(subdevice, channel, range, ranges));
    const comedi_range* volts = comedi_get_range(handle, subdevice, channel, range);
    if (volts == nullptr || volts->unit != UNIT_volt)
      fail(key, fmt::format("range {} of {} {} is not in volts, expected one that is", range, what, channel));
    Line line;
    line.key = key;
    line.subdevice = subdevice;
    line.chanspec = CR_PACK(channel, range, reference_code(reference));
    line.last = comedi_get_maxdata(handle, subdevice, channel);
    line.lowest_V = volts->min;
    line.highest_V = volts->max;
    return line;
  }

  std::string ranges_text(unsigned subdevice, std::uint32_t channel, std::uint32_t found, int ranges) const {
    std::string known;
    for (int i = 0; i < ranges; ++i)
      if (const comedi_range* r = comedi_get_range(handle, subdevice, channel, static_cast<unsigned>(i)))
        known += fmt::format("{}{}: {:g} to {:g} V", i > 0 ? ", " : "", i, r->min, r->max);
    return fmt::format("found range {}, expected one of {}", found, known);
  }

  // Boards calibrated by software state a polynomial for each channel and range; others trim themselves and are linear.
  void calibrate(Line& line) {
    const unsigned channel = CR_CHAN(line.chanspec), range = CR_RANGE(line.chanspec), aref = CR_AREF(line.chanspec);
    const bool by_software = (comedi_get_subdevice_flags(handle, line.subdevice) & SDF_SOFT_CALIBRATED) != 0;
    const auto converters = [&](auto&& get) {
      return get(COMEDI_TO_PHYSICAL, &line.to_physical) >= 0 && get(COMEDI_FROM_PHYSICAL, &line.from_physical) >= 0;
    };
    if (by_software && calibration && converters([&](auto direction, auto* polynomial) {
          return comedi_get_softcal_converter(line.subdevice, channel, range, direction, calibration.get(), polynomial);
        })) {
      line.calibration = "calibrated by " + calibration_path;
      return;
    }
    if (!converters([&](auto direction, auto* polynomial) {
          return comedi_get_hardcal_converter(handle, line.subdevice, channel, range, direction, polynomial);
        }))
      fail(line.key, std::string("no conversion to volts: ") + comedi_strerror(comedi_errno()));
    line.calibration = by_software ? "NOT calibrated: run comedi_soft_calibrate" : "the board's own calibration";
    if (by_software || !calibration) return;
    if (comedi_apply_parsed_calibration(handle, line.subdevice, channel, range, aref, calibration.get()) >= 0)
      line.calibration = "trimmed by " + calibration_path;
  }

  std::size_t add(std::vector<Line>& lines, Line line) {
    lines.push_back(std::move(line));
    reads = instructions(inputs, INSN_READ);
    counts = instructions(counters, INSN_READ);
    reads.insert(reads.end(), counts.begin(), counts.end());
    writes = instructions(outputs, INSN_WRITE);
    return lines.size() - 1;
  }

  unsigned subdevice_of(const std::string& key, int type, const char* what) const {
    const int subdevice = comedi_find_subdevice_by_type(handle, type, 0);
    if (subdevice < 0) fail(key, fmt::format("found a board without {}, expected one that has them", what));
    return static_cast<unsigned>(subdevice);
  }

  // The one kind of watchdog that comedi knows (drivers of ADDI-DATA): armed with its time in steps of 20 ms less one,
  // fed by writing, a timer to look at.
  void find_watchdog(const ComediParameters& parameters) {
    watchdog = parameters.watchdog_subdevice;
    const int type = comedi_get_subdevice_type(handle, watchdog);
    if (type != COMEDI_SUBD_TIMER || (comedi_get_subdevice_flags(handle, watchdog) & SDF_WRITABLE) == 0)
      throw std::runtime_error(fmt::format("{}: hal.comedi.watchdog_subdevice: found {}, which is no writable timer, "
                                           "expected the board's watchdog (comedi_board_info), or another "
                                           "hal.comedi.watchdog",
                                           name, watchdog));
    reload = static_cast<lsampl_t>(std::ceil(parameters.watchdog_s / watchdog_step_s - 1e-9)) - 1;
    has_watchdog = true;
  }

  bool configure_watchdog(unsigned what, unsigned words) noexcept {
    lsampl_t data[2]{what, reload};
    comedi_insn order{};
    order.insn = INSN_CONFIG;
    order.n = words;
    order.data = data;
    order.subdev = watchdog;
    return comedi_do_insn(handle, &order) >= 0;
  }

  bool execute(std::vector<comedi_insn>& list) noexcept {
    if (list.empty()) return true;
    comedi_insnlist instruction_list{static_cast<unsigned>(list.size()), list.data()};
    const RtAllow reviewed;  // one ioctl for all
    return comedi_do_insnlist(handle, &instruction_list) == static_cast<int>(list.size());
  }
};

ComediBoard::ComediBoard(const ComediParameters& parameters, bool shared) : device_(std::make_unique<Device>()) {
  device_->name = parameters.device;
  device_->handle = comedi_open(parameters.device.c_str());
  if (device_->handle == nullptr)
    throw std::runtime_error(fmt::format("{}: the board cannot be opened: {}; is its driver attached (comedi_config, "
                                         "dmesg), and may this user open it?",
                                         parameters.device, comedi_strerror(comedi_errno())));
  if (!shared) lock_device(comedi_fileno(device_->handle), parameters.device);
  device_->read_calibration(parameters.calibration);
  if (parameters.watchdog == BoardWatchdog::board) device_->find_watchdog(parameters);
}

ComediBoard::~ComediBoard() = default;

void ComediBoard::arm_watchdog() {
  if (!device_->has_watchdog) return;
  if (!device_->configure_watchdog(INSN_CONFIG_ARM, 2))
    throw std::runtime_error(fmt::format("{}: the driver refuses to arm the watchdog of subdevice {}: {}",
                                         device_->name, device_->watchdog, comedi_strerror(comedi_errno())));
}

void ComediBoard::disarm_watchdog() noexcept {
  if (device_->has_watchdog) device_->configure_watchdog(INSN_CONFIG_DISARM, 1);
}

bool ComediBoard::feed_watchdog() noexcept {
  if (!device_->has_watchdog) return true;
  const RtAllow reviewed;  // one ioctl
  lsampl_t any = 1;
  comedi_insn feed{};
  feed.insn = INSN_WRITE;
  feed.n = 1;
  feed.data = &any;
  feed.subdev = device_->watchdog;
  return comedi_do_insn(device_->handle, &feed) == 1;
}

std::size_t ComediBoard::add_input(const std::string& key, std::uint32_t channel, std::uint32_t range,
                                   ComediReference reference) {
  Line line = device_->line(key, device_->subdevice_of(key, COMEDI_SUBD_AI, "analog inputs"), "input", channel, range,
                            reference);
  device_->calibrate(line);
  return device_->add(device_->inputs, std::move(line));
}

std::size_t ComediBoard::add_output(const std::string& key, std::uint32_t channel, std::uint32_t range,
                                    ComediReference reference) {
  Line line = device_->line(key, device_->subdevice_of(key, COMEDI_SUBD_AO, "analog outputs"), "output", channel, range,
                            reference);
  device_->calibrate(line);
  const std::size_t number = device_->add(device_->outputs, std::move(line));
  set_volts(number, 0.0);
  return number;
}

std::size_t ComediBoard::add_counter(const std::string& key, std::uint32_t subdevice, std::uint32_t channel) {
  if (comedi_get_subdevice_type(device_->handle, subdevice) != COMEDI_SUBD_COUNTER)
    device_->fail(
        key, fmt::format("found subdevice {} that is no counter, expected one (see comedi_board_info)", subdevice));
  if (static_cast<int>(channel) >= comedi_get_n_channels(device_->handle, subdevice))
    device_->fail(key, fmt::format("found counter {}, expected one that subdevice {} has", channel, subdevice));
  Line line;
  line.key = key;
  line.subdevice = subdevice;
  line.chanspec = CR_PACK(channel, 0, AREF_GROUND);
  line.last = comedi_get_maxdata(device_->handle, subdevice, channel);
  return device_->add(device_->counters, std::move(line));
}

bool ComediBoard::read() noexcept { return device_->execute(device_->reads); }
bool ComediBoard::write() noexcept { return device_->execute(device_->writes); }

double ComediBoard::volts(std::size_t input) const noexcept {
  const Line& line = device_->inputs[input];
  return comedi_to_physical(line.raw, &line.to_physical);
}

bool ComediBoard::is_saturated(std::size_t input) const noexcept {
  const Line& line = device_->inputs[input];
  return line.raw == 0 || line.raw >= line.last;
}

void ComediBoard::set_volts(std::size_t output, double volts) noexcept {
  Line& line = device_->outputs[output];
  const comedi_polynomial_t& p = line.from_physical;
  const double offset = std::clamp(volts, line.lowest_V, line.highest_V) - p.expansion_origin;
  double code = 0.0;
  for (unsigned i = std::min(p.order, COMEDI_MAX_NUM_POLYNOMIAL_COEFFICIENTS - 1u) + 1; i-- > 0;)
    code = code * offset + p.coefficients[i];
  // Not comedi_from_physical: it does not hold the code within the converter's.
  line.raw = static_cast<lsampl_t>(std::clamp(std::nearbyint(code), 0.0, static_cast<double>(line.last)));
}

double ComediBoard::set_volts_of(std::size_t output) const noexcept {
  const Line& line = device_->outputs[output];
  return comedi_to_physical(line.raw, &line.to_physical);
}

std::uint32_t ComediBoard::counts(std::size_t counter) const noexcept { return device_->counters[counter].raw; }
std::uint32_t ComediBoard::last_count(std::size_t counter) const noexcept { return device_->counters[counter].last; }

std::vector<std::string> ComediBoard::description() const {
  std::vector<std::string> text{fmt::format("{}: {}, driver {}", device_->name, comedi_get_board_name(device_->handle),
                                            comedi_get_driver_name(device_->handle))};
  for (const auto* lines : {&device_->inputs, &device_->outputs})
    for (const Line& line : *lines)
      text.push_back(fmt::format("{}: {} {}, {:g} to {:g} V, {}", line.key,
                                 lines == &device_->inputs ? "input" : "output", CR_CHAN(line.chanspec), line.lowest_V,
                                 line.highest_V, line.calibration));
  return text;
}

}  // namespace pneuservo

#endif
