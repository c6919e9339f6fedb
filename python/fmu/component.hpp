// What both versions of the interface share: an instance with its owner's log, and no exception that leaves.
#pragma once
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <string>

#include "instance.hpp"

// What a foreign program finds in the library; everything else in it is hidden.
#define PNEUSERVO_FMI extern "C" __attribute__((visibility("default")))

namespace pneuservo::fmu {

/// Values of FMI 2.0 and 3.0 alike.
enum class Status : int { ok, warning, discard, error, fatal };

struct Component {
  using Log = std::function<void(Status, const char* message)>;
  Log log;
  std::unique_ptr<Instance> instance;
};

/// Runs `work` and turns what it throws into a message and a status.
template <class Work> Status guarded(void* component, Work&& work) noexcept {
  auto& c = *static_cast<Component*>(component);
  try {
    return work(*c.instance);
  } catch (const std::exception& error) {
    if (c.log) c.log(Status::error, error.what());
    return Status::error;
  }
}

/// A new component, or null where the resources or the token are wrong.
inline void* make_component(const std::filesystem::path& resources, const char* token, Component::Log log) noexcept {
  try {
    auto c = std::make_unique<Component>();
    c->log = std::move(log);
    const auto made = [&] {
      c->instance = std::make_unique<Instance>(resources, token ? token : "");
      return c.release();
    };
    try {
      return made();
    } catch (const std::exception& error) {
      if (c->log) c->log(Status::error, error.what());
    }
  } catch (const std::exception&) {}  // without memory there is no log
  return nullptr;
}

inline Status get_values(void* c, const unsigned* references, std::size_t count, double* values) noexcept {
  return guarded(c, [&](Instance& i) {
    for (std::size_t k = 0; k < count; ++k) values[k] = i.value(references[k]);
    return Status::ok;
  });
}

inline Status set_values(void* c, const unsigned* references, std::size_t count, const double* values) noexcept {
  return guarded(c, [&](Instance& i) {
    for (std::size_t k = 0; k < count; ++k) i.set(references[k], values[k]);
    return Status::ok;
  });
}

inline Status do_step(void* c, double time_s, double step_s) noexcept {
  return guarded(c, [&](Instance& i) {
    if (i.step(time_s, step_s)) return Status::ok;
    static_cast<Component*>(c)->log(Status::warning, "the state of the plant is not finite");
    return Status::warning;
  });
}

/// A copy of the state, into an older copy where there is one.
inline Status get_state(void* c, void** state) noexcept {
  return guarded(c, [&](Instance& i) {
    if (*state) *static_cast<Instance*>(*state) = i;
    else *state = new Instance(i);
    return Status::ok;
  });
}

inline Status set_state(void* c, void* state) noexcept {
  return guarded(c, [&](Instance& i) {
    i = *static_cast<const Instance*>(state);
    return Status::ok;
  });
}

inline Status free_state(void** state) noexcept {
  if (state) {
    delete static_cast<Instance*>(*state);
    *state = nullptr;
  }
  return Status::ok;
}

inline Status start(void* c) noexcept {
  return guarded(c, [&](Instance& i) {
    i.start();
    return Status::ok;
  });
}

inline Status set_time(void* c, double time_s) noexcept {
  return guarded(c, [&](Instance& i) {
    i.set_time(time_s);
    return Status::ok;
  });
}

inline Status reset(void* c) noexcept {
  return guarded(c, [&](Instance& i) {
    i.reset();
    return Status::ok;
  });
}

/// What an axis does not have (derivatives, clocks, serialised states) is refused.
inline Status refused() noexcept { return Status::error; }

}  // namespace pneuservo::fmu
