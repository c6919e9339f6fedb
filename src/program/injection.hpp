// Faults of a run from --scenario and --fault: the backend that shows them and the ticks that come late.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

#include "loop/runner.hpp"
#include "rig/injected_fault.hpp"

namespace pneuservo {

/// Those of the files, then those of the orders. Throws InputError naming file and line, or the order.
std::vector<InjectedFault> injected_faults(const std::vector<std::string>& scenarios,
                                           const std::vector<std::string>& orders, const Rig& rig);
/// Ticks that come late until `end_s`, in order.
std::vector<LateTick> late_ticks(const std::vector<InjectedFault>& faults, double period_s, double end_s);
std::vector<Suspend> suspends(const std::vector<InjectedFault>& faults, double period_s);
/// The backend by its name, with the faults; only sim can show other ones than those of the loop's own time. Throws
/// InputError.
std::unique_ptr<Backend> make_faulty_backend(const std::string& name, const Rig& rig,
                                             const std::vector<InjectedFault>& faults);

}  // namespace pneuservo
