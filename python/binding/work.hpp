// Long calls from Python: progress, Ctrl-C and cancelling while the work goes on in a thread of its own.
#pragma once
#include <functional>
#include <string>

#include "binding.hpp"
#include "diagnosis/stop.hpp"

namespace pneuservo::python {

/// What the caller hears and asks: progress(share, what) and a threading.Event, each may be None.
struct Watchers {
  nb::object progress, cancel;
};

using Progress = std::function<void(double share, const std::string& what)>;
using Job = std::function<void(const StopQuestion& stop, const Progress& progress)>;

/// Does the job without the interpreter's lock and throws what it throws. DiagnosisStopped becomes KeyboardInterrupt
/// after Ctrl-C and pneuservo.DiagnosisStopped else; `call` begins their sentence. Gives whether Ctrl-C came: after the
/// last look for a stop the job does not know of it.
[[nodiscard]] bool watched(const char* call, const Watchers& by, const Job& job);
/// Ctrl-C that ended nothing goes on to the caller.
void raise_interrupt(const char* call);

}  // namespace pneuservo::python
