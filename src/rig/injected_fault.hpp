// Faults injected on purpose, into the simulated plant or the simulated device: "freeze:x@2.5+0.1" or a scenario file.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/core/field.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

enum class InjectedKind {
  drop,
  freeze,
  bias,
  spike,
  spikes,
  saturate,
  delay,
  not_a_number,
  encoder_jump,
  stuck_valve,
  leak,
  supply_loss,
  late_tick,
  late_share,
  suspend,
  emergency_stop,
  bus_off,
  guard_lost,
  emergency,
  off,
  reboot,
  no_heartbeat,
  late,
  doubled,
  deaf,
  pre_operational,
  payload,
  dry_friction,
  jam,
  obstacle,
  reversed_valve,
  reversed_encoder,
  exchanged_hoses,
  exchanged_ports
};

/// What a kind acts on.
enum class InjectedTarget { none, channel, side, node };

/// Where a kind can be injected: into the run's own backend sim, into the verb device, or both.
struct InjectedKindText {
  std::string_view name;
  InjectedTarget sim, device;  ///< target there
  bool in_sim, in_device, needs_value;
  std::string_view meaning;
  std::string_view instead_of_device = "it in run --hal sim";  ///< where to inject it, and why
};
inline constexpr std::array<InjectedKindText, 34> injected_kinds{{
    {"drop", InjectedTarget::channel, InjectedTarget::node, true, true, false,
     "no sample comes, with VALUE: of this share of them; a node: no answer"},
    {"freeze", InjectedTarget::channel, InjectedTarget::channel, true, true, false, "repeats one value"},
    {"bias", InjectedTarget::channel, InjectedTarget::channel, true, true, true, "adds VALUE"},
    {"spike", InjectedTarget::channel, InjectedTarget::channel, true, true, true, "adds VALUE to one sample"},
    {"spikes", InjectedTarget::channel, InjectedTarget::channel, true, true, true, "adds VALUE to one sample of three"},
    {"saturate", InjectedTarget::channel, InjectedTarget::channel, true, true, false,
     "shows VALUE; without it the end of its counts, sim: far out of range"},
    {"delay", InjectedTarget::channel, InjectedTarget::channel, true, true, true,
     "samples are VALUE seconds old, 1 at most; a device tells no age"},
    {"nan", InjectedTarget::channel, InjectedTarget::none, true, false, false, "is not a number",
     "it in run --hal sim: an object in a PDO is an integer, which cannot be a NaN"},
    {"encoder_jump", InjectedTarget::none, InjectedTarget::none, true, true, true, "adds VALUE to the position"},
    {"stuck_valve", InjectedTarget::none, InjectedTarget::none, true, true, false,
     "the valve stays at its command; with VALUE: at that command"},
    {"leak", InjectedTarget::side, InjectedTarget::side, true, true, true,
     "the side's chamber leaks through an area of VALUE m2"},
    {"supply_loss", InjectedTarget::none, InjectedTarget::none, true, true, true, "the supply falls to VALUE Pa"},
    {"late_tick", InjectedTarget::none, InjectedTarget::none, true, false, true, "the loop comes VALUE seconds late",
     "it in run: the loop is late, not its devices"},
    {"late_share", InjectedTarget::none, InjectedTarget::none, true, false, true,
     "the loop misses the share VALUE of its slots, five in a row", "it in run: the loop is late, not its devices"},
    {"suspend", InjectedTarget::none, InjectedTarget::none, true, false, true,
     "the machine was suspended for VALUE seconds, which no tick shows", "it in run: its machine sleeps"},
    {"emergency_stop", InjectedTarget::none, InjectedTarget::none, true, false, false, "the emergency stop is pressed"},
    {"bus_off", InjectedTarget::none, InjectedTarget::none, true, true, false,
     "the CAN controller goes bus-off: nothing comes, nothing goes"},
    {"guard_lost", InjectedTarget::none, InjectedTarget::none, true, false, false,
     "pneuservo guard gives no sign of life any more", "it in run: the guard stands beside the loop"},
    {"emergency", InjectedTarget::node, InjectedTarget::node, false, true, false,
     "sends an emergency (VALUE: its code, 0x5000 unless stated)"},
    {"off", InjectedTarget::node, InjectedTarget::node, false, true, false,
     "loses its supply; back with a boot-up after its time"},
    {"reboot", InjectedTarget::node, InjectedTarget::node, false, true, false, "restarts"},
    {"no_heartbeat", InjectedTarget::node, InjectedTarget::node, false, true, false, "stops its heartbeat"},
    {"late", InjectedTarget::node, InjectedTarget::node, false, true, false, "answers SYNC a period late"},
    {"double", InjectedTarget::node, InjectedTarget::node, false, true, false,
     "answers SYNC twice, as two devices with one number do"},
    {"deaf", InjectedTarget::node, InjectedTarget::node, false, true, false,
     "takes no commands any more: process data to it are lost"},
    {"pre_operational", InjectedTarget::node, InjectedTarget::node, false, true, false,
     "another master puts it into pre-operational"},
    {"payload", InjectedTarget::none, InjectedTarget::none, true, true, true, "the slider carries VALUE kg more"},
    {"dry_friction", InjectedTarget::none, InjectedTarget::none, true, true, true,
     "VALUE N more rub at any speed and at rest"},
    {"jam", InjectedTarget::none, InjectedTarget::none, true, true, true, "VALUE N s/m more brake the slider"},
    {"obstacle", InjectedTarget::none, InjectedTarget::none, true, true, true,
     "hard stops at +-VALUE m, from when the slider is between them"},
    {"reversed_valve", InjectedTarget::none, InjectedTarget::none, true, true, false,
     "the valve takes each command with the other sign"},
    {"reversed_encoder", InjectedTarget::none, InjectedTarget::none, true, true, false, "the encoder counts backwards"},
    {"exchanged_hoses", InjectedTarget::none, InjectedTarget::none, true, true, false,
     "each hose leads to the other chamber; the port sensors stay at the valve"},
    {"exchanged_ports", InjectedTarget::none, InjectedTarget::none, true, true, false,
     "the wires of both port sensors are exchanged"},
}};
inline constexpr auto injected_kind_names = [] {
  std::array<std::string_view, injected_kinds.size()> names{};
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = injected_kinds[i].name;
  return names;
}();
inline constexpr const InjectedKindText& text_of(InjectedKind kind) noexcept {
  return injected_kinds[static_cast<std::size_t>(kind)];
}

inline constexpr double longest_injected_delay_s = 1.0;

/// One fault; its time counts from tick 0 of the run, of a device from the first SYNC.
struct InjectedFault {
  InjectedKind kind{};
  std::string target;
  std::optional<double> value;
  double start_s = 0.0;
  double duration_s = infinite;

  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"kind", "", 0, 0, "what goes wrong", Presence::required, injected_kind_names}, p.kind...);
    v(Field{"target", "", 0, 0, "channel (x, p1_port, ...), side (1, 2) or node of the bus", optional}, p.target...);
    v(Field{"value", "", -1e12, 1e12, "size, in the unit of what it acts on", optional}, p.value...);
    v(Field{"start_s", "s", 0, 1e6, "begins then"}, p.start_s...);
    v(Field{"duration_s", "s", 0, infinite, "ends after so long; .inf: never", optional}, p.duration_s...);
  }
  /// Whether sample number `count` since its start is one of its share (`value`, evenly spread; without it all).
  bool takes(std::int64_t count) const noexcept {
    const double share = std::min(value.value_or(1.0), 1.0), n = static_cast<double>(count);
    return std::floor((n + 1.0) * share + 1e-9) > std::floor(n * share + 1e-9);
  }
  bool is_on(double t_s) const noexcept { return t_s >= start_s && t_s < start_s + duration_s; }
};

/// What shall come of a scenario; for the table of faults and its test.
struct ScenarioExpectation {
  std::string fault;
  double within_s = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"fault", "", 0, 0, "name of the fault that must be the reason; none: the run must end well"}, p.fault...);
    v(Field{"within_s", "s", 0, 1e6, "from the first injected fault to the latched one", Presence::optional},
      p.within_s...);
  }
};

inline constexpr std::array<std::string_view, 1> scenario_format_names{"pneuservo-scenario/1"};
struct Scenario {
  std::string format{scenario_format_names[0]};
  std::string what;
  std::map<std::string, InjectedFault> faults;
  std::map<std::string, double> settings;  ///< of the config, for the table of faults
  std::optional<ScenarioExpectation> expect;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"format", "", 0, 0, "version of this format", Presence::required, scenario_format_names}, p.format...);
    v(Field{"what", "", 0, 0, "the scenario in words", optional}, p.what...);
    v(Field{"faults", "", 0, 0, "faults by a name of your choice"}, p.faults...);
    v(Field{"settings", "", -1e12, 1e12, "numbers of the config that tools/fault-table sets, by path", optional},
      p.settings...);
    v(Field{"expect", "", 0, 0, "what shall come of it, for tools/fault-table", optional}, p.expect...);
  }
};

/// Where faults are injected.
enum class InjectionPlace { sim, device };

/// KIND[:TARGET[:VALUE]][@START_S[+DURATION_S]]; without @ it begins at `now_s`. Throws InputError.
InjectedFault parse_fault_order(const std::string& text, double now_s);
/// Reads a scenario file. Throws InputError with file and line.
Scenario read_scenario(const std::filesystem::path& file);
/// Throws InputError, beginning with `origin`, where a fault cannot be injected there: target or value missing, a kind
/// of the other place, a channel, side or node that the rig does not have.
void require_injectable(const InjectedFault& fault, InjectionPlace place, const Rig& rig, const std::string& origin);
/// The table of kinds as text for a help page.
std::string fault_order_help(InjectionPlace place);

}  // namespace pneuservo
