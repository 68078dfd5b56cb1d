// The functions of FMI 3.0, of which a co-simulation unit needs a part. The others say so.
#include "exports/fmu/fmi3.h"

#include <exception>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "exports/fmu/instance.h"

using namespace axisfit;

namespace {

FmuInstance& instance(fmi3Instance i) { return *static_cast<FmuInstance*>(i); }

constexpr auto kRunning = {Phase::initializing, Phase::stepping, Phase::terminated};
constexpr auto kAlive = {Phase::instantiated, Phase::initializing, Phase::stepping,
                         Phase::terminated};

template <class Do>
fmi3Status attempt(fmi3Instance i, const char* function, std::initializer_list<Phase> phases,
                   Do&& act) {
  return i != nullptr && instance(i).attempt(function, phases, act) ? fmi3OK : fmi3Error;
}

fmi3Status unsupported(fmi3Instance i, const char* function) {
  if (i != nullptr) instance(i).fail(function, kUnsupported);
  return fmi3Error;
}

/// There are no variables but real ones.
fmi3Status of_no_type(fmi3Instance i, const char* function, std::size_t count) {
  return count == 0 ? fmi3OK : unsupported(i, function);
}

void check_count(std::size_t references, std::size_t values) {
  if (references != values)
    throw std::runtime_error("all variables are scalars: one value for each value reference");
}

using References = const fmi3ValueReference*;

}  // namespace

// The names of the standard; unused parameters are those of functions that cannot do anything.
// NOLINTBEGIN(readability-identifier-naming)
#define UNSUPPORTED(function, ...)                                 \
  fmi3Status function(fmi3Instance i __VA_OPT__(, ) __VA_ARGS__) { \
    return unsupported(i, #function);                              \
  }
#define OF_NO_TYPE(function, ...)                                                   \
  fmi3Status function(fmi3Instance i, References, std::size_t count, __VA_ARGS__) { \
    return of_no_type(i, #function, count);                                         \
  }
#define BOTH_OF_NO_TYPE(Type, Value)                                \
  OF_NO_TYPE(fmi3Get##Type, std::add_pointer_t<Value>, std::size_t) \
  OF_NO_TYPE(fmi3Set##Type, std::add_pointer_t<const Value>, std::size_t)

#pragma GCC visibility push(default)
extern "C" {

const char* fmi3GetVersion() { return "3.0"; }

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String /*name*/, fmi3String token, fmi3String resources, fmi3Boolean /*visible*/,
    fmi3Boolean /*logging_on*/, fmi3Boolean event_mode, fmi3Boolean /*early_return*/, References,
    std::size_t intermediate_variables, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback logger, fmi3IntermediateUpdateCallback) {
  const auto log = [environment, logger](const std::string& message) {
    if (logger != nullptr) logger(environment, fmi3Error, "logStatusError", message.c_str());
  };
  try {
    if (token == nullptr || resources == nullptr)
      throw std::runtime_error("token or path of the resources is missing");
    if (event_mode || intermediate_variables > 0)
      throw std::runtime_error("there is neither an event mode nor an intermediate update");
    return new FmuInstance(resources, token, log);
  } catch (const std::exception& error) {
    log(std::string("fmi3InstantiateCoSimulation: ") + error.what());
    return nullptr;
  }
}
fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String, fmi3String, fmi3Boolean,
                                          fmi3Boolean, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback logger) {
  if (logger != nullptr) logger(environment, fmi3Error, "logStatusError", kUnsupported);
  return nullptr;
}
fmi3Instance fmi3InstantiateScheduledExecution(fmi3String, fmi3String, fmi3String, fmi3Boolean,
                                               fmi3Boolean, fmi3InstanceEnvironment environment,
                                               fmi3LogMessageCallback logger,
                                               fmi3ClockUpdateCallback, fmi3LockPreemptionCallback,
                                               fmi3UnlockPreemptionCallback) {
  if (logger != nullptr) logger(environment, fmi3Error, "logStatusError", kUnsupported);
  return nullptr;
}
void fmi3FreeInstance(fmi3Instance i) { delete static_cast<FmuInstance*>(i); }

fmi3Status fmi3SetDebugLogging(fmi3Instance, fmi3Boolean, std::size_t, const fmi3String*) {
  return fmi3OK;  // errors are all that is logged
}
fmi3Status fmi3EnterInitializationMode(fmi3Instance i, fmi3Boolean, fmi3Float64, fmi3Float64 start,
                                       fmi3Boolean, fmi3Float64) {
  return attempt(i, "fmi3EnterInitializationMode", {Phase::instantiated}, [&](FmuInstance& own) {
    own.unit.set_start(start);
    own.enter(Phase::initializing);
  });
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance i) {
  return attempt(i, "fmi3ExitInitializationMode", {Phase::initializing},
                 [](FmuInstance& own) { own.enter(Phase::stepping); });
}
fmi3Status fmi3Terminate(fmi3Instance i) {
  return attempt(i, "fmi3Terminate", {Phase::stepping},
                 [](FmuInstance& own) { own.enter(Phase::terminated); });
}
fmi3Status fmi3Reset(fmi3Instance i) {
  return attempt(i, "fmi3Reset", kAlive, [](FmuInstance& own) { own.reset(); });
}

fmi3Status fmi3GetFloat64(fmi3Instance i, References references, std::size_t count,
                          fmi3Float64* values, std::size_t value_count) {
  return attempt(i, "fmi3GetFloat64", kRunning, [&](FmuInstance& own) {
    check_count(count, value_count);
    for (std::size_t k = 0; k < count; ++k) values[k] = own.unit.value(references[k]);
  });
}
fmi3Status fmi3SetFloat64(fmi3Instance i, References references, std::size_t count,
                          const fmi3Float64* values, std::size_t value_count) {
  return attempt(i, "fmi3SetFloat64", {Phase::instantiated, Phase::initializing, Phase::stepping},
                 [&](FmuInstance& own) {
                   check_count(count, value_count);
                   for (std::size_t k = 0; k < count; ++k) own.unit.set(references[k], values[k]);
                 });
}
BOTH_OF_NO_TYPE(Float32, fmi3Float32)
BOTH_OF_NO_TYPE(Int8, std::int8_t)
BOTH_OF_NO_TYPE(UInt8, std::uint8_t)
BOTH_OF_NO_TYPE(Int16, std::int16_t)
BOTH_OF_NO_TYPE(UInt16, std::uint16_t)
BOTH_OF_NO_TYPE(Int32, std::int32_t)
BOTH_OF_NO_TYPE(UInt32, std::uint32_t)
BOTH_OF_NO_TYPE(Int64, std::int64_t)
BOTH_OF_NO_TYPE(UInt64, std::uint64_t)
BOTH_OF_NO_TYPE(Boolean, fmi3Boolean)
BOTH_OF_NO_TYPE(String, fmi3String)
OF_NO_TYPE(fmi3GetBinary, std::size_t*, fmi3Binary*, std::size_t)
OF_NO_TYPE(fmi3SetBinary, const std::size_t*, const fmi3Binary*, std::size_t)
OF_NO_TYPE(fmi3GetClock, fmi3Clock*)
OF_NO_TYPE(fmi3SetClock, const fmi3Clock*)

fmi3Status fmi3DoStep(fmi3Instance i, fmi3Float64 time, fmi3Float64 step, fmi3Boolean,
                      fmi3Boolean* event_handling_needed, fmi3Boolean* terminate,
                      fmi3Boolean* early_return, fmi3Float64* last_time) {
  return attempt(i, "fmi3DoStep", {Phase::stepping}, [&](FmuInstance& own) {
    *event_handling_needed = *terminate = *early_return = false;
    *last_time = own.unit.time();
    own.unit.step(time, step);
    *last_time = own.unit.time();
  });
}

fmi3Status fmi3GetFMUState(fmi3Instance i, fmi3FMUState* state) {
  return attempt(i, "fmi3GetFMUState", kAlive, [&](FmuInstance& own) { own.take(*state); });
}
fmi3Status fmi3SetFMUState(fmi3Instance i, fmi3FMUState state) {
  return attempt(i, "fmi3SetFMUState", kAlive, [&](FmuInstance& own) { own.restore(state); });
}
fmi3Status fmi3FreeFMUState(fmi3Instance, fmi3FMUState* state) {
  if (state != nullptr) free_state(*state);
  return fmi3OK;
}
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance i, fmi3FMUState state, std::size_t* size) {
  return attempt(i, "fmi3SerializedFMUStateSize", kAlive,
                 [&](FmuInstance&) { *size = size_of_state(state); });
}
fmi3Status fmi3SerializeFMUState(fmi3Instance i, fmi3FMUState state, fmi3Byte* bytes,
                                 std::size_t size) {
  return attempt(i, "fmi3SerializeFMUState", kAlive,
                 [&](FmuInstance&) { write_state(state, reinterpret_cast<char*>(bytes), size); });
}
fmi3Status fmi3DeserializeFMUState(fmi3Instance i, const fmi3Byte* bytes, std::size_t size,
                                   fmi3FMUState* state) {
  return attempt(i, "fmi3DeserializeFMUState", kAlive, [&](FmuInstance&) {
    *state = read_state(reinterpret_cast<const char*>(bytes), size);
  });
}

UNSUPPORTED(fmi3GetNumberOfVariableDependencies, fmi3ValueReference, std::size_t*)
UNSUPPORTED(fmi3GetVariableDependencies, fmi3ValueReference, std::size_t*, fmi3ValueReference*,
            std::size_t*, fmi3DependencyKind*, std::size_t)
UNSUPPORTED(fmi3GetDirectionalDerivative, References, std::size_t, References, std::size_t,
            const fmi3Float64*, std::size_t, fmi3Float64*, std::size_t)
UNSUPPORTED(fmi3GetAdjointDerivative, References, std::size_t, References, std::size_t,
            const fmi3Float64*, std::size_t, fmi3Float64*, std::size_t)
UNSUPPORTED(fmi3GetOutputDerivatives, References, std::size_t, const std::int32_t*, fmi3Float64*,
            std::size_t)
UNSUPPORTED(fmi3EnterConfigurationMode)
UNSUPPORTED(fmi3ExitConfigurationMode)
UNSUPPORTED(fmi3EnterEventMode)
UNSUPPORTED(fmi3EnterStepMode)
UNSUPPORTED(fmi3EvaluateDiscreteStates)
UNSUPPORTED(fmi3UpdateDiscreteStates, fmi3Boolean*, fmi3Boolean*, fmi3Boolean*, fmi3Boolean*,
            fmi3Boolean*, fmi3Float64*)

// Clocks, of which there are none.
UNSUPPORTED(fmi3GetIntervalDecimal, References, std::size_t, fmi3Float64*, fmi3IntervalQualifier*)
UNSUPPORTED(fmi3GetIntervalFraction, References, std::size_t, std::uint64_t*, std::uint64_t*,
            fmi3IntervalQualifier*)
UNSUPPORTED(fmi3GetShiftDecimal, References, std::size_t, fmi3Float64*)
UNSUPPORTED(fmi3GetShiftFraction, References, std::size_t, std::uint64_t*, std::uint64_t*)
UNSUPPORTED(fmi3SetIntervalDecimal, References, std::size_t, const fmi3Float64*)
UNSUPPORTED(fmi3SetIntervalFraction, References, std::size_t, const std::uint64_t*,
            const std::uint64_t*)
UNSUPPORTED(fmi3SetShiftDecimal, References, std::size_t, const fmi3Float64*)
UNSUPPORTED(fmi3SetShiftFraction, References, std::size_t, const std::uint64_t*,
            const std::uint64_t*)
UNSUPPORTED(fmi3ActivateModelPartition, fmi3ValueReference, fmi3Float64)

// Model exchange.
UNSUPPORTED(fmi3EnterContinuousTimeMode)
UNSUPPORTED(fmi3CompletedIntegratorStep, fmi3Boolean, fmi3Boolean*, fmi3Boolean*)
UNSUPPORTED(fmi3SetTime, fmi3Float64)
UNSUPPORTED(fmi3SetContinuousStates, const fmi3Float64*, std::size_t)
UNSUPPORTED(fmi3GetContinuousStateDerivatives, fmi3Float64*, std::size_t)
UNSUPPORTED(fmi3GetEventIndicators, fmi3Float64*, std::size_t)
UNSUPPORTED(fmi3GetContinuousStates, fmi3Float64*, std::size_t)
UNSUPPORTED(fmi3GetNominalsOfContinuousStates, fmi3Float64*, std::size_t)
UNSUPPORTED(fmi3GetNumberOfEventIndicators, std::size_t*)
UNSUPPORTED(fmi3GetNumberOfContinuousStates, std::size_t*)

}  // extern "C"
#pragma GCC visibility pop
// NOLINTEND(readability-identifier-naming)
