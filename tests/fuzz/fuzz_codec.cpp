// Any bytes as what comes from a bus or its files: frames at a node and at the controller's process image, text of a
// serial adapter, EDS files. Nothing valid lies outside its limits, and what is encoded decodes to the same.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include "can/canopen_node.hpp"
#include "can/eds.hpp"
#include "can/fluid_valve.hpp"
#include "can/process_image.hpp"
#include "can/slcan_codec.hpp"
#include "config/input_error.hpp"

using namespace pneuservo;

namespace {

/// Takes the input apart; zeros when it is used up.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool empty() const { return at_ >= size_; }
  std::uint8_t next() { return empty() ? 0 : data_[at_++]; }
  CanFrame frame() {
    CanFrame frame;
    const std::uint8_t flags = next();
    frame.extended = (flags & 0x80) != 0;
    frame.remote = (flags & 0x40) != 0;
    frame.error = (flags & 0x30) == 0x30;
    frame.length = flags & 0x0F;
    frame.id = static_cast<std::uint32_t>(next()) | static_cast<std::uint32_t>(next()) << 8;
    if (!frame.extended) frame.id &= 0x7FF;
    for (auto& byte : frame.data) byte = next();
    return frame;
  }
  std::string rest() const { return {reinterpret_cast<const char*>(data_ + at_), size_ - at_}; }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

/// A device of the kind that `device` shows, with analog inputs, an output and the objects behind it, and a valve's
/// states.
void frames_at_a_node(Bytes& bytes) {
  CanopenNode node({.node = 2, .device_type = 401, .name = "fuzzed"});
  ValveStates valve(node);
  for (std::uint8_t sub = 1; sub <= 4; ++sub)
    node.dictionary().add(0x6401, sub, {.bits = 16, .can_write = false, .can_map = true});
  node.dictionary().add(0x6411, 1, {.bits = 16, .can_map = true});
  std::vector<CanFrame> out;
  std::int64_t now_ns = 0;
  node.power_on(now_ns, out);
  valve.power_on();
  while (!bytes.empty()) {
    out.clear();
    const CanFrame frame = bytes.frame();
    now_ns += 1'000'000;
    if (frame.id == 0x080) {
      node.act_on_sync();
      node.answer_sync(out);
    } else {
      node.on_frame(frame, now_ns, out);
    }
    node.on_time(now_ns, out);
    const bool is_active = node.state() == NmtState::operational && (valve.status() & valve_active) != 0;
    if (valve.follows_set_point() && !is_active) std::abort();
    for (const CanFrame& sent : out)
      if (sent.length > 8 || sent.id > 0x7FF) std::abort();
  }
}

void frames_at_the_controller(Bytes& bytes) {
  CanInputPdo pressures{.id = 0x282, .length = 8, .oldest_ns = 2'000'000, .signals = {}};
  for (unsigned i = 0; i < 3; ++i)
    pressures.signals.push_back({.signal = channel_signals[i],
                                 .place = {.offset = 16 * i, .bits = 16},
                                 .counts = {.scale = 25.0},
                                 .lowest = 5e4,
                                 .highest = 8.1e5});
  CanProcessImage image({pressures}, {}, {{"io", 2, 100'000'000}});
  std::int64_t now_ns = 0;
  image.start(now_ns);
  while (!bytes.empty()) {
    image.begin_cycle(now_ns += 1'000'000, {});
    for (int n = bytes.next() % 4; n > 0; --n) image.on_frame({bytes.frame(), now_ns + bytes.next() * 1000});
    Measurement measurement;
    image.take(now_ns + 1'000'000, measurement);
    for (const Channel& channel : measurement.channel.all)
      if (channel.valid && !(channel.value >= 5e4 && channel.value <= 8.1e5)) std::abort();
  }
  (void)image.event_lines(0);
}

void text_of_an_adapter(Bytes& bytes) {
  SlcanLines lines;
  while (!bytes.empty()) {
    const auto line = lines.add(static_cast<char>(bytes.next()));
    const auto frame = line ? slcan_frame(*line) : std::nullopt;
    if (!frame || frame->error) continue;
    if (frame->length > 8) std::abort();
    const SlcanText written = slcan_text(*frame);
    const auto again = slcan_frame(written.view().substr(0, written.length - 1));
    if (!again || again->id != frame->id || again->length != frame->length || again->extended != frame->extended ||
        std::memcmp(again->data.data(), frame->data.data(), frame->length) != 0)
      std::abort();
  }
}

void device_file(const Bytes& bytes) {
  try {
    const EdsFile file = EdsFile::parse(bytes.rest(), "fuzz.eds");
    for (const EdsObject& object : file.objects())
      if (file.find(object.index, object.sub) == nullptr || object.bits() > 64) std::abort();
    for (const EdsObject& object : file.configured(5))
      if (!eds_bytes(object, object.configured, 5).why.empty()) std::abort();
    (void)file.left_out(5);
  } catch (const InputError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  switch (bytes.next() % 4) {
    case 0: frames_at_a_node(bytes); break;
    case 1: frames_at_the_controller(bytes); break;
    case 2: text_of_an_adapter(bytes); break;
    default: device_file(bytes);
  }
  return 0;
}
