// Frames as the standards print them: CANopen, SDO, process data, serial text; and what is refused.
#include <catch2/catch.hpp>

#include <cmath>

#include "can/canopen.hpp"
#include "can/canopen_node.hpp"
#include "can/process_data.hpp"
#include "can/sdo_codec.hpp"
#include "can/sdo_server.hpp"
#include "can/slcan_codec.hpp"
#include "config/input_error.hpp"
#include "rig/injected_fault.hpp"

using namespace pneuservo;

namespace {

CanFrame bytes(std::uint32_t id, std::initializer_list<int> data) {
  CanFrame frame{.id = id, .length = static_cast<std::uint8_t>(data.size())};
  std::size_t i = 0;
  for (const int byte : data) frame.data[i++] = static_cast<std::uint8_t>(byte);
  return frame;
}

bool same(const CanFrame& a, const CanFrame& b) { return a.id == b.id && a.length == b.length && a.data == b.data; }

}  // namespace

TEST_CASE("CANopen frames have the identifiers and bytes of CiA 301") {
  REQUIRE(same(nmt_frame(NmtCommand::start, 5), bytes(0x000, {0x01, 0x05})));
  REQUIRE(same(sync_frame(), bytes(0x080, {})));
  REQUIRE(same(heartbeat_frame(5, NmtState::operational), bytes(0x705, {0x05})));
  REQUIRE(same(emergency_frame({5, 0x8130, 0x11}), bytes(0x085, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0})));
  REQUIRE(cob_transmit_pdo(1, 5) == 0x185);
  REQUIRE(cob_transmit_pdo(4, 5) == 0x485);
  REQUIRE(cob_receive_pdo(1, 5) == 0x205);
  REQUIRE(cob_receive_pdo(4, 5) == 0x505);
  const auto emergency = parse_emergency(bytes(0x085, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0}));
  REQUIRE((emergency && emergency->node == 5 && emergency->code == 0x8130 && emergency->error_register == 0x11));
  REQUIRE(parse_heartbeat(bytes(0x77F, {0x7F}))->state == NmtState::pre_operational);
}

TEST_CASE(
    "what is no such object is refused: SYNC as emergency, wrong lengths, unknown states, other kinds of frames") {
  REQUIRE_FALSE(parse_emergency(bytes(0x080, {0, 0, 0, 0, 0, 0, 0, 0})));
  REQUIRE_FALSE(parse_emergency(bytes(0x085, {0x30, 0x81})));
  REQUIRE_FALSE(parse_heartbeat(bytes(0x705, {0x05, 0x00})));
  REQUIRE_FALSE(parse_heartbeat(bytes(0x705, {0x06})));
  REQUIRE_FALSE(parse_heartbeat(bytes(0x700, {0x05})));
  REQUIRE_FALSE(parse_nmt(bytes(0x000, {0x03, 0x05})));
  REQUIRE_FALSE(parse_nmt(bytes(0x000, {0x01, 0x80})));
  CanFrame wide = bytes(0x705, {0x05});
  wide.extended = true;
  REQUIRE_FALSE(parse_heartbeat(wide));
}

TEST_CASE("process data: fields across bytes, two's complement, and insert undoes nothing else") {
  const std::array<std::uint8_t, 8> data{0x34, 0x12, 0xFF, 0x7F, 0x01, 0x80, 0xAB, 0xCD};
  const std::uint64_t image = image_of(data);
  REQUIRE(extract(image, {0, 16}) == 0x1234);
  REQUIRE(extract(image, {4, 8}) == 0x23);
  REQUIRE(extract(image, {16, 32}) == 0x80017FFF);
  REQUIRE(sign_extended(extract(image, {32, 16}), 16) == -32767);
  REQUIRE(sign_extended(0x80000000, 32) == -2147483648LL);
  REQUIRE(insert(image, {4, 8}, 0xFF) == ((image & ~0xFF0ull) | 0xFF0));
  REQUIRE(extract(image, {64, 8}) == 0);
  REQUIRE(insert(image, {64, 8}, 0xFF) == image);
  std::array<std::uint8_t, 8> back{};
  put_image(back, image);
  REQUIRE(back == data);
}

TEST_CASE("counts: every value of 16 bits comes back, ends hold, not-a-number is 0") {
  const CountScale volts{10.0 / 32768.0, 0.0, true, 16};
  for (int counts = -32768; counts <= 32767; ++counts)
    REQUIRE(volts.raw_of(volts.value_of(static_cast<std::uint64_t>(counts) & 0xFFFF)) ==
            (static_cast<std::uint64_t>(counts) & 0xFFFF));
  REQUIRE(volts.raw_of(1e9) == 0x7FFF);
  REQUIRE(volts.raw_of(-1e9) == 0x8000);
  REQUIRE(volts.raw_of(INFINITY) == 0x7FFF);
  REQUIRE(volts.raw_of(NAN) == 0);
  const CountScale gauge{25.0, 101325.0, false, 16};
  REQUIRE(gauge.value_of(1000) == 126325.0);
  REQUIRE(gauge.raw_of(0.0) == 0);
  const CountScale turned{-1e-6, 0.0, true, 32};
  REQUIRE(turned.value_of(turned.raw_of(0.123456)) == Approx(0.123456).epsilon(1e-12));
}

TEST_CASE("counts that begin again: each value of the limits comes back, and no value is undefined") {
  const double lowest_m = -0.2, highest_m = 0.2;
  // No power of two; as many as the field's bits; a direction turned round.
  for (const CountScale& counts : {CountScale{5e-6, 0.0, true, 32}.wrapped(100000, lowest_m, highest_m),
                                   CountScale{5e-6, 0.1, true, 19}.wrapped(524288, lowest_m, highest_m),
                                   CountScale{-5e-6, 0.0, false, 32}.wrapped(33554432, lowest_m, highest_m)}) {
    CAPTURE(counts.wrap_counts);
    for (double value_m = lowest_m; value_m <= highest_m; value_m += 1e-3) {
      const std::uint64_t raw = counts.raw_of(value_m);
      REQUIRE(static_cast<double>(raw) < counts.wrap_counts);
      REQUIRE(counts.value_of(raw) == Approx(value_m).margin(2.6e-6));  // half a count
    }
    CHECK(counts.raw_of(NAN) == counts.raw_of(0.0));
    const CountScale without{counts.scale, counts.zero, counts.is_signed, counts.bits};
    for (const double value : {1.0, -1.0}) {
      CHECK(counts.raw_of(value * INFINITY) == without.raw_of(value * INFINITY));
      CHECK(static_cast<double>(counts.raw_of(value * 1e300)) < counts.wrap_counts);
    }
  }
}

TEST_CASE("SDO: the bytes of expedited transfers and aborts") {
  // Upload of 0x1000:0, and its answer with 4 bytes: CiA 301's own example form.
  REQUIRE(same(sdo_frame(0x605, sdo_upload << 5, 0x1000, 0, 0), bytes(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0})));
  ObjectDictionary dictionary;
  dictionary.add_number(0x1000, 0, 32, 0x000F0191, false);
  dictionary.add_number(0x1017, 0, 16, 0, true);
  dictionary.add_text(0x1008, "an analog device");
  SdoServer server(5, dictionary, {});
  REQUIRE(same(*server.answer(bytes(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0})),
               bytes(0x585, {0x43, 0x00, 0x10, 0, 0x91, 0x01, 0x0F, 0x00})));
  REQUIRE(same(*server.answer(bytes(0x605, {0x2B, 0x17, 0x10, 0, 0xE8, 0x03, 0, 0})),
               bytes(0x585, {0x60, 0x17, 0x10, 0, 0, 0, 0, 0})));
  REQUIRE(dictionary.number(0x1017, 0) == 1000);
  const auto refused = [&](const CanFrame& request, SdoAbort code) {
    const auto answer = server.answer(request);
    return answer && answer->data[0] == 0x80 && get_u32(&answer->data[4]) == static_cast<std::uint32_t>(code);
  };
  REQUIRE(refused(bytes(0x605, {0x40, 0x00, 0x20, 0, 0, 0, 0, 0}), SdoAbort::no_object));
  REQUIRE(refused(bytes(0x605, {0x40, 0x17, 0x10, 9, 0, 0, 0, 0}), SdoAbort::no_sub_index));
  REQUIRE(refused(bytes(0x605, {0x23, 0x00, 0x10, 0, 1, 2, 3, 4}), SdoAbort::read_only));
  REQUIRE(refused(bytes(0x605, {0x23, 0x17, 0x10, 0, 1, 2, 3, 4}), SdoAbort::length));
  REQUIRE(refused(bytes(0x605, {0xE0, 0, 0, 0, 0, 0, 0, 0}), SdoAbort::command));
  REQUIRE(refused(bytes(0x605, {0x60, 0, 0, 0, 0, 0, 0, 0}), SdoAbort::command));  // a segment of nothing
  REQUIRE_FALSE(server.answer(bytes(0x605, {0x80, 0, 0, 0, 0, 0, 0, 0})));
  REQUIRE_FALSE(server.answer(bytes(0x605, {0x40, 0x00, 0x10})));
}

TEST_CASE("SDO: a text comes in segments with alternating toggle bits, a wrong one ends it") {
  ObjectDictionary dictionary;
  dictionary.add_text(0x1008, "an analog device");
  SdoServer server(5, dictionary, {});
  REQUIRE(same(*server.answer(bytes(0x605, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0})),
               bytes(0x585, {0x41, 0x08, 0x10, 0, 16, 0, 0, 0})));
  REQUIRE(same(*server.answer(bytes(0x605, {0x60, 0, 0, 0, 0, 0, 0, 0})),
               bytes(0x585, {0x00, 'a', 'n', ' ', 'a', 'n', 'a', 'l'})));
  REQUIRE(same(*server.answer(bytes(0x605, {0x70, 0, 0, 0, 0, 0, 0, 0})),
               bytes(0x585, {0x10, 'o', 'g', ' ', 'd', 'e', 'v', 'i'})));
  REQUIRE(
      same(*server.answer(bytes(0x605, {0x60, 0, 0, 0, 0, 0, 0, 0})), bytes(0x585, {0x0B, 'c', 'e', 0, 0, 0, 0, 0})));
  server.answer(bytes(0x605, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0}));
  const auto wrong = server.answer(bytes(0x605, {0x70, 0, 0, 0, 0, 0, 0, 0}));
  REQUIRE((wrong->data[0] == 0x80 && get_u32(&wrong->data[4]) == static_cast<std::uint32_t>(SdoAbort::toggle)));
}

TEST_CASE("a device takes a new mapping only in the order that CiA 301 asks for") {
  CanopenNode node({5, 401, "io"});
  node.dictionary().add(0x6401, 1, {.bits = 16, .can_write = false, .can_map = true});
  node.dictionary().add(0x6411, 1, {.bits = 16, .can_map = true});
  std::vector<CanFrame> out;
  node.power_on(0, out);
  REQUIRE(same(out.at(0), bytes(0x705, {0x00})));
  const auto write = [&](std::uint16_t index, std::uint8_t sub, std::uint32_t value, int size) {
    out.clear();
    CanFrame frame = sdo_frame(0x605, static_cast<std::uint8_t>(0x23 | (4 - size) << 2), index, sub, value);
    node.on_frame(frame, 0, out);
    return out.at(0).data[0] == 0x60 ? SdoAbort::none : static_cast<SdoAbort>(get_u32(&out.at(0).data[4]));
  };
  REQUIRE(write(0x1A01, 1, 0x64010110, 4) == SdoAbort::none);
  REQUIRE(write(0x1A01, 0, 1, 1) == SdoAbort::none);
  REQUIRE(write(0x1A01, 1, 0x64010110, 4) == SdoAbort::state);       // entries first to 0
  REQUIRE(write(0x1A01, 0, 0, 1) == SdoAbort::none);
  REQUIRE(write(0x1A01, 1, 0x64010210, 4) == SdoAbort::no_object);
  REQUIRE(write(0x1A01, 1, 0x64010120, 4) == SdoAbort::not_mappable);  // 32 bits of 16
  REQUIRE(write(0x1601, 1, 0x64010110, 4) == SdoAbort::not_mappable);  // an input cannot be received
  REQUIRE(write(0x1A01, 1, 0x64010110, 4) == SdoAbort::none);
  REQUIRE(write(0x1A01, 0, 1, 1) == SdoAbort::none);
  REQUIRE(write(0x1801, 2, 1, 1) == SdoAbort::none);
  REQUIRE(write(0x1801, 1, 0x285, 4) == SdoAbort::none);
  REQUIRE(write(0x1A01, 0, 0, 1) == SdoAbort::state);  // the PDO is on
  node.dictionary().set_number(0x6401, 1, 0x1234);
  out.clear();
  node.answer_sync(out);
  REQUIRE(out.empty());  // not operational yet
  node.on_frame(nmt_frame(NmtCommand::start, 0), 0, out);
  node.answer_sync(out);
  REQUIRE(same(out.at(0), bytes(0x285, {0x34, 0x12})));
}

TEST_CASE("a device that loses its master gives the substitute output, tells it, and leaves operational") {
  CanopenNode node({5, 401, "io"});
  node.add_output({0x64110110}, substitute_of({0x64110110}, {}));
  node.map(false, 2, {{0x64110110}}, 255);
  const bool substitutes = GENERATE(true, false);
  std::vector<CanFrame> out;
  node.power_on(0, out);
  node.dictionary().set_number(0x6443, 1, substitutes ? 1 : 0);
  node.dictionary().set_number(0x6444, 1, 0xFFFFFFF0);
  node.dictionary().set_number(0x1016, 1, 126u << 16 | 50);
  node.on_frame(nmt_frame(NmtCommand::start, 5), 0, out);
  node.on_frame(bytes(0x305, {0x00, 0x40}), 0, out);
  REQUIRE(node.dictionary().number(0x6411, 1) == 0x4000);
  out.clear();
  node.on_time(10'000'000'000, out);  // the watch begins with the first heartbeat
  REQUIRE(out.empty());
  node.on_frame(heartbeat_frame(126, NmtState::operational), 10'000'000'000, out);
  node.on_time(10'050'000'000, out);
  REQUIRE(out.empty());
  REQUIRE(node.state() == NmtState::operational);
  node.on_time(10'050'000'001, out);
  REQUIRE(out.size() == 1);
  REQUIRE(parse_emergency(out[0])->code == 0x8130);
  REQUIRE(node.state() == NmtState::pre_operational);
  REQUIRE(node.dictionary().number(0x6411, 1) == (substitutes ? 0xFFF0u : 0x4000u));  // 0x6443 = 0: the last one stays
}

TEST_CASE("serial text: frames both ways, states of the adapter, rubbish") {
  CanFrame frame = bytes(0x181, {0xAA, 0xBB});
  REQUIRE(slcan_text(frame).view() == "t1812AABB\r");
  REQUIRE(same(*slcan_frame("t1812AABB"), frame));
  REQUIRE(same(*slcan_frame("t1812aabb01F4"), frame));  // with the adapter's time stamp
  frame.extended = true;
  frame.id = 0x1ABCDEF0;
  REQUIRE(slcan_text(frame).view() == "T1ABCDEF02AABB\r");
  REQUIRE((slcan_frame("T1ABCDEF02AABB")->extended && slcan_frame("T1ABCDEF02AABB")->id == 0x1ABCDEF0));
  REQUIRE(slcan_frame("sb255000")->id == error_bus_off);
  REQUIRE(slcan_frame("sb255000")->error);
  REQUIRE(slcan_frame("e1a")->id == error_acknowledge);
  for (const char* rubbish :
       {"", "t", "t181", "t1819AABB", "t1812AAB", "t8012AABB", "tXYZ2AABB", "z", "V1013", "t1812AABBCCC"})
    REQUIRE_FALSE(slcan_frame(rubbish));
  SlcanLines lines;
  int whole = 0;
  for (const char c : std::string(500, 't') + "\rt1812AABB\r")
    if (const auto line = lines.add(c)) whole += *line == "t1812AABB" ? 1 : 100;
  REQUIRE(whole == 1);
}

TEST_CASE("fault orders") {
  const InjectedFault order = parse_fault_order("bias:p1_port:2e4@1.5+0.25", 0.0);
  REQUIRE((order.kind == InjectedKind::bias && order.target == "p1_port" && order.value == 2e4));
  REQUIRE((order.start_s == 1.5 && order.duration_s == 0.25));
  REQUIRE(parse_fault_order("emergency:io:0x3100", 7.0).value == 0x3100);
  REQUIRE(parse_fault_order("bus_off", 7.0).start_s == 7.0);
  for (const char* wrong : {"nonsense", "bias:x:abc", "freeze:x@-1", "freeze:x@1+abc", "bus_off:io"})
    REQUIRE_THROWS_AS(parse_fault_order(wrong, 0.0), InputError);
  for (const char* wrong : {"freeze", "freeze:y", "bias:x", "leak:3:1e-6", "off:io", "delay:x:2", "delay:x:-1"})
    REQUIRE_THROWS_AS(require_injectable(parse_fault_order(wrong, 0.0), InjectionPlace::sim, Rig{}, "here"),
                      InputError);
  for (const char* wrong : {"off:io", "delay:x:0.01"})
    REQUIRE_THROWS_AS(require_injectable(parse_fault_order(wrong, 0.0), InjectionPlace::device, Rig{}, "here"),
                      InputError);
  // What belongs to the controller, and what no counts can say.
  for (const char* wrong : {"nan:x", "emergency_stop"})
    REQUIRE_THROWS_WITH(require_injectable(parse_fault_order(wrong, 0.0), InjectionPlace::device, Rig{}, "here"),
                        Catch::Contains("expected it in run --hal sim"));
  REQUIRE_THROWS_WITH(require_injectable(parse_fault_order("nan:x", 0.0), InjectionPlace::device, Rig{}, "here"),
                      Catch::Contains("an integer, which cannot be a NaN"));
  REQUIRE_THROWS_WITH(
      require_injectable(parse_fault_order("late_tick:0.01", 0.0), InjectionPlace::device, Rig{}, "here"),
      Catch::Contains("expected it in run: the loop is late"));
}
