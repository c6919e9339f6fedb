// Frames of a broken or hostile node: random ones and damaged real ones, at controller and device. Nothing crashes or
// hangs, no channel is ever valid outside its limits, the output stays within its range.
#include <catch2/catch.hpp>

#include <cstdlib>
#include <memory>
#include <random>

#include "can/can_backend.hpp"
#include "can/eds.hpp"
#include "can/slcan_codec.hpp"
#include "config/input_error.hpp"
#include "core/test_seed.hpp"
#include "hal/can_bench.hpp"

using namespace pneuservo;

namespace {

unsigned stated_seed() { return test::stated_seed().value_or(20261122u); }

/// 10 million in full length.
int frames_to_try() { return std::getenv("PNEUSERVO_LONG") != nullptr ? 10'000'000 : 200'000; }

class FrameMaker {
 public:
  explicit FrameMaker(unsigned seed) : random_(seed) {}
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(random_() % n); }

  /// Anything, mostly with an identifier that somebody listens to.
  CanFrame any() {
    static constexpr std::uint32_t listened[]{0x000, 0x080, 0x082, 0x083, 0x084, 0x182, 0x183, 0x184,
                                              0x204, 0x282, 0x302, 0x582, 0x583, 0x584, 0x602, 0x603,
                                              0x604, 0x702, 0x703, 0x704, 0x77E, 0x7E5};
    CanFrame frame;
    frame.id = below(8) == 0 ? below(0x20000000) : listened[below(std::size(listened))];
    frame.extended = frame.id > 0x7FF || below(50) == 0;
    frame.remote = below(50) == 0;
    frame.error = below(200) == 0;
    frame.length = static_cast<std::uint8_t>(below(30) == 0 ? below(256) : below(9));
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(below(4) == 0 ? 0xFF * below(2) : below(256));
    if ((frame.id & 0x780) == 0x600 && below(2) == 0) request(frame);
    return frame;
  }
  /// An SDO request that means something, to an object that is there.
  void request(CanFrame& frame) {
    static constexpr std::uint8_t first[]{0x40, 0x22, 0x23, 0x2B, 0x2F, 0x21, 0x20, 0x60, 0x70, 0x00, 0x10, 0x01, 0x80};
    static constexpr std::uint16_t index[]{0x1000, 0x1008, 0x1016, 0x1017, 0x1029, 0x1401, 0x1601, 0x1800, 0x1801,
                                           0x1A00, 0x1A01, 0x6401, 0x6411, 0x6443, 0x6444, 0x6020, 0x6040, 0x6041,
                                           0x6042, 0x604F, 0x6131, 0x6132, 0x6300, 0x6314, 0x9130};
    frame.length = 8;
    frame.data[0] = first[below(std::size(first))];
    put_u16(&frame.data[1], index[below(std::size(index))]);
    frame.data[3] = static_cast<std::uint8_t>(below(4));
  }
  CanFrame damaged(CanFrame frame) {
    switch (below(4)) {
      case 0: frame.data[below(8)] ^= static_cast<std::uint8_t>(1u << below(8)); break;
      case 1: frame.length = static_cast<std::uint8_t>(below(9)); break;
      case 2: frame.id ^= 1u << below(11); break;
      default:
        for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(below(256));
    }
    return frame;
  }

 private:
  std::mt19937_64 random_;
};

/// The analog module of CiA 401, or transmitters of CiA 404 and a valve of CiA 408.
Rig drawn_rig() {
  const bool has_profiles = GENERATE(false, true);
  CAPTURE(has_profiles);
  return can_rig(has_profiles ? profile_sets() : std::vector<std::string>{});
}

}  // namespace

TEST_CASE("hostile frames at the controller: no valid channel outside its limits", "[long]") {
  const unsigned seed = stated_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  FrameMaker make(seed);
  const Rig rig = drawn_rig();
  PlantDevice device(rig);
  auto owned = std::make_unique<DeviceBus>(device);
  DeviceBus& bus = *owned;
  CanBackend backend(rig, std::move(owned));
  backend.configure();
  const auto spoil = [&](CanFrame& frame) {
    if (make.below(3) == 0) frame = make.damaged(frame);
    return make.below(10) != 0;
  };
  // What was latched is forgotten from time to time: all ways stay open.
  const auto start_anew = [&] {
    bus.spoil = {};
    for (ReceivedFrame received; bus.receive(received);) {}
    backend.activate();
    bus.spoil = spoil;
  };
  start_anew();
  PerSignal<double> lowest{}, highest{};
  rig.hal->channels.for_each_input([&](Signal signal, const auto& channel) {
    if (!channel.can) return;
    lowest[signal] = channel.can->lowest;
    highest[signal] = channel.can->highest;
  });
  std::int64_t valid = 0, invalid = 0;
  const int frames = frames_to_try();
  for (int given = 0, tick = 0; given < frames; ++tick) {
    if (tick % 20 == 19) start_anew();
    for (std::uint32_t i = 0, n = make.below(400); i < n; ++i, ++given) bus.inject(make.any());
    Measurement m;
    backend.read(tick, m);
    for (const Signal signal : channel_signals) {
      const Channel& channel = m.channel[signal];
      if (!channel.valid) {
        ++invalid;
        continue;
      }
      ++valid;
      const bool within = channel.value >= lowest[signal] && channel.value <= highest[signal];
      if (!within) FAIL(info(signal).name << " is valid with " << channel.value);
    }
    backend.write(tick, {make.below(2) == 0 ? 1e9 : std::nan("")});
    if (std::fabs(device.command_V()) > 5.0) FAIL("the output is " << device.command_V() << " V");
    bus.advance(1'000'000);
    bus.sent.clear();
  }
  REQUIRE(valid > frames / 10000);  // hostile frames mostly stop the backend before a sample comes
  REQUIRE(invalid > frames / 2000);
}

TEST_CASE("hostile frames at the device: it answers or is silent, and what it sends are frames", "[long]") {
  const unsigned seed = stated_seed() + 1;
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  FrameMaker make(seed);
  PlantDevice device(drawn_rig());
  std::vector<CanFrame> out;
  device.power_on(0, out);
  std::int64_t now = 0, answers = 0;
  const int frames = frames_to_try() / 10;
  for (int i = 0; i < frames; ++i) {
    now += make.below(100'000);
    out.clear();
    device.on_frame({make.any(), now}, out);
    device.on_time(now, out);
    answers += static_cast<std::int64_t>(out.size());
    for (const CanFrame& frame : out)
      if (!is_plain(frame)) FAIL("no frame: id " << frame.id << " length " << int(frame.length));
    REQUIRE(std::isfinite(device.truth().x_m));
  }
  REQUIRE(answers > frames / 50);  // most frames are for nobody
}

TEST_CASE("random text on a serial line gives frames or nothing") {
  const unsigned seed = stated_seed() + 2;
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  FrameMaker make(seed);
  SlcanLines lines;
  const std::string alphabet = "trTRsezbap0123456789ABCDEFxyz\r\r\a\xff";
  int frames = 0;
  for (int i = 0; i < 400'000; ++i) {
    const auto line = lines.add(alphabet[make.below(static_cast<std::uint32_t>(alphabet.size()))]);
    if (!line) continue;
    const auto frame = slcan_frame(*line);
    if (!frame) continue;
    ++frames;
    if (!frame->error && !frame->extended) REQUIRE(frame->id <= 0x7FF);
    REQUIRE(frame->length <= 8);
  }
  REQUIRE(frames > 100);
  for (int i = 0; i < 20'000; ++i) {  // and every frame comes back from its text
    CanFrame frame = make.any();
    if (frame.error || frame.length > 8) continue;
    if (!frame.extended) frame.id &= 0x7FF;
    std::string text(slcan_text(frame).view());
    text.pop_back();
    const auto back = slcan_frame(text);
    REQUIRE(back);
    REQUIRE((back->id == frame.id && back->length == frame.length && back->extended == frame.extended));
    for (int b = 0; b < (frame.remote ? 0 : frame.length); ++b)
      REQUIRE(back->data[static_cast<std::size_t>(b)] == frame.data[static_cast<std::size_t>(b)]);
  }
}

TEST_CASE("a damaged EDS file reads or is refused with its line") {
  const unsigned seed = stated_seed() + 3;
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  FrameMaker make(seed);
  const std::string text =
      "[FileInfo]\nFileName=io.eds\n[1000]\nParameterName=Device type\nObjectType=0x7\nDataType=0x0007\n"
      "AccessType=ro\nDefaultValue=0x000F0191\nPDOMapping=0\n[1800sub1]\nParameterName=COB-ID\n"
      "DataType=0x0007\nAccessType=rw\nDefaultValue=$NODEID+0x180\nPDOMapping=0\n[6401sub1]\n"
      "ParameterName=Input 1\nDataType=0x0003\nAccessType=ro\nPDOMapping=1\nParameterValue=-5\n";
  int read = 0, refused = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string wrong = text;
    for (std::uint32_t k = 0, n = 1 + make.below(4); k < n; ++k) {
      const std::uint32_t place = make.below(static_cast<std::uint32_t>(wrong.size()));
      if (make.below(3) == 0) wrong.erase(place, 1 + make.below(8));
      else wrong[place] = static_cast<char>(make.below(256));
      if (wrong.empty()) break;
    }
    try {
      (void)EdsFile::parse(wrong, "io.eds");
      ++read;
    } catch (const InputError& error) {
      ++refused;
      REQUIRE(std::string(error.what()).starts_with("io.eds:"));
    }
  }
  REQUIRE(read > 100);
  REQUIRE(refused > 100);
}
