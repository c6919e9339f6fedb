// The wish to stop a diagnosis, looked for inside everything that takes long.
#pragma once
#include <functional>
#include <stdexcept>

namespace pneuservo {

/// Somebody asked to stop (Ctrl-C); what is there already is kept.
struct DiagnosisStopped : std::runtime_error {
  DiagnosisStopped() : std::runtime_error("stopped") {}
};

/// Whether to stop; asked from any thread. Empty: never.
using StopQuestion = std::function<bool()>;

/// Throws DiagnosisStopped where the answer is yes.
inline void look_for_stop(const StopQuestion& stop) {
  if (stop && stop()) throw DiagnosisStopped();
}

}  // namespace pneuservo
