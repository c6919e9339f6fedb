// The axis as a CiA 402 drive: its state machine, its modes under a PLC's frames, its dictionary and EDS.
#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <pneuservo/loop/commanded_motion.hpp>
#include <pneuservo/loop/fault.hpp>

#include "can/eds.hpp"
#include "can/sdo_codec.hpp"
#include "core/test_seed.hpp"
#include "drive/drive_node.hpp"

using namespace pneuservo;

namespace {

constexpr double drive_period_s = 1e-3;
constexpr std::uint8_t node = 5;
constexpr std::array<std::uint16_t, 3> enabling{0x06, 0x07, 0x0F};

Rig drive_rig() {
  Rig rig;
  rig.name = "axis";
  rig.period_s = drive_period_s;
  rig.reference.kind = ReferenceKind::live;
  rig.reference.lowest_m = -0.12;
  rig.reference.highest_m = 0.12;
  rig.reference.speed_mps = 0.4;
  rig.reference.acceleration_mps2 = 3.0;
  rig.reference.smoothness = 11;
  rig.serve.emplace();
  rig.serve->drive.emplace();
  rig.serve->drive->node_id = node;
  return rig;
}

/// What the loop does with commands, with a slider that is where its set point is: one command a tick, answered in it.
class IdealAxis {
 public:
  explicit IdealAxis(const Rig& rig) { motion_.configure(live_limits(rig.reference), drive_period_s, 0.0); }
  void tick(std::vector<AxisCommand>& commands, std::vector<AxisAnswer>& answers) {
    ++tick_;
    motion_.pass(tick_, true);
    if (!commands.empty()) {
      const AxisCommand command = commands.front();
      commands.erase(commands.begin());
      answers.push_back({command.number, obey(command), tick_, motion_.target_m(), motion_.end_tick()});
      if (command.kind == CommandKind::follow) followed.push_back(command);
    }
    if (faults != 0) enabled_ = false;
    motion_.advance(tick_);
  }
  AxisStatus status() const {
    AxisStatus status;
    status.tick = tick_;
    status.t_s = static_cast<double>(tick_) * drive_period_s;
    status.state = faults != 0 ? SupervisorState::fault
                   : enabled_  ? SupervisorState::active
                               : SupervisorState::inactive;
    status.enabled = enabled_;
    status.proven = true;
    status.faults = status.first_faults = faults;
    status.set_point = motion_.at(tick_).d[0];
    status.set_point_rate = status.v_mps = motion_.at(tick_).d[1];
    status.measured[Signal::x] = status.set_point - lag_m;
    status.target = motion_.target_m();
    status.end_tick = motion_.end_tick();
    status.is_late = motion_.is_late();
    return status;
  }

  std::uint64_t faults = 0;
  bool cause_stands = false, is_taken = false;
  double lag_m = 0.0;
  std::vector<AxisCommand> followed;

 private:
  CommandResult obey(const AxisCommand& command) {
    CommandResult result = CommandResult::taken;
    if (is_taken && command.kind != CommandKind::disable && command.kind != CommandKind::stop)
      return CommandResult::other_commander;
    switch (command.kind) {
      case CommandKind::enable:
        if (faults != 0) return CommandResult::in_fault;
        if (!enabled_) motion_.start(tick_, motion_.at(tick_).d[0]);
        enabled_ = true;
        return result;
      case CommandKind::disable: enabled_ = false; return result;
      case CommandKind::reset:
        if (!cause_stands) faults = 0;
        return result;
      default: break;
    }
    if (!enabled_) return CommandResult::not_enabled;
    const bool has_room = motion_.obey(command, tick_, result);
    REQUIRE(has_room);
    return result;
  }
  CommandedMotion motion_;
  std::int64_t tick_ = 0;
  bool enabled_ = false;
};

/// A PLC, the drive and the axis on one clock.
class DriveBench {
 public:
  explicit DriveBench(const Rig& rig = drive_rig()) : axis(rig), drive(rig) {
    drive.power_on(0, out);
    send(nmt_frame(NmtCommand::start, node));
    run(2);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      std::vector<AxisAnswer> answers;
      axis.tick(commands, answers);
      now_ns += 1'000'000;
      if (heartbeat_ns && now_ns % heartbeat_ns == 0) send(heartbeat_frame(127, NmtState::operational));
      for (const AxisAnswer& answer : answers) drive.on_answer(answer, out);
      drive.on_status(axis.status(), out);
      drive.on_time(now_ns, out);
      take();
    }
  }
  void send(const CanFrame& frame) {
    drive.on_frame(frame, now_ns, out);
    take();
  }
  void control(std::uint16_t word) {
    CanFrame frame{.id = 0x200u + node, .length = 3};
    put_u16(frame.data.data(), word);
    frame.data[2] = static_cast<std::uint8_t>(mode);
    send(frame);
  }
  void target(std::int32_t place_um, std::uint32_t speed_um = 400'000) {
    CanFrame frame{.id = 0x300u + node, .length = 8};
    put_u32(frame.data.data(), static_cast<std::uint32_t>(place_um));
    put_u32(frame.data.data() + 4, speed_um);
    send(frame);
  }
  std::uint32_t write(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned bytes) {
    const auto first = static_cast<std::uint8_t>(0x23 | (4 - bytes) << 2);
    out.clear();
    drive.on_frame(sdo_frame(0x600u + node, first, index, sub, value), now_ns, out);
    std::uint32_t abort = 0xFFFFFFFF;
    for (const CanFrame& frame : out)
      if (frame.id == 0x580u + node) abort = frame.data[0] == 0x80 ? get_u32(&frame.data[4]) : 0;
    take();
    return abort;
  }
  void enable(std::int8_t in_mode) {
    mode = in_mode;
    for (const std::uint16_t word : enabling) {
      control(word);
      run(3);
    }
    REQUIRE(drive.state() == DriveState::operation_enabled);
  }
  std::uint32_t value(std::uint16_t index, std::uint8_t sub = 0) const {
    return drive.node().dictionary().number(index, sub);
  }
  std::int32_t place(std::uint16_t index) const { return static_cast<std::int32_t>(value(index)); }
  bool bit(int number) const { return (value(0x6041) >> number & 1) != 0; }

  IdealAxis axis;
  DriveNode drive;
  std::vector<CanFrame> out, sent;
  std::vector<AxisCommand> commands;
  int released = 0, lost = 0;
  std::int8_t mode = 0;
  std::int64_t now_ns = 0, heartbeat_ns = 0;

 private:
  void take() {
    sent.insert(sent.end(), out.begin(), out.end());
    out.clear();
    for (const CommanderWord& word : drive.take_words()) {
      if (word.kind == CommanderWord::Kind::command) commands.push_back(word.command);
      released += word.kind == CommanderWord::Kind::release ? 1 : 0;
      lost += word.kind == CommanderWord::Kind::lost ? 1 : 0;
    }
  }
};

}  // namespace

TEST_CASE("a drive's states follow CiA 402, whatever controlwords come") {
  using S = DriveState;
  using C = DriveCommand;
  CHECK(command_of(0x0006) == C::shutdown);
  CHECK(command_of(0x0007) == C::switch_on);
  CHECK(command_of(0x001F) == C::enable_operation);
  CHECK(command_of(0x0002) == C::quick_stop);
  CHECK(command_of(0x000D) == C::disable_voltage);
  for (const S state : {S::not_ready_to_switch_on, S::fault, S::fault_reaction_active})
    for (const C command : {C::disable_voltage, C::quick_stop, C::shutdown, C::switch_on, C::enable_operation})
      CHECK(commanded_state(state, command) == state);
  CHECK(commanded_state(S::switch_on_disabled, C::enable_operation) == S::switch_on_disabled);
  CHECK(commanded_state(S::switch_on_disabled, C::shutdown) == S::ready_to_switch_on);
  CHECK(commanded_state(S::operation_enabled, C::quick_stop) == S::quick_stop_active);
  CHECK(commanded_state(S::switched_on, C::quick_stop) == S::switch_on_disabled);
  // Random words: the axis is enabled in operation enabled alone, and in no other way than by its edge.
  const auto seed = test::new_seed();
  CAPTURE(seed);
  std::mt19937_64 random(seed);
  DriveBench bench;
  for (int i = 0; i < 20'000; ++i) {
    bench.mode = static_cast<std::int8_t>(random() % 10);
    if (random() % 3 == 0) bench.control(static_cast<std::uint16_t>(random()));
    else bench.control(std::array<std::uint16_t, 5>{0x06, 0x07, 0x0F, 0x1F, 0x80}[random() % 5]);
    if (random() % 4 == 0) bench.target(static_cast<std::int32_t>(random()), static_cast<std::uint32_t>(random()));
    if (random() % 500 == 0) bench.axis.faults = fault_deviation;
    bench.run(static_cast<int>(random() % 12));
    const bool may = bench.drive.state() == S::operation_enabled || bench.drive.state() == S::quick_stop_active;
    if (bench.commands.empty()) REQUIRE((bench.axis.status().enabled ? may || bench.value(0x6040) % 16 == 15 : true));
    REQUIRE(std::fabs(bench.axis.status().set_point) <= 0.12 + 1e-9);
  }
}

TEST_CASE("profile position: the handshake, a waiting set point, one at once, limits, halt") {
  DriveBench bench;
  CHECK(bench.drive.state() == DriveState::switch_on_disabled);
  bench.enable(1);
  bench.target(50'000);
  bench.control(0x1F);
  bench.run(2);
  CHECK(bench.bit(12));
  CHECK_FALSE(bench.bit(10));
  bench.control(0x0F);
  bench.target(-30'000);
  bench.control(0x1F);  // waits for the first
  CHECK(bench.bit(12));
  bench.control(0x0F);
  bench.run(1);
  CHECK(bench.bit(12));  // no room for a third until then
  int furthest = 0;
  for (int i = 0; i < 3000; ++i) {
    bench.run(1);
    furthest = std::max(furthest, bench.place(0x6062));
  }
  CHECK(furthest == 50'000);
  CHECK(bench.place(0x6064) == -30'000);
  CHECK(bench.bit(10));
  CHECK_FALSE(bench.bit(12));
  bench.target(0, 100'000);
  bench.control(0x1F);
  bench.run(300);
  bench.control(0x0F);
  bench.target(-300'000, 900'000);  // beyond place and speed: held to both, and said
  bench.control(0x3F);              // at once
  bench.run(3000);
  CHECK(bench.place(0x6064) == -120'000);
  CHECK(bench.bit(11));
  bench.control(0x0F);
  bench.target(40'000, 100'000);
  bench.control(0x5F);  // relative
  bench.run(300);
  CHECK_FALSE(bench.bit(11));
  bench.control(0x10F);  // halt
  bench.run(1000);
  CHECK(bench.bit(10));
  CHECK(bench.place(0x606B) == 0);
  CHECK(bench.place(0x6064) < -90'000);
  bench.control(0x0F);
  bench.run(3000);
  CHECK(bench.place(0x6064) == -80'000);
  CHECK(bench.bit(10));
}

TEST_CASE("cyclic position: 10 000 set points on SYNC are followed in order and on time") {
  DriveBench bench;
  bench.enable(8);
  bench.send(nmt_frame(NmtCommand::enter_pre_operational, node));
  CHECK(bench.lost == 1);  // the master left while the axis was enabled
  CHECK(bench.write(0x1401, 1, 0x80000300u + node, 4) == 0);
  CHECK(bench.write(0x1401, 2, 1, 1) == 0);
  CHECK(bench.write(0x1401, 1, 0x300u + node, 4) == 0);
  CHECK(bench.write(0x60C2, 1, 4, 1) == 0);
  bench.send(nmt_frame(NmtCommand::start, node));
  std::vector<std::int32_t> sent;
  double worst_m = 0.0;
  for (int i = 1; i <= 10'000; ++i) {
    sent.push_back(static_cast<std::int32_t>(std::lround(80'000 * std::sin(0.004 * i) * std::min(1.0, i / 2000.0))));
    bench.target(sent.back());
    bench.send(sync_frame());
    bench.run(4);
    const int delay =
        static_cast<int>(std::lround(SetPointStream::peak(6) * 0.4 / 3.0 * 6.0 / drive_period_s / 2.0 / 4.0));
    if (i > 3000)
      worst_m = std::max(
          worst_m, std::fabs(bench.axis.status().set_point - 1e-6 * sent[static_cast<std::size_t>(i - 1 - delay)]));
    REQUIRE(bench.bit(12));
    REQUIRE_FALSE(bench.bit(11));
  }
  CHECK(worst_m < 2e-3);  // a set point's way, and what the averages round off
  REQUIRE(bench.axis.followed.size() == sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    REQUIRE(std::lround(1e6 * bench.axis.followed[i].target) == sent[i]);
    REQUIRE(bench.axis.followed[i].interval_s == Approx(0.004));
  }
  bench.run(1000);  // the stream has ended: at rest where it did
  CHECK(bench.place(0x6064) == sent.back());
  CHECK(bench.place(0x606C) == 0);
  bench.target(2'000'000);
  bench.send(sync_frame());
  bench.run(100);
  CHECK(bench.bit(11));
  bench.run(3000);
  CHECK(bench.place(0x6064) == 120'000);
}

TEST_CASE("quick stop and disabling end as their option codes say") {
  for (const int code : {0, 1, 2, 5, 6}) {
    DriveBench bench;
    bench.enable(1);
    CHECK(bench.write(0x605A, 0, static_cast<std::uint32_t>(code), 2) == 0);
    bench.target(100'000, 200'000);
    bench.control(0x1F);
    bench.run(300);
    bench.control(0x02);
    bench.run(3);
    CHECK(bench.drive.state() == (code == 0 ? DriveState::switch_on_disabled : DriveState::quick_stop_active));
    CHECK(bench.axis.status().enabled == (code != 0));
    bench.run(1500);
    CHECK(bench.axis.status().enabled == (code >= 5));
    CHECK(bench.drive.state() == (code >= 5 ? DriveState::quick_stop_active : DriveState::switch_on_disabled));
    if (code < 5) continue;
    CHECK(bench.place(0x606B) == 0);
    bench.control(0x0F);
    bench.run(3);
    CHECK(bench.drive.state() == DriveState::operation_enabled);
  }
  DriveBench bench;  // disable operation: at rest first, by its default
  bench.enable(1);
  bench.target(100'000, 200'000);
  bench.control(0x1F);
  bench.run(300);
  bench.control(0x07);
  bench.run(3);
  CHECK(bench.axis.status().enabled);
  bench.run(1500);
  CHECK_FALSE(bench.axis.status().enabled);
  CHECK(bench.drive.state() == DriveState::switched_on);
  CHECK(bench.place(0x606B) == 0);
}

TEST_CASE("a fault of the axis is a fault of the drive until its edge of bit 7, and while its cause stands") {
  DriveBench bench;
  bench.enable(1);
  bench.axis.faults = fault_stall;
  bench.axis.cause_stands = true;
  bench.run(2);
  CHECK(bench.drive.state() == DriveState::fault);
  CHECK(bench.value(0x603F) == 0x7121);
  CHECK(bench.value(0x2000, 2) == (fault_stall >> 32));
  CHECK((bench.value(0x6041) & 0x4F) == 0x08);
  CHECK(bench.released == 1);
  bench.control(0x80);
  bench.run(5);
  CHECK(bench.drive.state() == DriveState::fault);
  bench.axis.cause_stands = false;
  bench.run(5);
  CHECK(bench.drive.state() == DriveState::fault);
  bench.control(0x00);
  bench.control(0x80);
  bench.run(5);
  CHECK(bench.drive.state() == DriveState::switch_on_disabled);
  CHECK(bench.value(0x603F) == 0);
  std::vector<std::uint16_t> codes;
  for (const CanFrame& frame : bench.sent)
    if (const auto emergency = parse_emergency(frame)) codes.push_back(emergency->code);
  CHECK(codes == std::vector<std::uint16_t>{0x7121, 0});
  bench.enable(1);
}

TEST_CASE("another commander keeps the drive out, and no old edge enables it later") {
  DriveBench bench;
  bench.axis.is_taken = true;
  bench.mode = 1;
  for (const std::uint16_t word : enabling) {
    bench.control(word);
    bench.run(3);
  }
  CHECK(bench.drive.state() == DriveState::switched_on);
  CHECK(bench.value(0x603F) == 0xFF01);
  bench.axis.is_taken = false;
  bench.control(0x0F);
  bench.run(100);
  CHECK(bench.drive.state() == DriveState::switched_on);
  bench.control(0x07);
  bench.control(0x0F);
  bench.run(3);
  CHECK(bench.drive.state() == DriveState::operation_enabled);
}

TEST_CASE("a master that falls silent: by the option code, and else as any commander that is lost") {
  for (const int code : {-1, 0, 1, 2, 3}) {
    DriveBench bench;
    bench.heartbeat_ns = 20'000'000;
    CHECK(bench.write(0x1016, 1, 127u << 16 | 50u, 4) == 0);
    CHECK(bench.write(0x6007, 0, static_cast<std::uint16_t>(code), 2) == 0);
    bench.run(100);
    bench.enable(1);
    bench.target(100'000, 100'000);
    bench.control(0x1F);
    bench.run(300);
    bench.heartbeat_ns = 0;
    bench.run(60);
    CHECK(bench.lost == (code == -1 ? 1 : 0));
    if (code == 1) CHECK(bench.drive.state() == DriveState::fault);
    if (code == 1) CHECK(bench.value(0x603F) == 0x8130);
    if (code == 2) CHECK(bench.drive.state() == DriveState::switch_on_disabled);
    if (code == 3) CHECK(bench.drive.state() == DriveState::quick_stop_active);
    bench.run(3000);
    CHECK(bench.axis.status().enabled == (code <= 0));
    if (code == 3) CHECK(bench.drive.state() == DriveState::switch_on_disabled);
    if (code == 0) CHECK(bench.place(0x6064) == 100'000);
    CHECK(bench.place(0x606B) == 0);
    if (code != 1) continue;
    bench.send(nmt_frame(NmtCommand::start, node));
    bench.control(0x00);
    bench.control(0x80);
    bench.run(3);
    CHECK(bench.drive.state() == DriveState::switch_on_disabled);
  }
  Rig rig = drive_rig();
  rig.serve->commander_silent_s = 0.2;
  DriveBench bench(rig);
  bench.enable(1);
  bench.run(150);
  CHECK(bench.lost == 0);
  bench.run(100);
  CHECK(bench.lost == 1);
}

TEST_CASE("what a drive does not have is refused, and windows are judged") {
  DriveBench bench;
  CHECK(bench.write(0x6060, 0, 3, 1) == 0x06090030);
  CHECK(bench.write(0x6083, 0, 1'000'000, 4) == 0x06090032);
  CHECK(bench.write(0x6083, 0, 5'000'000, 4) == 0);
  CHECK(bench.write(0x6081, 0, 0, 4) == 0x06090032);
  CHECK(bench.write(0x6098, 0, 17, 1) == 0x06090030);
  CHECK(bench.write(0x6064, 0, 0, 4) == 0x06010002);
  CHECK(bench.write(0x60FF, 0, 0, 4) == 0x06020000);
  bench.enable(1);
  CHECK(bench.write(0x6065, 0, 500, 4) == 0);
  CHECK(bench.write(0x6066, 0, 20, 2) == 0);
  bench.axis.lag_m = 0.001;
  bench.run(15);
  CHECK(bench.place(0x60F4) == 1000);
  CHECK_FALSE(bench.bit(13));
  bench.run(15);
  CHECK(bench.bit(13));
  bench.axis.lag_m = 0.0001;
  bench.run(2);
  CHECK_FALSE(bench.bit(13));
  CHECK(bench.write(0x6067, 0, 50, 4) == 0);
  bench.target(10'000);
  bench.control(0x1F);
  bench.run(3000);
  CHECK_FALSE(bench.bit(10));  // 100 um short of the target
  bench.axis.lag_m = 0.00004;
  bench.run(2);
  CHECK(bench.bit(10));
}

TEST_CASE(
    "homing of an axis that knows its place is attained at once, and the zero of the bus moves where it is asked to") {
  DriveBench bench;
  bench.enable(1);
  bench.target(30'000);
  bench.control(0x1F);
  bench.run(2000);
  bench.mode = 6;
  bench.control(0x0F);
  CHECK(bench.bit(12));
  CHECK(bench.write(0x6098, 0, 37, 1) == 0);
  CHECK(bench.write(0x607C, 0, 5'000, 4) == 0);
  bench.control(0x1F);
  bench.run(2);
  CHECK(bench.bit(12));
  CHECK(bench.place(0x6064) == 5'000);
  CHECK(static_cast<std::int32_t>(bench.value(0x607D, 2)) == 95'000);
  bench.mode = 1;
  bench.control(0x0F);
  bench.target(-1'000);
  bench.control(0x1F);
  bench.run(2000);
  CHECK(bench.place(0x6064) == -1'000);
  CHECK(bench.axis.status().set_point == Approx(0.024));
}

TEST_CASE("the EDS of the drive says what its dictionary has") {
  const Rig rig = drive_rig();
  const EdsFile eds = EdsFile::parse(drive_eds(rig), "axis.eds");
  DriveNode drive(rig);
  std::size_t entries = 0;
  drive.node().dictionary().each([&](std::uint16_t index, std::uint8_t sub, const DictionaryEntry& entry) {
    ++entries;
    INFO(std::hex << index << " sub " << int(sub));
    const EdsObject* object = eds.find(index, sub);
    REQUIRE(object != nullptr);
    CHECK_FALSE(object->name.empty());
    CHECK(object->can_write == entry.can_write);
    CHECK(object->can_map == entry.can_map);
    if (entry.is_text) return;
    CHECK(object->bits() == entry.bits);
    CHECK(object->is_signed() == entry.is_signed);
    std::uint32_t value = 0;
    const EdsBytes standard = eds_bytes(*object, object->standard, node);
    for (std::size_t i = standard.bytes.size(); i-- > 0;) value = value << 8 | standard.bytes[i];
    CHECK(standard.why.empty());
    CHECK(value == entry.value);
  });
  CHECK(entries > 150);
}
