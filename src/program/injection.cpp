// Faults of a run from --scenario and --fault.
#include "program/injection.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "backends.hpp"
#include "config/input_error.hpp"
#include "inject/injecting_backend.hpp"

namespace pneuservo {

std::vector<InjectedFault> injected_faults(const std::vector<std::string>& scenarios,
                                           const std::vector<std::string>& orders, const Rig& rig) {
  std::vector<InjectedFault> faults;
  for (const std::string& file : scenarios)
    for (const auto& [name, fault] : read_scenario(file).faults) {
      require_injectable(fault, InjectionPlace::sim, rig, fmt::format("{}: faults.{}", file, name));
      faults.push_back(fault);
    }
  for (const std::string& order : orders) {
    faults.push_back(parse_fault_order(order, 0.0));
    require_injectable(faults.back(), InjectionPlace::sim, rig, "--fault " + order);
  }
  return faults;
}

namespace {

constexpr std::int64_t slots_of_a_gap = 5;

bool is_of_loop(const InjectedFault& fault) {
  return fault.kind == InjectedKind::late_tick || fault.kind == InjectedKind::late_share ||
         fault.kind == InjectedKind::suspend;
}

/// Gaps of a share of all slots, evenly spread.
void add_gaps(const InjectedFault& fault, double period_s, double end_s, std::vector<LateTick>& late) {
  const double every = static_cast<double>(slots_of_a_gap) / *fault.value;
  const double last = std::min(end_s, fault.start_s + fault.duration_s) / period_s;
  for (double tick = fault.start_s / period_s; tick < last; tick += every)
    late.push_back({std::llround(tick), slots_of_a_gap});
}

}  // namespace

std::vector<LateTick> late_ticks(const std::vector<InjectedFault>& faults, double period_s, double end_s) {
  std::vector<LateTick> late;
  for (const InjectedFault& fault : faults) {
    if (fault.kind == InjectedKind::late_share) add_gaps(fault, period_s, end_s, late);
    if (fault.kind == InjectedKind::late_tick)
      late.push_back({std::llround(fault.start_s / period_s), std::llround(*fault.value / period_s)});
  }
  std::sort(late.begin(), late.end(), [](const LateTick& a, const LateTick& b) { return a.tick < b.tick; });
  return late;
}

std::vector<Suspend> suspends(const std::vector<InjectedFault>& faults, double period_s) {
  std::vector<Suspend> all;
  for (const InjectedFault& fault : faults)
    if (fault.kind == InjectedKind::suspend)
      all.push_back({std::llround(fault.start_s / period_s), std::llround(*fault.value * 1e9)});
  return all;
}

std::unique_ptr<Backend> make_faulty_backend(const std::string& name, const Rig& rig,
                                             const std::vector<InjectedFault>& faults) {
  const auto beside_late =
      std::find_if(faults.begin(), faults.end(), [](const InjectedFault& fault) { return !is_of_loop(fault); });
  if (beside_late == faults.end()) return make_backend(name, rig);
  if (name != "sim")
    throw InputError(fmt::format("--hal: found {} with the injected fault {}, expected sim, or the fault in the verb "
                                 "device at the other end of the bus",
                                 name, text_of(beside_late->kind).name));
  return std::make_unique<InjectingBackend>(rig, faults, "--scenario");
}

}  // namespace pneuservo
