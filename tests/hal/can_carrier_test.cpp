// What carries frames: a local socket between two ends, a serial line with an adapter played by a pseudo-terminal, and
// words for what is missing. EDS files.
#include <catch2/catch.hpp>

#include <array>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include "can/bus_lock.hpp"
#include "can/canopen.hpp"
#include "can/eds.hpp"
#include "can/local_bus.hpp"
#include "can/open_carrier.hpp"
#include "can/slcan_line.hpp"
#include "config/input_error.hpp"
#include "core/test_seed.hpp"
#include "record/files.hpp"

using namespace pneuservo;

namespace {

/// The master's side of a pseudo-terminal: the adapter.
struct Adapter {
  int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  Adapter() {
    grantpt(master);
    unlockpt(master);
  }
  ~Adapter() { close(master); }
  Adapter(const Adapter&) = delete;
  Adapter& operator=(const Adapter&) = delete;
  std::string device() const { return ptsname(master); }
  std::string heard() const {
    char text[4096];
    const ssize_t got = read(master, text, sizeof text);
    return got > 0 ? std::string(text, static_cast<std::size_t>(got)) : "";
  }
  void say(const std::string& text) const {
    REQUIRE(write(master, text.data(), text.size()) == static_cast<ssize_t>(text.size()));
  }
};

bool receive_within(CanCarrier& bus, ReceivedFrame& received) {
  for (int i = 0; i < 200; ++i) {
    if (bus.receive(received)) return true;
    bus.wait(10'000'000);
  }
  return false;
}

}  // namespace

TEST_CASE("a local socket carries frames both ways with time stamps, and tells when the other end goes") {
  const TemporaryFolder folder;
  const std::string path = folder.file("bus");
  REQUIRE_THROWS_WITH(LocalBus(path, LocalBus::Side::connects), Catch::Contains("nobody listens there"));
  put_plain(path, "not ours");
  REQUIRE_THROWS_WITH(LocalBus(path, LocalBus::Side::listens), Catch::Contains("something else than a socket"));
  REQUIRE(bytes_of(path) == "not ours");
  std::filesystem::remove(path);
  LocalBus device(path, LocalBus::Side::listens);
  REQUIRE_FALSE(device.is_up());
  REQUIRE(device.send(sync_frame()) == Sent::down);
  REQUIRE_THROWS_WITH(LocalBus(path, LocalBus::Side::listens), Catch::Contains("somebody listens there already"));
  {
    LocalBus controller(path, LocalBus::Side::connects);
    ReceivedFrame received;
    const std::int64_t before = controller.now_ns();
    REQUIRE(controller.send(nmt_frame(NmtCommand::start, 5)) == Sent::sent);
    while (!device.receive(received)) device.wait(10'000'000);
    REQUIRE(parse_nmt(received.frame)->node == 5);
    REQUIRE(received.received_ns >= before);
    REQUIRE(received.received_ns <= device.now_ns());
    REQUIRE(device.send(heartbeat_frame(6, NmtState::operational)) == Sent::sent);
    REQUIRE(device.send(heartbeat_frame(5, NmtState::operational)) == Sent::sent);
    REQUIRE(device.send({.id = error_bus_off, .length = 8, .error = true}) == Sent::sent);
    REQUIRE(receive_within(controller, received));
    REQUIRE(parse_heartbeat(received.frame)->node == 6);  // foreign ones are given too: who receives counts them
    REQUIRE(receive_within(controller, received));
    REQUIRE(parse_heartbeat(received.frame)->node == 5);
    REQUIRE(receive_within(controller, received));
    REQUIRE((received.frame.error && received.frame.id == error_bus_off));
    int queued = 0;
    while (queued < 100'000 && device.send(sync_frame()) == Sent::sent) ++queued;
    REQUIRE(queued < 100'000);
    REQUIRE(device.send(sync_frame()) == Sent::queue_full);  // never blocks, never goes down for it
    REQUIRE(device.is_up());
  }
  ReceivedFrame received;
  for (int looks = 0; looks < 2; ++looks)  // the first only finds that its last batch was not full
    while (device.receive(received)) {}
  REQUIRE_FALSE(device.is_up());
}

TEST_CASE("a serial adapter is opened at its bit rate, and frames pass as its text") {
  Adapter adapter;
  {
    SlcanLine line(adapter.device(), 500e3);
    REQUIRE(adapter.heard() == "\rC\rS6\rO\r");
    REQUIRE(line.send({.id = 0x302, .length = 2, .data = {0x12, 0xAB}}) == Sent::sent);
    REQUIRE(adapter.heard() == "t302212AB\r");
    adapter.say("z\rt18220001\rt183");
    ReceivedFrame received;
    REQUIRE(receive_within(line, received));
    REQUIRE(received.frame.id == 0x182);
    REQUIRE_FALSE(line.receive(received));
    adapter.say("400000001\rsb255000\r");
    REQUIRE(receive_within(line, received));
    REQUIRE((received.frame.id == 0x183 && received.frame.length == 4 && received.frame.data[3] == 1));
    REQUIRE(receive_within(line, received));
    REQUIRE((received.frame.error && received.frame.id == error_bus_off));
    // Nobody reads: the line fills, a frame is taken whole or not at all.
    int taken = 0;
    while (taken < 100'000 && line.send({.id = 0x302, .length = 8}) == Sent::sent) ++taken;
    REQUIRE(taken < 100'000);
    std::string text;
    for (std::string more = adapter.heard(); !more.empty(); more = adapter.heard()) text += more;
    line.send({.id = 0x302, .length = 8});
    for (std::string more = adapter.heard(); !more.empty(); more = adapter.heard()) text += more;
    const std::string one = "t30280000000000000000\r";
    REQUIRE(text.size() % one.size() == 0);
    for (std::size_t i = 0; i < text.size(); i += one.size()) REQUIRE(text.compare(i, one.size(), one) == 0);
  }
  REQUIRE(adapter.heard() == "C\r");
  REQUIRE_THROWS_WITH(SlcanLine(adapter.device(), 123456), Catch::Contains("expected 10000, 20000"));
  REQUIRE_THROWS_WITH(SlcanLine("/nonexistent", 1e6), Catch::Contains("cannot be opened"));
}

TEST_CASE("a serial line full of anything but frames takes one reading a call") {
  Adapter adapter;
  SlcanLine line(adapter.device(), 1e6);
  std::string noise(3000, 'x');
  for (std::size_t i = 9; i < noise.size(); i += 10) noise[i] = '\r';
  adapter.say(noise);
  adapter.say("t7051"
              "05\r");
  ReceivedFrame received;
  int calls = 0;
  while (!line.receive(received) && calls < 1000) ++calls, line.wait(1'000'000);
  REQUIRE(received.frame.id == 0x705);
  REQUIRE(calls >= 3000 / 512);  // nothing but noise came in each of them
  REQUIRE(line.dropped() >= 290);
}

TEST_CASE("a serial line and a node of a bus have one controller, the other one is told who has it") {
  const std::string us = std::to_string(getpid());
  Adapter adapter;
  {
    SlcanLine line(adapter.device(), 1e6);
    REQUIRE_THROWS_WITH(SlcanLine(adapter.device(), 1e6), Catch::Contains("held by process " + us));
  }
  REQUIRE_NOTHROW(SlcanLine(adapter.device(), 1e6));
  const TemporaryFolder folder;
  CanBusParameters bus;
  bus.interface = "unix:" + folder.file("bus");
  bus.nodes["io"].node_id = 2;
  bus.nodes["encoder"].node_id = 3;
  CanBusParameters other = bus;
  other.interface = "unix:" + folder.file("./bus");
  other.nodes.erase("io");
  {
    const BusLock lock(bus);
    REQUIRE_THROWS_WITH(BusLock(other),
                        Catch::Contains("node encoder (3)") && Catch::Contains("held by process " + us));
    other.nodes["encoder"].node_id = 4;
    REQUIRE_NOTHROW(BusLock(other));
  }
  REQUIRE_NOTHROW(BusLock(bus));
}

TEST_CASE("a step of the wall clock makes no frame late") {
  const unsigned seed = test::stated_seed().value_or(20261128u);
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937_64 random(seed);
  ArrivalClock clock;
  std::int64_t distance_ns = 1'700'000'000'000'000'000, now_ns = 5'000'000'000;
  const auto draw = [&](std::int64_t n) { return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(n)); };
  for (int tick = 0; tick < 20'000; ++tick) {
    // Frames come within the period; the clock is set before, between or after them, by 2 ms to an hour.
    std::array<std::int64_t, 3> came{}, stamps{};
    const std::int64_t step_ns =
        tick > 0 && tick % 7 == 0 ? (random() % 2 ? 1 : -1) * (2'000'000 + draw(3'600'000'000'000)) : 0;
    const std::size_t step_before = random() % 4;
    for (std::size_t i = 0; i < came.size(); ++i) {
      if (i == step_before) distance_ns += step_ns;
      now_ns += 100'000 + draw(200'000);
      came[i] = now_ns;
      stamps[i] = now_ns + distance_ns;
    }
    if (step_before == came.size()) distance_ns += step_ns;
    now_ns += 100'000;
    clock.begin(now_ns);
    for (std::size_t i = 0; i < came.size(); ++i) {
      const std::int64_t at_ns = clock.arrival_ns(stamps[i], now_ns + distance_ns, now_ns);
      if (std::abs(at_ns - came[i]) > 1000) FAIL("tick " << tick << ": off by " << at_ns - came[i] << " ns");
    }
    clock.emptied();
  }
}

TEST_CASE("a local bus carries what one program sends to all the others, up to four") {
  const TemporaryFolder folder;
  const std::string path = folder.file("bus");
  LocalBus device(path, LocalBus::Side::listens);
  LocalBus first(path, LocalBus::Side::connects), second(path, LocalBus::Side::connects);
  for (int i = 0; i < 4; ++i) device.wait(1'000'000);
  REQUIRE(first.send(nmt_frame(NmtCommand::stop, 9)) == Sent::sent);
  ReceivedFrame received;
  REQUIRE(receive_within(device, received));
  REQUIRE(receive_within(second, received));
  REQUIRE(parse_nmt(received.frame)->node == 9);
  REQUIRE_FALSE(first.receive(received));  // not its own
  REQUIRE(device.send(sync_frame()) == Sent::sent);
  REQUIRE(receive_within(first, received));
  REQUIRE(receive_within(second, received));
}

TEST_CASE("an interface that is not there is named with its remedy") {
  REQUIRE_THROWS_WITH(open_carrier("nocan77", 1e6, false),
                      Catch::Contains("nocan77: no such interface") || Catch::Contains("this kernel has no CAN"));
}

TEST_CASE("EDS and DCF: types, mapping, values with the node's number, mistakes by line") {
  const EdsFile eds =
      EdsFile::parse("; a comment\n[DeviceInfo]\nVendorName=Somebody\n[1000]\nParameterName=Device type\n"
                     "DefaultValue=0x000F0191\nDataType=0x0007\nAccessType=ro\n[1800sub1]\nDataType=0x0007\n"
                     "AccessType=rw\nDefaultValue=$NODEID+0x180\n[6401Sub1]\nDataType=0x0003\nAccessType=ro\n"
                     "PDOMapping=1\n[6423]\nDataType=0x0001\nAccessType=rw\nParameterValue=1\n"
                     "[1014]\nDataType=7\nAccessType=rw\nParameterValue=0x80+$NODEID\n[1A00sub1]\n"
                     "DataType=7\nAccessType=rw\nParameterValue=0x64010110\n[1008]\nDataType=0x0009\n"
                     "DefaultValue=A name\n",
                     "io.dcf");
  const auto standard = [&](std::uint16_t index, std::uint8_t sub) {
    const EdsObject& object = *eds.find(index, sub);
    return eds_bytes(object, object.standard, 9).bytes;
  };
  using Bytes = std::vector<std::uint8_t>;
  REQUIRE(standard(0x1000, 0) == Bytes{0x91, 0x01, 0x0F, 0x00});
  REQUIRE(standard(0x1800, 1) == Bytes{0x89, 0x01, 0x00, 0x00});
  const EdsObject& input = *eds.find(0x6401, 1);
  REQUIRE((input.bits() == 16 && input.is_signed() && input.can_map && !input.can_write));
  REQUIRE(eds.find(0x1008, 0)->bits() == 0);
  REQUIRE(eds.find(0x6401, 2) == nullptr);
  const auto configured = eds.configured(9);  // not the mapping: that follows from the config
  REQUIRE(configured.size() == 2);
  REQUIRE((configured[0].index == 0x1014 &&
           eds_bytes(configured[0], configured[0].configured, 9).bytes == Bytes{0x89, 0, 0, 0}));
  REQUIRE((configured[1].index == 0x6423 && eds_bytes(configured[1], configured[1].configured, 9).bytes == Bytes{1}));
  REQUIRE_THROWS_WITH(EdsFile::parse("[1000\n", "a.eds"), Catch::Contains("a.eds:1: found '[' without ']'"));
  REQUIRE_THROWS_WITH(EdsFile::parse("Key=1\n", "a.eds"), Catch::Contains("a.eds:1"));
  REQUIRE_THROWS_WITH(EdsFile::parse("[FileInfo]\n", "a.eds"), Catch::Contains("no objects"));
  REQUIRE_THROWS_AS(EdsFile::read("/nonexistent.eds"), InputError);
}

TEST_CASE("EDS as found: comments, arrays in one section, defaults that nobody uses, text outside the form") {
  const EdsFile eds = EdsFile::parse(
      "\xEF\xBB\xBFwritten by hand\n[DeviceInfo]\nVendorNumber=0x1F ; "
      "ours\nProductNumber=7\n[DeviceComissioning]\nNodeID=5\n"
      "a line of text\n[6020]; four of them\nDataType=0x0004 ; INTEGER32\nAccessType=ro\nPDOMapping=1 ; yes\n"
      "CompactSubObj=4\n[6020Name]\nNrOfEntries=1\n2=second\n[2001]\nDataType=0x0007\nDefaultValue=0.0\n"
      "[2002]\nDataType=\nDefaultValue=TRUE\n",
      "a.eds");
  REQUIRE((eds.vendor == 0x1F && eds.product == 7 && eds.node == 5));
  for (const std::uint8_t sub : {1, 2, 3, 4}) {
    const EdsObject* one = eds.find(0x6020, sub);
    REQUIRE(one != nullptr);
    REQUIRE((one->bits() == 32 && one->is_signed() && one->can_map));
  }
  REQUIRE(eds.find(0x6020, 2)->name == "second");
  REQUIRE((eds.find(0x6020, 0)->standard == "4" && !eds.find(0x6020, 0)->can_map));
  REQUIRE(eds.find(0x6020, 5) == nullptr);
  REQUIRE_THROWS_WITH(EdsFile::parse("<?xml version=\"1.0\"?>\n", "a.xdd"), Catch::Contains("XML, an XDD"));
}

TEST_CASE("a DCF's values become the bytes of their type, or are named as left out") {
  const auto bytes = [](unsigned type, const std::string& text) {
    EdsObject object;
    object.data_type = static_cast<std::uint16_t>(type);
    return eds_bytes(object, text, 3).bytes;
  };
  using Bytes = std::vector<std::uint8_t>;
  CHECK(bytes(0x08, "1.5") == Bytes{0x00, 0x00, 0xC0, 0x3F});
  CHECK(bytes(0x08, "2") == Bytes{0x00, 0x00, 0x00, 0x40});
  CHECK(bytes(0x11, "-1") == Bytes{0, 0, 0, 0, 0, 0, 0xF0, 0xBF});
  CHECK(bytes(0x03, "-0x80") == Bytes{0x80, 0xFF});
  CHECK(bytes(0x03, "0xFF80") == Bytes{0x80, 0xFF});
  CHECK(bytes(0x02, "-128") == Bytes{0x80});
  CHECK(bytes(0x05, "01h") == Bytes{0x01});
  CHECK(bytes(0x05, "08") == Bytes{0x08});
  CHECK(bytes(0x05, "010") == Bytes{0x08});  // octal
  CHECK(bytes(0x01, "TRUE") == Bytes{0x01});
  CHECK(bytes(0x1B, "0xFFFFFFFFFFFFFFFF") == Bytes(8, 0xFF));
  CHECK(bytes(0x07, "$NODEID+0x80") == Bytes{0x83, 0, 0, 0});
  CHECK(bytes(0x09, "a;b") == Bytes{'a', ';', 'b'});
  CHECK(bytes(0x0A, "01 A0") == Bytes{0x01, 0xA0});
  for (const auto& [type, text] :
       {std::pair{0x05u, "0x1FF"}, {0x05u, "-1"}, {0x02u, "-129"}, {0x08u, "abc"}, {0x0Fu, "x"}})
    CHECK(bytes(type, text).empty());
  const EdsFile dcf = EdsFile::parse(
      "[2103]\nDataType=6\nAccessType=rw\nCompactSubObj=2\n[2103Value]\nNrOfEntries=2\n1=17\n2=0x12345\n"
      "[1010sub1]\nDataType=7\nAccessType=rw\nParameterValue=0x65766173\n[2104]\nDataType=5\nAccessType=wo\n"
      "ParameterValue=3\n",
      "a.dcf");
  const auto written = dcf.configured(3);
  REQUIRE(written.size() == 2);
  CHECK((written[0].index == 0x2103 && written[0].sub == 1 && written[1].index == 0x2104 && !written[1].can_read));
  const auto left = dcf.left_out(3);
  REQUIRE(left.size() == 2);
  CHECK((left[0].index == 0x1010 && left[1].index == 0x2103 && left[1].sub == 2));
}
