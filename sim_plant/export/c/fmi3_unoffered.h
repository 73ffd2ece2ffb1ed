/* Functions that FMI 3.0 wants to be there and that co-simulation of this line never needs. */

#define UNOFFERED(name, ...)                                                                     \
    API(fmi3Status, name)(fmi3Instance of, __VA_ARGS__) { return unasked(of, #name); }
#define UNOFFERED_PLAIN(name)                                                                    \
    API(fmi3Status, name)(fmi3Instance of) { return unasked(of, #name); }

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

API(fmi3Instance, fmi3InstantiateModelExchange)(text name, text token, text resources,
                                                bool visible, bool logging, void *environment,
                                                logger log) {
    if (log != NULL)
        log(environment, fmi3Error, "logStatusError", "this line is for co-simulation alone");
    return NULL;
}
API(fmi3Instance, fmi3InstantiateScheduledExecution)(text name, text token, text resources,
                                                     bool visible, bool logging,
                                                     void *environment, logger log, void *update,
                                                     void *lock, void *unlock) {
    if (log != NULL)
        log(environment, fmi3Error, "logStatusError", "this line is for co-simulation alone");
    return NULL;
}

UNOFFERED_PLAIN(fmi3EnterEventMode)
UNOFFERED_PLAIN(fmi3EnterStepMode)
UNOFFERED_PLAIN(fmi3EnterConfigurationMode)
UNOFFERED_PLAIN(fmi3ExitConfigurationMode)
UNOFFERED_PLAIN(fmi3EvaluateDiscreteStates)
UNOFFERED_PLAIN(fmi3EnterContinuousTimeMode)
UNOFFERED(fmi3GetBinary, const vref refs[], size_t n_refs, size_t sizes[],
          const uint8_t *values[], size_t n)
UNOFFERED(fmi3SetBinary, const vref refs[], size_t n_refs, const size_t sizes[],
          const uint8_t *const values[], size_t n)
UNOFFERED(fmi3GetClock, const vref refs[], size_t n_refs, bool values[])
UNOFFERED(fmi3SetClock, const vref refs[], size_t n_refs, const bool values[])
UNOFFERED(fmi3GetNumberOfVariableDependencies, vref ref, size_t *n)
UNOFFERED(fmi3GetVariableDependencies, vref ref, size_t elements[], vref independents[],
          size_t their_elements[], int kinds[], size_t n)
UNOFFERED(fmi3GetDirectionalDerivative, const vref unknowns[], size_t n_unknowns,
          const vref knowns[], size_t n_knowns, const double seed[], size_t n_seed,
          double sensitivity[], size_t n)
UNOFFERED(fmi3GetAdjointDerivative, const vref unknowns[], size_t n_unknowns,
          const vref knowns[], size_t n_knowns, const double seed[], size_t n_seed,
          double sensitivity[], size_t n)
UNOFFERED(fmi3GetIntervalDecimal, const vref refs[], size_t n, double intervals[],
          int qualifiers[])
UNOFFERED(fmi3GetIntervalFraction, const vref refs[], size_t n, uint64_t counters[],
          uint64_t resolutions[], int qualifiers[])
UNOFFERED(fmi3GetShiftDecimal, const vref refs[], size_t n, double shifts[])
UNOFFERED(fmi3GetShiftFraction, const vref refs[], size_t n, uint64_t counters[],
          uint64_t resolutions[])
UNOFFERED(fmi3SetIntervalDecimal, const vref refs[], size_t n, const double intervals[])
UNOFFERED(fmi3SetIntervalFraction, const vref refs[], size_t n, const uint64_t counters[],
          const uint64_t resolutions[])
UNOFFERED(fmi3SetShiftDecimal, const vref refs[], size_t n, const double shifts[])
UNOFFERED(fmi3SetShiftFraction, const vref refs[], size_t n, const uint64_t counters[],
          const uint64_t resolutions[])
UNOFFERED(fmi3UpdateDiscreteStates, bool *update, bool *terminate, bool *nominals, bool *values,
          bool *next_defined, double *next)
UNOFFERED(fmi3CompletedIntegratorStep, bool no_state_before, bool *events, bool *terminate)
UNOFFERED(fmi3SetTime, double time)
UNOFFERED(fmi3SetContinuousStates, const double states[], size_t n)
UNOFFERED(fmi3GetContinuousStateDerivatives, double derivatives[], size_t n)
UNOFFERED(fmi3GetEventIndicators, double indicators[], size_t n)
UNOFFERED(fmi3GetContinuousStates, double states[], size_t n)
UNOFFERED(fmi3GetNominalsOfContinuousStates, double nominals[], size_t n)
UNOFFERED(fmi3GetNumberOfEventIndicators, size_t *n)
UNOFFERED(fmi3GetNumberOfContinuousStates, size_t *n)
UNOFFERED(fmi3GetOutputDerivatives, const vref refs[], size_t n_refs, const int32_t orders[],
          double values[], size_t n)
UNOFFERED(fmi3ActivateModelPartition, vref clock, double time)
