// The functions of FMI 2.0, of which a co-simulation unit needs a part. The others say so.
#include "exports/fmu/fmi2.h"

#include <exception>
#include <stdexcept>
#include <string>

#include "exports/fmu/instance.h"

using namespace axisfit;

namespace {

FmuInstance& instance(fmi2Component c) { return *static_cast<FmuInstance*>(c); }

constexpr auto kRunning = {Phase::initializing, Phase::stepping, Phase::terminated};
constexpr auto kAlive = {Phase::instantiated, Phase::initializing, Phase::stepping,
                         Phase::terminated};

template <class Do>
fmi2Status attempt(fmi2Component c, const char* function, std::initializer_list<Phase> phases,
                   Do&& act) {
  return c != nullptr && instance(c).attempt(function, phases, act) ? fmi2OK : fmi2Error;
}

fmi2Status unsupported(fmi2Component c, const char* function) {
  if (c != nullptr) instance(c).fail(function, kUnsupported);
  return fmi2Error;
}

/// There are no variables but real ones.
fmi2Status of_no_type(fmi2Component c, const char* function, std::size_t count) {
  return count == 0 ? fmi2OK : unsupported(c, function);
}

}  // namespace

// The names of the standard; unused parameters are those of functions that cannot do anything.
// NOLINTBEGIN(readability-identifier-naming)
#define UNSUPPORTED(function, ...)                                  \
  fmi2Status function(fmi2Component c __VA_OPT__(, ) __VA_ARGS__) { \
    return unsupported(c, #function);                               \
  }
#define OF_NO_TYPE(function, Values)                                                           \
  fmi2Status function(fmi2Component c, const fmi2ValueReference*, std::size_t count, Values) { \
    return of_no_type(c, #function, count);                                                    \
  }

#pragma GCC visibility push(default)
extern "C" {

const char* fmi2GetTypesPlatform() { return "default"; }
const char* fmi2GetVersion() { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* functions, fmi2Boolean /*visible*/,
                              fmi2Boolean /*logging_on*/) {
  if (functions == nullptr || guid == nullptr || resources == nullptr) return nullptr;
  const fmi2CallbackFunctions callbacks = *functions;
  const std::string called = name != nullptr ? name : "";
  const auto log = [callbacks, called](const std::string& message) {
    if (callbacks.logger != nullptr)
      callbacks.logger(callbacks.componentEnvironment, called.c_str(), fmi2Error, "logStatusError",
                       "%s", message.c_str());
  };
  try {
    if (type != fmi2CoSimulation) throw std::runtime_error("this is a unit for co-simulation");
    return new FmuInstance(path_of_uri(resources), guid, log);
  } catch (const std::exception& error) {
    log(std::string("fmi2Instantiate: ") + error.what());
    return nullptr;
  }
}
void fmi2FreeInstance(fmi2Component c) { delete static_cast<FmuInstance*>(c); }

fmi2Status fmi2SetDebugLogging(fmi2Component, fmi2Boolean, std::size_t, const fmi2String*) {
  return fmi2OK;  // errors are all that is logged
}
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean, fmi2Real, fmi2Real start, fmi2Boolean,
                               fmi2Real) {
  return attempt(c, "fmi2SetupExperiment", {Phase::instantiated},
                 [&](FmuInstance& i) { i.unit.set_start(start); });
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  return attempt(c, "fmi2EnterInitializationMode", {Phase::instantiated},
                 [](FmuInstance& i) { i.enter(Phase::initializing); });
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  return attempt(c, "fmi2ExitInitializationMode", {Phase::initializing},
                 [](FmuInstance& i) { i.enter(Phase::stepping); });
}
fmi2Status fmi2Terminate(fmi2Component c) {
  return attempt(c, "fmi2Terminate", {Phase::stepping},
                 [](FmuInstance& i) { i.enter(Phase::terminated); });
}
fmi2Status fmi2Reset(fmi2Component c) {
  return attempt(c, "fmi2Reset", kAlive, [](FmuInstance& i) { i.reset(); });
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference* references, std::size_t count,
                       fmi2Real* values) {
  return attempt(c, "fmi2GetReal", kRunning, [&](FmuInstance& i) {
    for (std::size_t k = 0; k < count; ++k) values[k] = i.unit.value(references[k]);
  });
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference* references, std::size_t count,
                       const fmi2Real* values) {
  return attempt(c, "fmi2SetReal", {Phase::instantiated, Phase::initializing, Phase::stepping},
                 [&](FmuInstance& i) {
                   for (std::size_t k = 0; k < count; ++k) i.unit.set(references[k], values[k]);
                 });
}
OF_NO_TYPE(fmi2GetInteger, fmi2Integer*)
OF_NO_TYPE(fmi2GetBoolean, fmi2Boolean*)
OF_NO_TYPE(fmi2GetString, fmi2String*)
OF_NO_TYPE(fmi2SetInteger, const fmi2Integer*)
OF_NO_TYPE(fmi2SetBoolean, const fmi2Boolean*)
OF_NO_TYPE(fmi2SetString, const fmi2String*)

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean) {
  return attempt(c, "fmi2DoStep", {Phase::stepping},
                 [&](FmuInstance& i) { i.unit.step(time, step); });
}
UNSUPPORTED(fmi2CancelStep)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return attempt(c, "fmi2GetFMUstate", kAlive, [&](FmuInstance& i) { i.take(*state); });
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  return attempt(c, "fmi2SetFMUstate", kAlive, [&](FmuInstance& i) { i.restore(state); });
}
fmi2Status fmi2FreeFMUstate(fmi2Component, fmi2FMUstate* state) {
  if (state != nullptr) free_state(*state);
  return fmi2OK;
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, std::size_t* size) {
  return attempt(c, "fmi2SerializedFMUstateSize", kAlive,
                 [&](FmuInstance&) { *size = size_of_state(state); });
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte* bytes,
                                 std::size_t size) {
  return attempt(c, "fmi2SerializeFMUstate", kAlive,
                 [&](FmuInstance&) { write_state(state, bytes, size); });
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte* bytes, std::size_t size,
                                   fmi2FMUstate* state) {
  return attempt(c, "fmi2DeSerializeFMUstate", kAlive,
                 [&](FmuInstance&) { *state = read_state(bytes, size); });
}

UNSUPPORTED(fmi2GetStatus, fmi2StatusKind, fmi2Status*)
fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real* value) {
  if (kind != fmi2LastSuccessfulTime) return unsupported(c, "fmi2GetRealStatus");
  return attempt(c, "fmi2GetRealStatus", kRunning, [&](FmuInstance& i) { *value = i.unit.time(); });
}
UNSUPPORTED(fmi2GetIntegerStatus, fmi2StatusKind, fmi2Integer*)
UNSUPPORTED(fmi2GetBooleanStatus, fmi2StatusKind, fmi2Boolean*)
UNSUPPORTED(fmi2GetStringStatus, fmi2StatusKind, fmi2String*)
UNSUPPORTED(fmi2SetRealInputDerivatives, const fmi2ValueReference*, std::size_t, const fmi2Integer*,
            const fmi2Real*)
UNSUPPORTED(fmi2GetRealOutputDerivatives, const fmi2ValueReference*, std::size_t,
            const fmi2Integer*, fmi2Real*)
UNSUPPORTED(fmi2GetDirectionalDerivative, const fmi2ValueReference*, std::size_t,
            const fmi2ValueReference*, std::size_t, const fmi2Real*, fmi2Real*)

// Model exchange.
UNSUPPORTED(fmi2EnterEventMode)
UNSUPPORTED(fmi2EnterContinuousTimeMode)
UNSUPPORTED(fmi2NewDiscreteStates, fmi2EventInfo*)
UNSUPPORTED(fmi2CompletedIntegratorStep, fmi2Boolean, fmi2Boolean*, fmi2Boolean*)
UNSUPPORTED(fmi2SetTime, fmi2Real)
UNSUPPORTED(fmi2SetContinuousStates, const fmi2Real*, std::size_t)
UNSUPPORTED(fmi2GetDerivatives, fmi2Real*, std::size_t)
UNSUPPORTED(fmi2GetEventIndicators, fmi2Real*, std::size_t)
UNSUPPORTED(fmi2GetContinuousStates, fmi2Real*, std::size_t)
UNSUPPORTED(fmi2GetNominalsOfContinuousStates, fmi2Real*, std::size_t)

}  // extern "C"
#pragma GCC visibility pop
// NOLINTEND(readability-identifier-naming)
