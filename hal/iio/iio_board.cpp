// Devices of the kernel's Industrial I/O, found through libiio. iio_absent.cpp stands in where it is not installed.
#if defined(PNEUSERVO_HAS_IIO)
#include "iio/iio_board.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <iio.h>
#include <unistd.h>

#include "device_lock.hpp"
#include "iio/iio_attribute.hpp"
#include "iio/iio_scan.hpp"
#include "input_wait.hpp"

namespace pneuservo {
namespace {

constexpr double mV_of_V = 1e3;  // the kernel states voltages in mV
constexpr std::size_t timed_readings = 21;
constexpr double largest_code = 9007199254740992.0;  // 2^53: up to here a double holds each integer

struct CloseContext {
  void operator()(iio_context* context) const noexcept { iio_context_destroy(context); }
};
using Context = std::unique_ptr<iio_context, CloseContext>;

std::string text_of(const char* text) { return text == nullptr ? "" : text; }

/// "ad7606-8 (iio:device0)".
std::string name_of(const iio_device* device) {
  const std::string name = text_of(iio_device_get_name(device)), id = text_of(iio_device_get_id(device));
  return name.empty() ? id : fmt::format("{} ({})", name, id);
}

bool has_attribute(const iio_channel* channel, const char* name) {
  return iio_channel_find_attr(channel, name) != nullptr;
}

/// Voltages that can be read or written one by one.
std::vector<std::string> voltages(const iio_device* device, bool is_output) {
  std::vector<std::string> names;
  for (unsigned i = 0; i < iio_device_get_channels_count(device); ++i) {
    const iio_channel* channel = iio_device_get_channel(device, i);
    if (iio_channel_is_output(channel) == is_output && iio_channel_get_type(channel) == IIO_VOLTAGE &&
        (has_attribute(channel, "raw") || (!is_output && has_attribute(channel, "input"))))
      names.push_back(text_of(iio_channel_get_id(channel)));
  }
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

/// One channel: volts = (code + offset) * V_per_count.
struct Line {
  std::string key, description;
  iio_device* device = nullptr;
  const iio_channel* channel = nullptr;
  IioAttribute file;
  double V_per_count = 1.0, offset = 0.0, code = 0.0;
  double first = -std::numeric_limits<double>::infinity(), last = std::numeric_limits<double>::infinity();
  IioScan* scan = nullptr;
  std::size_t number_in_scan = 0;
  bool is_processed = false;  ///< the driver gives millivolts: `input` in the place of `raw`

  double volts() const noexcept { return (code + offset) * V_per_count; }
};

/// The codes at the converter's ends, where the kernel states them: of an input by its place in a scan.
void take_ends_of_converter(Line& line, const iio_channel* channel) {
  if (!iio_channel_is_scan_element(channel)) return;
  const iio_data_format* format = iio_channel_get_data_format(channel);
  if (format->bits == 0 || format->bits > 32) return;
  const double codes = std::exp2(format->bits);
  line.first = format->is_signed ? -codes / 2.0 : 0.0;
  line.last = format->is_signed ? codes / 2.0 - 1.0 : codes - 1.0;
}

/// Of an output by "[0 1 65535]", first, step and last.
void take_range_of_output(Line& line, const iio_channel* channel) {
  std::array<char, 256> text{};
  if (!has_attribute(channel, "raw_available") ||
      iio_channel_attr_read(channel, "raw_available", text.data(), text.size() - 1) <= 0)
    return;
  std::string_view rest(text.data());
  if (!rest.starts_with('[')) return;
  std::array<double, 3> numbers{};
  for (double& each : numbers) {
    rest.remove_prefix(std::min(rest.find_first_of("-.0123456789"), rest.size()));
    const std::optional<double> number = iio_number(rest);
    if (!number) return;
    each = *number;
    rest.remove_prefix(std::min(rest.find(' '), rest.size()));
  }
  if (!(numbers.front() < numbers.back())) return;
  line.first = numbers.front();
  line.last = numbers.back();
}

}  // namespace

struct IioBoard::Devices {
  Context context{iio_create_local_context()};
  std::string folder;
  bool shared = false;
  std::map<std::string, int> locks;  ///< an open folder of each device
  std::vector<Line> inputs, outputs;
  std::vector<std::unique_ptr<IioScan>> scans;
  std::vector<std::int64_t> ahead;  ///< scans of each device beyond the last tick
  std::int64_t at_ns = 0, tick_ns = 0, period_ns = 0;
  double reading_s = 0.0;
  bool is_cycling = false, is_awaited = false, has_scan = false, was_full = false;

  ~Devices() {
    scans.clear();
    for (const auto& [name, file] : locks) close(file);
  }

  [[noreturn]] static void fail(const std::string& key, const std::string& device, const std::string& what) {
    throw std::runtime_error(fmt::format("{}: hal.channels.{}: {}", device, key, what));
  }

  iio_device* find(const std::string& key, const std::string& wanted) const {
    std::vector<iio_device*> found;
    std::vector<std::string> known;
    for (unsigned i = 0; context && i < iio_context_get_devices_count(context.get()); ++i) {
      iio_device* device = iio_context_get_device(context.get(), i);
      if (iio_device_is_trigger(device)) continue;
      known.push_back(name_of(device));
      for (const char* name : {iio_device_get_name(device), iio_device_get_label(device), iio_device_get_id(device)})
        if (wanted == text_of(name)) {
          found.push_back(device);
          break;
        }
    }
    if (found.size() == 1) return found.front();
    if (found.empty())
      fail(key + ".device", wanted,
           fmt::format("found the devices {}, expected this one: load its driver (dmesg, iio_info)", listed(known)));
    std::vector<std::string> same;
    for (const iio_device* device : found) same.push_back(text_of(iio_device_get_id(device)));
    fail(key + ".device", wanted,
         fmt::format("found {} devices of this name ({}), expected one: name it by its label or number", found.size(),
                     listed(same)));
  }

  void lock(const iio_device* device) {
    const std::string id = text_of(iio_device_get_id(device));
    if (shared || locks.contains(id)) return;
    const int opened = open((folder + id).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (opened < 0) throw std::runtime_error(fmt::format("{}: {}", name_of(device), std::strerror(errno)));
    locks[id] = opened;
    lock_device(opened, name_of(device));
  }

  const iio_channel* channel_of(const std::string& key, const iio_device* device, const std::string& wanted,
                                bool is_output) const {
    const iio_channel* channel = iio_device_find_channel(device, wanted.c_str(), is_output);
    const std::vector<std::string> known = voltages(device, is_output);
    if (channel != nullptr && std::ranges::find(known, text_of(iio_channel_get_id(channel))) != known.end())
      return channel;
    const char* what = is_output ? "output" : "input";
    fail(key + ".channel", name_of(device),
         fmt::format("found no {} of volts '{}', expected one of: {}", what, wanted, listed(known)));
  }

  double scale_of(const std::string& key, const iio_device* device, const iio_channel* channel, double stated) const {
    double mV = 0.0;
    const bool has_scale = iio_channel_attr_read_double(channel, "scale", &mV) >= 0;
    if (has_scale && stated != 0.0)
      fail(key + ".V_per_count", name_of(device),
           fmt::format("found {:g} beside the driver's own scale of {:g} V, expected one of both: leave it out", stated,
                       mV / mV_of_V));
    if (!has_scale && stated == 0.0)
      fail(key + ".V_per_count", name_of(device),
           fmt::format("found a driver that states no scale of {}, expected the volts of one count from its data sheet",
                       text_of(iio_channel_get_id(channel))));
    if (has_scale && (mV == 0.0 || !std::isfinite(mV)))
      fail(key, name_of(device),
           fmt::format("found a scale of {:g} that the driver states for {}, expected the volts of a count: set the "
                       "channel's range, or take another channel",
                       mV, text_of(iio_channel_get_id(channel))));
    return has_scale ? mV / mV_of_V : stated;
  }

  IioAttribute open_file(const std::string& key, const iio_device* device, const iio_channel* channel,
                         const char* attribute, bool is_output) const {
    const char* file = iio_channel_attr_get_filename(channel, attribute);
    try {
      return IioAttribute(folder + text_of(iio_device_get_id(device)) + "/" + text_of(file), is_output);
    } catch (const std::system_error& error) {
      fail(key, name_of(device),
           fmt::format("found {}: {}, expected a file that this user may {}: see docs/iio.md on the udev rule",
                       text_of(file), error.code().message(), is_output ? "write" : "read"));
    }
  }

  std::size_t add(const std::string& key, const IioPlace& place, bool is_output) {
    iio_device* device = find(key, place.device);
    lock(device);
    const iio_channel* channel = channel_of(key, device, place.channel, is_output);
    auto& lines = is_output ? outputs : inputs;
    if (const auto other = std::ranges::find(lines, channel, &Line::channel); other != lines.end())
      fail(
          key + ".channel", name_of(device),
          fmt::format("found {}, which hal.channels.{} has, expected a channel of its own", place.channel, other->key));
    const bool is_processed = !has_attribute(channel, "raw");
    if (is_processed && place.V_per_count != 0.0)
      fail(key + ".V_per_count", name_of(device),
           fmt::format("found {:g} beside a channel that the driver gives in millivolts, expected none: leave it out",
                       place.V_per_count));
    const char* attribute = is_processed ? "input" : "raw";
    Line line{.key = key,
              .description = "",
              .device = device,
              .channel = channel,
              .file = open_file(key, device, channel, attribute, is_output),
              .is_processed = is_processed};
    line.V_per_count = is_processed ? 1.0 / mV_of_V : scale_of(key, device, channel, place.V_per_count);
    double offset = 0.0;
    if (!is_processed && iio_channel_attr_read_double(channel, "offset", &offset) >= 0) line.offset = offset;
    if (is_output) take_range_of_output(line, channel);
    else if (!is_processed) take_ends_of_converter(line, channel);
    line.description =
        fmt::format("{}: {} {} of {}, {:g} V a count, offset {:g}{}", key, is_output ? "output" : "input",
                    place.channel, name_of(device), line.V_per_count, line.offset, range_text(line));
    lines.push_back(std::move(line));
    return lines.size() - 1;
  }

  static std::string range_text(const Line& line) {
    if (!std::isfinite(line.first)) return "";
    const double a = (line.first + line.offset) * line.V_per_count, b = (line.last + line.offset) * line.V_per_count;
    return fmt::format(", {:g} to {:g} V", std::min(a, b), std::max(a, b));
  }

  const iio_device* find_trigger(const std::string& wanted) const {
    std::vector<std::string> known;
    for (unsigned i = 0; i < iio_context_get_devices_count(context.get()); ++i) {
      const iio_device* device = iio_context_get_device(context.get(), i);
      if (!iio_device_is_trigger(device)) continue;
      known.push_back(text_of(iio_device_get_name(device)));
      if (known.back() == wanted) return device;
    }
    throw std::runtime_error(fmt::format("hal.iio.trigger: found no trigger '{}', expected one of: {}; make it "
                                         "(docs/iio.md), or leave hal.iio.trigger out",
                                         wanted, listed(known)));
  }

  static void check_sampled(const Line& line) {
    const auto refuse = [&](const std::string& found) {
      fail(line.key, name_of(line.device),
           fmt::format("found an input {}, expected one that a trigger can sample: take another channel, or leave "
                       "hal.iio.trigger out",
                       found));
    };
    if (!iio_channel_is_scan_element(line.channel)) refuse("that is in no buffer");
    if (line.is_processed) refuse("in millivolts, whose scans have no stated scale");
    if (!is_one_number(line.channel)) refuse("of several numbers, or of more than 64 bits");
  }

  /// One buffer for each device that has inputs.
  void switch_on(const iio_device* trigger) {
    std::map<iio_device*, std::vector<const iio_channel*>> by_device;
    for (Line& line : inputs) {
      check_sampled(line);
      auto& channels = by_device[line.device];
      line.number_in_scan = channels.size();
      channels.push_back(line.channel);
    }
    for (auto& [device, channels] : by_device) {
      scans.push_back(std::make_unique<IioScan>(device, name_of(device), trigger, channels));
      for (Line& line : inputs)
        if (line.device == device) line.scan = scans.back().get();
    }
  }

  /// The scans that every device has given beyond the last tick; 0: one has none that is new.
  std::int64_t take_all() noexcept {
    for (std::size_t i = 0; i < scans.size(); ++i) {
      ahead[i] += scans[i]->take();
      if (!scans[i]->was_full()) continue;
      ahead[i] = 0;  // what was kept is old
      was_full = true;
    }
    const std::int64_t samples = *std::ranges::min_element(ahead);
    // One that is ahead by more has not lost what another one lost.
    for (std::int64_t& each : ahead) each = std::min<std::int64_t>(each - samples, 1);
    return samples;
  }

  /// Waits for a new scan of every device; how many it is then.
  std::int64_t await(std::int64_t timeout_ns) noexcept {
    if (!is_cycling) {
      take_all();
      std::ranges::fill(ahead, 0);  // what came before the loop began is of no tick
    }
    const std::int64_t end_ns = monotonic_ns() + timeout_ns;
    std::int64_t samples = take_all();
    while (samples == 0 && monotonic_ns() < end_ns) {
      for (std::size_t i = 0; i < scans.size(); ++i)
        if (ahead[i] == 0) scans[i]->wait(end_ns);
      samples = take_all();
    }
    is_awaited = true;
    keep_time(samples);
    return samples;
  }

  void keep_time(std::int64_t samples) noexcept {
    has_scan = samples > 0;
    if (!has_scan) return;
    at_ns = std::numeric_limits<std::int64_t>::max();
    for (const auto& scan : scans) at_ns = std::min(at_ns, scan->at_ns());
  }

  /// Of the trigger, from the last tick to this one; 0: no scan. Scans that were lost show in the kernel's stamps
  /// alone: without them the time is that of taking, which counts where a buffer was full.
  Pace pace(std::int64_t samples) noexcept {
    const bool is_timed = was_full || std::ranges::all_of(scans, [](const auto& scan) { return scan->is_stamped(); });
    const Pace now{samples > 0 && !is_cycling ? 1 : samples, samples > 0 ? at_ns : monotonic_ns()};
    const std::int64_t passed = (now.at_ns - tick_ns + period_ns / 2) / period_ns;
    const bool counts = samples > 0 && is_cycling && is_timed;
    tick_ns = now.at_ns;
    if (samples > 0) is_cycling = true, was_full = false;
    return {counts ? std::max(now.samples, passed) : now.samples, now.at_ns};
  }
};

IioBoard::IioBoard(bool shared, std::string folder) : devices_(std::make_unique<Devices>()) {
  devices_->shared = shared;
  devices_->folder = std::move(folder);
}
IioBoard::~IioBoard() = default;

std::size_t IioBoard::add_input(const std::string& key, const IioPlace& place) {
  return devices_->add(key, place, false);
}

std::size_t IioBoard::add_output(const std::string& key, const IioPlace& place) {
  return devices_->add(key, place, true);
}

// The loop's period is the trigger's.
void IioBoard::start_scans(const std::string& trigger, double period_s) {
  Devices& all = *devices_;
  all.switch_on(all.find_trigger(trigger));
  all.ahead.assign(all.scans.size(), 0);
  all.period_ns = std::llround(period_s * 1e9);
  std::int64_t first_ns = 0, count = -1;
  for (const std::int64_t end_ns = monotonic_ns() + 3 * timed_periods * all.period_ns + 500'000'000;
       count < timed_periods && monotonic_ns() < end_ns;) {
    const std::int64_t samples = all.await(all.period_ns);
    if (samples == 0) continue;
    if (count < 0) first_ns = all.at_ns;
    count += count < 0 ? 1 : samples;
    all.is_cycling = true;
  }
  all.is_cycling = false;
  const std::int64_t span_ns = all.at_ns - first_ns;
  if (count >= timed_periods && keeps_period(span_ns, count, period_s)) return;
  const double span_s = static_cast<double>(span_ns) * 1e-9;
  throw std::runtime_error(fmt::format(
      "{}: hal.iio.trigger: found {} by trigger '{}', expected one every {:g} s (period_s): set the trigger's "
      "sampling_frequency to {:g} (docs/iio.md)",
      all.scans.front()->name(),
      count > 0 ? fmt::format("a scan every {:.4g} s", span_s / static_cast<double>(count)) : "no scans", trigger,
      period_s, 1.0 / period_s));
}

void IioBoard::time_readings(double period_s) {
  if (devices_->inputs.empty()) return;
  for (const Line& line : devices_->inputs)
    if (!line.file.read())
      Devices::fail(line.key, name_of(line.device),
                    "found an input that the driver refuses to read, expected a number: end the program that has the "
                    "device's buffer, or write 0 to its buffer/enable where that program was killed");
  std::array<std::int64_t, timed_readings> each_ns{};
  for (std::int64_t& each : each_ns) {
    const std::int64_t begun_ns = monotonic_ns();
    read();
    each = monotonic_ns() - begun_ns;
  }
  std::ranges::nth_element(each_ns, each_ns.begin() + timed_readings / 2);
  devices_->reading_s = static_cast<double>(each_ns[timed_readings / 2]) * 1e-9;
  if (devices_->reading_s < period_s) return;
  throw std::runtime_error(fmt::format(
      "{}: found {:.3g} s for a reading of all inputs one by one, expected less than period_s ({:g}): sample them by a "
      "trigger (hal.iio.trigger), or take a longer period",
      name_of(devices_->inputs.front().device), devices_->reading_s, period_s));
}

Pace IioBoard::await_scan(std::int64_t timeout_ns) noexcept { return devices_->pace(devices_->await(timeout_ns)); }

bool IioBoard::read() noexcept {
  Devices& devices = *devices_;
  // Without a wait since the last reading, as after the end of a run, new is what has come since then.
  if (!devices.scans.empty() && !std::exchange(devices.is_awaited, false)) {
    std::ranges::fill(devices.ahead, 0);
    devices.keep_time(devices.take_all());
  }
  bool all = devices.scans.empty() || devices.has_scan;
  for (Line& line : devices_->inputs) {
    if (line.scan != nullptr) {
      line.code = line.scan->code(line.number_in_scan);
      continue;
    }
    const auto code = line.file.read();
    if (code) line.code = *code;
    all = all && code.has_value();
  }
  return all;
}

bool IioBoard::write() noexcept {
  bool all = true;
  for (const Line& line : devices_->outputs) all = line.file.write(static_cast<std::int64_t>(line.code)) && all;
  return all;
}

double IioBoard::volts(std::size_t input) const noexcept { return devices_->inputs[input].volts(); }

bool IioBoard::is_saturated(std::size_t input) const noexcept {
  const Line& line = devices_->inputs[input];
  return line.code <= line.first || line.code >= line.last;
}

double IioBoard::age_s() const noexcept {
  return devices_->scans.empty() ? 0.0 : static_cast<double>(monotonic_ns() - devices_->at_ns) * 1e-9;
}

void IioBoard::set_volts(std::size_t output, double volts) noexcept {
  Line& line = devices_->outputs[output];
  line.code = std::clamp(std::nearbyint(volts / line.V_per_count - line.offset), std::max(line.first, -largest_code),
                         std::min(line.last, largest_code));
}

double IioBoard::set_volts_of(std::size_t output) const noexcept { return devices_->outputs[output].volts(); }

std::vector<std::string> IioBoard::description() const {
  std::vector<std::string> text;
  for (const auto* lines : {&devices_->inputs, &devices_->outputs})
    for (const Line& line : *lines) text.push_back(line.description);
  for (const auto& scan : devices_->scans)
    text.push_back(fmt::format("{}: inputs by scans{}", scan->name(),
                               scan->is_stamped() ? ", stamped by the kernel" : " without a time stamp"));
  if (devices_->scans.empty() && !devices_->inputs.empty())
    text.push_back(fmt::format("{} inputs are read one by one, {:.0f} us for all", devices_->inputs.size(),
                               devices_->reading_s * 1e6));
  return text;
}

std::vector<std::string> iio_devices() {
  std::vector<std::string> lines, triggers;
  const Context context{iio_create_local_context()};
  for (unsigned i = 0; context && i < iio_context_get_devices_count(context.get()); ++i) {
    const iio_device* device = iio_context_get_device(context.get(), i);
    if (iio_device_is_trigger(device)) triggers.push_back(text_of(iio_device_get_name(device)));
    else
      lines.push_back(fmt::format("{}: inputs {}; outputs {}", name_of(device), listed(voltages(device, false)),
                                  listed(voltages(device, true))));
  }
  if (!triggers.empty()) lines.push_back("triggers " + listed(triggers));
  return lines;
}

}  // namespace pneuservo

#endif
