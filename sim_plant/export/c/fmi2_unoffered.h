/* Functions that FMI 2.0 wants to be there for co-simulation and that this line never needs. */

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

#define UNOFFERED(name, ...)                                                                     \
    API(fmi2Status, name)(fmi2Component of, __VA_ARGS__) { return unasked(of, #name); }

UNOFFERED(fmi2GetDirectionalDerivative, const vref unknowns[], size_t n_unknowns,
          const vref knowns[], size_t n_knowns, const double seed[], double sensitivity[])
UNOFFERED(fmi2SetRealInputDerivatives, const vref refs[], size_t n, const int orders[],
          const double values[])
UNOFFERED(fmi2GetRealOutputDerivatives, const vref refs[], size_t n, const int orders[],
          double values[])
UNOFFERED(fmi2GetStatus, int asked, fmi2Status *value)
UNOFFERED(fmi2GetIntegerStatus, int asked, int *value)
UNOFFERED(fmi2GetStringStatus, int asked, text *value)

API(fmi2Status, fmi2CancelStep)(fmi2Component of) { return unasked(of, "fmi2CancelStep"); }

/* of the kinds of a status: 2 is the last time that was reached, 3 whether the line has ended */
API(fmi2Status, fmi2GetRealStatus)(fmi2Component of, int asked, double *value) {
    if (asked != 2) return unasked(of, "fmi2GetRealStatus");
    *value = ((fmu *)of)->line.memory.now_s;
    return fmi2OK;
}
API(fmi2Status, fmi2GetBooleanStatus)(fmi2Component of, int asked, int *value) {
    if (asked != 3) return unasked(of, "fmi2GetBooleanStatus");
    *value = 0;
    return fmi2OK;
}
