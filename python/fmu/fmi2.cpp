// The functions of FMI 2.0 for co-simulation. Types and names are those of its standard.
#include <cstdlib>
#include <string_view>

#include "component.hpp"

using pneuservo::fmu::Component;
using pneuservo::fmu::Status;

namespace {

using fmi2CallbackLogger = void (*)(void* environment, const char* instance, int status, const char* category,
                                    const char* message, ...);

struct Callbacks {
  fmi2CallbackLogger logger;
  void* (*allocate)(std::size_t, std::size_t);
  void (*release)(void*);
  void (*step_finished)(void*, int);
  void* environment;
};

// Path of a file: URI; what is encoded as %XX is decoded.
std::filesystem::path path_of(std::string_view uri) {
  for (const std::string_view scheme : {"file://localhost/", "file:///", "file:/"})
    if (uri.starts_with(scheme)) {
      uri.remove_prefix(scheme.size() - 1);
      break;
    }
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size()) {
      path += static_cast<char>(std::strtol(std::string(uri.substr(i + 1, 2)).c_str(), nullptr, 16));
      i += 2;
    } else {
      path += uri[i];
    }
  }
  return path;
}

}  // namespace

PNEUSERVO_FMI const char* fmi2GetTypesPlatform() { return "default"; }
PNEUSERVO_FMI const char* fmi2GetVersion() { return "2.0"; }
PNEUSERVO_FMI Status fmi2SetDebugLogging(void*, int, std::size_t, const char* const*) { return Status::ok; }

PNEUSERVO_FMI void* fmi2Instantiate(const char* name, int type, const char* token, const char* resources,
                                    const Callbacks* callbacks, int, int) {
  constexpr int co_simulation = 1;
  const auto log = [callbacks = *callbacks, name = std::string(name)](Status status, const char* message) {
    if (callbacks.logger)
      callbacks.logger(callbacks.environment, name.c_str(), static_cast<int>(status), "logStatusError", "%s", message);
  };
  if (type != co_simulation) {
    log(Status::error, "FMU: found model exchange, expected co-simulation");
    return nullptr;
  }
  return pneuservo::fmu::make_component(path_of(resources ? resources : ""), token, log);
}
PNEUSERVO_FMI void fmi2FreeInstance(void* c) { delete static_cast<Component*>(c); }
PNEUSERVO_FMI Status fmi2SetupExperiment(void* c, int, double, double start_s, int, double) {
  return pneuservo::fmu::set_time(c, start_s);
}
PNEUSERVO_FMI Status fmi2EnterInitializationMode(void*) { return Status::ok; }
PNEUSERVO_FMI Status fmi2ExitInitializationMode(void* c) { return pneuservo::fmu::start(c); }
PNEUSERVO_FMI Status fmi2Terminate(void*) { return Status::ok; }
PNEUSERVO_FMI Status fmi2Reset(void* c) { return pneuservo::fmu::reset(c); }
PNEUSERVO_FMI Status fmi2GetReal(void* c, const unsigned* references, std::size_t count, double* values) {
  return pneuservo::fmu::get_values(c, references, count, values);
}
PNEUSERVO_FMI Status fmi2SetReal(void* c, const unsigned* references, std::size_t count, const double* values) {
  return pneuservo::fmu::set_values(c, references, count, values);
}
PNEUSERVO_FMI Status fmi2DoStep(void* c, double time_s, double step_s, int) {
  return pneuservo::fmu::do_step(c, time_s, step_s);
}
PNEUSERVO_FMI Status fmi2CancelStep(void*) { return pneuservo::fmu::refused(); }
PNEUSERVO_FMI Status fmi2GetFMUstate(void* c, void** state) { return pneuservo::fmu::get_state(c, state); }
PNEUSERVO_FMI Status fmi2SetFMUstate(void* c, void* state) { return pneuservo::fmu::set_state(c, state); }
PNEUSERVO_FMI Status fmi2FreeFMUstate(void*, void** state) { return pneuservo::fmu::free_state(state); }

// No variable is of another type: nothing asked for is nothing given.
#define PNEUSERVO_OTHER_TYPE(function)                                                                                 \
  PNEUSERVO_FMI Status function(void*, const unsigned*, std::size_t count, const void*) {                              \
    return count == 0 ? Status::ok : pneuservo::fmu::refused();                                                        \
  }
PNEUSERVO_OTHER_TYPE(fmi2GetInteger)
PNEUSERVO_OTHER_TYPE(fmi2GetBoolean)
PNEUSERVO_OTHER_TYPE(fmi2GetString)
PNEUSERVO_OTHER_TYPE(fmi2SetInteger)
PNEUSERVO_OTHER_TYPE(fmi2SetBoolean)
PNEUSERVO_OTHER_TYPE(fmi2SetString)
#undef PNEUSERVO_OTHER_TYPE

// Arguments of a function that refuses are not looked at; the caller keeps them, as the C ABI of our targets has it.
#define PNEUSERVO_REFUSED(function)                                                                                    \
  PNEUSERVO_FMI Status function() { return pneuservo::fmu::refused(); }
PNEUSERVO_REFUSED(fmi2SerializedFMUstateSize)
PNEUSERVO_REFUSED(fmi2SerializeFMUstate)
PNEUSERVO_REFUSED(fmi2DeSerializeFMUstate)
PNEUSERVO_REFUSED(fmi2GetDirectionalDerivative)
PNEUSERVO_REFUSED(fmi2SetRealInputDerivatives)
PNEUSERVO_REFUSED(fmi2GetRealOutputDerivatives)
PNEUSERVO_REFUSED(fmi2GetStatus)
PNEUSERVO_REFUSED(fmi2GetRealStatus)
PNEUSERVO_REFUSED(fmi2GetIntegerStatus)
PNEUSERVO_REFUSED(fmi2GetBooleanStatus)
PNEUSERVO_REFUSED(fmi2GetStringStatus)
#undef PNEUSERVO_REFUSED
