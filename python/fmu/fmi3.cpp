// The functions of FMI 3.0 for co-simulation. Types and names are those of its standard.
#include <cstdint>

#include "component.hpp"

using pneuservo::fmu::Component;
using pneuservo::fmu::Status;

namespace {

using fmi3LogMessageCallback = void (*)(void* environment, int status, const char* category, const char* message);

}  // namespace

PNEUSERVO_FMI const char* fmi3GetVersion() { return "3.0"; }
PNEUSERVO_FMI Status fmi3SetDebugLogging(void*, bool, std::size_t, const char* const*) { return Status::ok; }

PNEUSERVO_FMI void* fmi3InstantiateCoSimulation(const char*, const char* token, const char* resources, bool, bool, bool,
                                                bool, const std::uint32_t*, std::size_t, void* environment,
                                                fmi3LogMessageCallback logger, const void*) {
  const auto log = [=](Status status, const char* message) {
    if (logger) logger(environment, static_cast<int>(status), "logStatusError", message);
  };
  return pneuservo::fmu::make_component(resources ? resources : "", token, log);
}
PNEUSERVO_FMI void* fmi3InstantiateModelExchange() { return nullptr; }
PNEUSERVO_FMI void* fmi3InstantiateScheduledExecution() { return nullptr; }
PNEUSERVO_FMI void fmi3FreeInstance(void* c) { delete static_cast<Component*>(c); }
PNEUSERVO_FMI Status fmi3EnterInitializationMode(void* c, bool, double, double start_s, bool, double) {
  return pneuservo::fmu::set_time(c, start_s);
}
PNEUSERVO_FMI Status fmi3ExitInitializationMode(void* c) { return pneuservo::fmu::start(c); }
PNEUSERVO_FMI Status fmi3EnterConfigurationMode(void*) { return Status::ok; }
PNEUSERVO_FMI Status fmi3ExitConfigurationMode(void*) { return Status::ok; }
PNEUSERVO_FMI Status fmi3EnterEventMode(void*) { return pneuservo::fmu::refused(); }
PNEUSERVO_FMI Status fmi3EnterStepMode(void*) { return Status::ok; }
PNEUSERVO_FMI Status fmi3Terminate(void*) { return Status::ok; }
PNEUSERVO_FMI Status fmi3Reset(void* c) { return pneuservo::fmu::reset(c); }
PNEUSERVO_FMI Status fmi3GetFloat64(void* c, const std::uint32_t* references, std::size_t count, double* values,
                                    std::size_t) {
  return pneuservo::fmu::get_values(c, references, count, values);
}
PNEUSERVO_FMI Status fmi3SetFloat64(void* c, const std::uint32_t* references, std::size_t count, const double* values,
                                    std::size_t) {
  return pneuservo::fmu::set_values(c, references, count, values);
}
PNEUSERVO_FMI Status fmi3DoStep(void* c, double time_s, double step_s, bool, bool* event_handling, bool* terminate,
                                bool* early_return, double* last_successful_time_s) {
  const Status status = pneuservo::fmu::do_step(c, time_s, step_s);
  *event_handling = *terminate = *early_return = false;
  *last_successful_time_s = status < Status::discard ? time_s + step_s : time_s;
  return status;
}
PNEUSERVO_FMI Status fmi3GetFMUState(void* c, void** state) { return pneuservo::fmu::get_state(c, state); }
PNEUSERVO_FMI Status fmi3SetFMUState(void* c, void* state) { return pneuservo::fmu::set_state(c, state); }
PNEUSERVO_FMI Status fmi3FreeFMUState(void*, void** state) { return pneuservo::fmu::free_state(state); }

// No variable is of another type: nothing asked for is nothing given.
#define PNEUSERVO_OTHER_TYPE(type)                                                                                     \
  PNEUSERVO_FMI Status fmi3Get##type(void*, const std::uint32_t*, std::size_t count, void*, std::size_t) {             \
    return count == 0 ? Status::ok : pneuservo::fmu::refused();                                                        \
  }                                                                                                                    \
  PNEUSERVO_FMI Status fmi3Set##type(void*, const std::uint32_t*, std::size_t count, const void*, std::size_t) {       \
    return count == 0 ? Status::ok : pneuservo::fmu::refused();                                                        \
  }
PNEUSERVO_OTHER_TYPE(Float32)
PNEUSERVO_OTHER_TYPE(Int8)
PNEUSERVO_OTHER_TYPE(UInt8)
PNEUSERVO_OTHER_TYPE(Int16)
PNEUSERVO_OTHER_TYPE(UInt16)
PNEUSERVO_OTHER_TYPE(Int32)
PNEUSERVO_OTHER_TYPE(UInt32)
PNEUSERVO_OTHER_TYPE(Int64)
PNEUSERVO_OTHER_TYPE(UInt64)
PNEUSERVO_OTHER_TYPE(Boolean)
PNEUSERVO_OTHER_TYPE(String)
PNEUSERVO_OTHER_TYPE(Binary)
PNEUSERVO_OTHER_TYPE(Clock)
#undef PNEUSERVO_OTHER_TYPE

// Arguments of a function that refuses are not looked at; the caller keeps them, as the C ABI of our targets has it.
#define PNEUSERVO_REFUSED(function)                                                                                    \
  PNEUSERVO_FMI Status fmi3##function() { return pneuservo::fmu::refused(); }
PNEUSERVO_REFUSED(GetNumberOfVariableDependencies)
PNEUSERVO_REFUSED(GetVariableDependencies)
PNEUSERVO_REFUSED(SerializedFMUStateSize)
PNEUSERVO_REFUSED(SerializeFMUState)
PNEUSERVO_REFUSED(DeserializeFMUState)
PNEUSERVO_REFUSED(GetDirectionalDerivative)
PNEUSERVO_REFUSED(GetAdjointDerivative)
PNEUSERVO_REFUSED(GetIntervalDecimal)
PNEUSERVO_REFUSED(GetIntervalFraction)
PNEUSERVO_REFUSED(GetShiftDecimal)
PNEUSERVO_REFUSED(GetShiftFraction)
PNEUSERVO_REFUSED(SetIntervalDecimal)
PNEUSERVO_REFUSED(SetIntervalFraction)
PNEUSERVO_REFUSED(SetShiftDecimal)
PNEUSERVO_REFUSED(SetShiftFraction)
PNEUSERVO_REFUSED(EvaluateDiscreteStates)
PNEUSERVO_REFUSED(UpdateDiscreteStates)
PNEUSERVO_REFUSED(EnterContinuousTimeMode)
PNEUSERVO_REFUSED(CompletedIntegratorStep)
PNEUSERVO_REFUSED(SetTime)
PNEUSERVO_REFUSED(SetContinuousStates)
PNEUSERVO_REFUSED(GetContinuousStateDerivatives)
PNEUSERVO_REFUSED(GetEventIndicators)
PNEUSERVO_REFUSED(GetContinuousStates)
PNEUSERVO_REFUSED(GetNominalsOfContinuousStates)
PNEUSERVO_REFUSED(GetNumberOfEventIndicators)
PNEUSERVO_REFUSED(GetNumberOfContinuousStates)
PNEUSERVO_REFUSED(GetOutputDerivatives)
PNEUSERVO_REFUSED(ActivateModelPartition)
#undef PNEUSERVO_REFUSED
