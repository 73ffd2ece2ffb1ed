/* The line as an FMU for co-simulation by FMI 3.0. The types are those of the standard, written
   here in so far as this FMU needs them. */

#include "line.h"
#include "stepping.h"
#include "saved.h"

#if !defined(FMI3_OVERRIDE_FUNCTION_PREFIX) && defined(FMI3_FUNCTION_PREFIX)
#define FMI3_ACTUAL_FUNCTION_PREFIX FMI3_FUNCTION_PREFIX
#endif
#if !defined(FMI3_ACTUAL_FUNCTION_PREFIX)
#define FMI3_ACTUAL_FUNCTION_PREFIX
#endif
#if !defined(FMI3_Export)
#if defined(_WIN32)
#define FMI3_Export __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI3_Export __attribute__((visibility("default")))
#else
#define FMI3_Export
#endif
#endif
#define JOINED(a, b) a##b
#define JOIN(a, b) JOINED(a, b)
#define API(type, name) FMI3_Export type JOIN(FMI3_ACTUAL_FUNCTION_PREFIX, name)

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef void *fmi3Instance;
typedef uint32_t vref;
typedef const char *text;
typedef void (*logger)(void *environment, fmi3Status status, text category, text message);

typedef struct {
    line line;
    logger log;
    void *environment;
    char name[128];
} fmu;

static fmi3Status tell(fmu *it, fmi3Status status, text message) {
    if (it->log != NULL)
        it->log(it->environment, status, status == fmi3Warning ? "logStatusWarning"
                                                               : "logStatusError", message);
    return status;
}

static fmi3Status failed(fmu *it) { return tell(it, fmi3Error, it->line.message); }

static fmi3Status unasked(fmi3Instance of, text name) {
    char message[MESSAGE];
    snprintf(message, sizeof message, "%s: this line does not offer it", name);
    return tell((fmu *)of, fmi3Error, message);
}

API(text, fmi3GetVersion)(void) { return "3.0"; }

API(fmi3Status, fmi3SetDebugLogging)(fmi3Instance of, bool on, size_t n, const text categories[]) {
    (void)n, (void)categories;
    ((fmu *)of)->line.memory.logging = on;
    return fmi3OK;
}

API(fmi3Instance, fmi3InstantiateCoSimulation)(
    text name, text token, text resources, bool visible, bool logging, bool events, bool early,
    const vref required[], size_t n_required, void *environment, logger log, void *update) {
    (void)resources, (void)visible, (void)events, (void)early, (void)required;
    (void)n_required, (void)update;
    if (token == NULL || strcmp(token, TOKEN) != 0) {
        if (log != NULL)
            log(environment, fmi3Error, "logStatusError",
                "the instantiation token is not this model's: description and binary are of two");
        return NULL;
    }
    fmu *it = calloc(1, sizeof *it);
    if (it == NULL) return NULL;
    it->log = log;
    it->environment = environment;
    snprintf(it->name, sizeof it->name, "%s", name == NULL ? "" : name);
    begin(&it->line);
    line_connect(&it->line);
    it->line.memory.logging = logging;
    return it;
}

API(void, fmi3FreeInstance)(fmi3Instance of) { free(of); }

API(fmi3Status, fmi3EnterInitializationMode)(fmi3Instance of, bool tolerance_defined,
                                             double tolerance, double start, bool stop_defined,
                                             double stop) {
    (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
    begin_at(&((fmu *)of)->line, start);
    return fmi3OK;
}

API(fmi3Status, fmi3ExitInitializationMode)(fmi3Instance of) {
    fmu *it = of;
    if (!prepare(&it->line)) return failed(it);
    it->line.memory.phase = STEPPING;
    return fmi3OK;
}

API(fmi3Status, fmi3Terminate)(fmi3Instance of) {
    ((fmu *)of)->line.memory.phase = TERMINATED;
    return fmi3OK;
}

API(fmi3Status, fmi3Reset)(fmi3Instance of) {
    begin(&((fmu *)of)->line);
    return fmi3OK;
}

#define NUMBERS_OF(ending, type, kind)                                                           \
    API(fmi3Status, fmi3Get##ending)(fmi3Instance of, const vref refs[], size_t n_refs,         \
                                     type values[], size_t n) {                                 \
        fmu *it = of;                                                                           \
        for (size_t k = 0; k < n_refs && k < n; k++) {                                          \
            double value = 0.0;                                                                 \
            if (!get_number(&it->line, refs[k], kind, &value)) return failed(it);               \
            values[k] = (type)value;                                                            \
        }                                                                                       \
        return fmi3OK;                                                                          \
    }                                                                                           \
    API(fmi3Status, fmi3Set##ending)(fmi3Instance of, const vref refs[], size_t n_refs,         \
                                     const type values[], size_t n) {                           \
        fmu *it = of;                                                                           \
        for (size_t k = 0; k < n_refs && k < n; k++)                                            \
            if (!set_number(&it->line, refs[k], kind, (double)values[k])) return failed(it);    \
        return fmi3OK;                                                                          \
    }
NUMBERS_OF(Float64, double, REAL)
NUMBERS_OF(Int32, int32_t, INTEGER)
NUMBERS_OF(Boolean, bool, TRUTH)

/* kinds of numbers that this FMU has none of */
#define NO_NUMBERS_OF(ending, type)                                                              \
    API(fmi3Status, fmi3Get##ending)(fmi3Instance of, const vref refs[], size_t n_refs,         \
                                     type values[], size_t n) {                                 \
        (void)refs, (void)values, (void)n;                                                      \
        return n_refs == 0 ? fmi3OK : unasked(of, "fmi3Get" #ending);                           \
    }                                                                                           \
    API(fmi3Status, fmi3Set##ending)(fmi3Instance of, const vref refs[], size_t n_refs,         \
                                     const type values[], size_t n) {                           \
        (void)refs, (void)values, (void)n;                                                      \
        return n_refs == 0 ? fmi3OK : unasked(of, "fmi3Set" #ending);                           \
    }
NO_NUMBERS_OF(Float32, float)
NO_NUMBERS_OF(Int8, int8_t)
NO_NUMBERS_OF(UInt8, uint8_t)
NO_NUMBERS_OF(Int16, int16_t)
NO_NUMBERS_OF(UInt16, uint16_t)
NO_NUMBERS_OF(UInt32, uint32_t)
NO_NUMBERS_OF(Int64, int64_t)
NO_NUMBERS_OF(UInt64, uint64_t)
NO_NUMBERS_OF(String, text)

API(fmi3Status, fmi3DoStep)(fmi3Instance of, double now, double step, bool no_state_before,
                            bool *events, bool *terminate, bool *early, double *last) {
    fmu *it = of;
    (void)no_state_before;
    *events = *terminate = *early = false;
    *last = it->line.memory.now_s;
    if (it->line.memory.phase != STEPPING)
        return tell(it, fmi3Error, "a step is asked for outside of step mode");
    line_answer answer = advance(&it->line, now, step);
    *last = it->line.memory.now_s;
    if (answer == LINE_FAILS) return failed(it);
    return answer == LINE_WARNS ? tell(it, fmi3Warning, it->line.message) : fmi3OK;
}

API(fmi3Status, fmi3GetFMUState)(fmi3Instance of, void **state) {
    fmu *it = of;
    if (*state == NULL) *state = malloc(sizeof(saved_line));
    if (*state == NULL) return tell(it, fmi3Error, "no memory for a saved state");
    save(&it->line, *state);
    return fmi3OK;
}

API(fmi3Status, fmi3SetFMUState)(fmi3Instance of, void *state) {
    fmu *it = of;
    return restore(&it->line, state) ? fmi3OK : failed(it);
}

API(fmi3Status, fmi3FreeFMUState)(fmi3Instance of, void **state) {
    (void)of;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

API(fmi3Status, fmi3SerializedFMUStateSize)(fmi3Instance of, void *state, size_t *size) {
    (void)of, (void)state;
    *size = sizeof(saved_line);
    return fmi3OK;
}

API(fmi3Status, fmi3SerializeFMUState)(fmi3Instance of, void *state, uint8_t bytes[],
                                       size_t size) {
    if (size < sizeof(saved_line))
        return tell((fmu *)of, fmi3Error, "no room for a serialized state: ask for its size");
    memcpy(bytes, state, sizeof(saved_line));
    return fmi3OK;
}

API(fmi3Status, fmi3DeserializeFMUState)(fmi3Instance of, const uint8_t bytes[], size_t size,
                                         void **state) {
    if (size != sizeof(saved_line))
        return tell((fmu *)of, fmi3Error, "these bytes are no state of this model");
    if (*state == NULL) *state = malloc(sizeof(saved_line));
    if (*state == NULL) return tell((fmu *)of, fmi3Error, "no memory for a saved state");
    memcpy(*state, bytes, sizeof(saved_line));
    return fmi3OK;
}

#include "fmi3_unoffered.h"
