/* The line as an FMU for co-simulation by FMI 2.0. The types are those of the standard, written
   here in so far as this FMU needs them. */

#include "line.h"
#include "stepping.h"
#include "saved.h"

#if !defined(FMI2_OVERRIDE_FUNCTION_PREFIX) && defined(FMI2_FUNCTION_PREFIX)
#define FMI2_ACTUAL_FUNCTION_PREFIX FMI2_FUNCTION_PREFIX
#endif
#if !defined(FMI2_ACTUAL_FUNCTION_PREFIX)
#define FMI2_ACTUAL_FUNCTION_PREFIX
#endif
#if !defined(FMI2_Export)
#if defined(_WIN32)
#define FMI2_Export __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI2_Export __attribute__((visibility("default")))
#else
#define FMI2_Export
#endif
#endif
#define JOINED(a, b) a##b
#define JOIN(a, b) JOINED(a, b)
#define API(type, name) FMI2_Export type JOIN(FMI2_ACTUAL_FUNCTION_PREFIX, name)

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef void *fmi2Component;
typedef unsigned int vref;
typedef const char *text;
typedef void (*logger)(void *environment, text name, fmi2Status status, text category,
                       text message, ...);
typedef struct {
    logger log;
    void *(*allocate)(size_t n, size_t size);
    void (*release)(void *memory);
    void (*finished)(void *environment, fmi2Status status);
    void *environment;
} callbacks;

typedef struct {
    line line;
    callbacks given;
    char name[128];
} fmu;

static fmi2Status tell(fmu *it, fmi2Status status, text message) {
    if (it->given.log != NULL)
        it->given.log(it->given.environment, it->name, status,
                      status == fmi2Warning ? "logStatusWarning" : "logStatusError", "%s",
                      message);
    return status;
}

static fmi2Status failed(fmu *it) { return tell(it, fmi2Error, it->line.message); }

static fmi2Status unasked(fmi2Component of, text name) {
    char message[MESSAGE];
    snprintf(message, sizeof message, "%s: this line does not offer it", name);
    return tell((fmu *)of, fmi2Error, message);
}

API(text, fmi2GetTypesPlatform)(void) { return "default"; }
API(text, fmi2GetVersion)(void) { return "2.0"; }

API(fmi2Status, fmi2SetDebugLogging)(fmi2Component of, int on, size_t n, const text categories[]) {
    (void)n, (void)categories;
    ((fmu *)of)->line.memory.logging = on;
    return fmi2OK;
}

API(fmi2Component, fmi2Instantiate)(text name, int type, text guid, text resources,
                                    const callbacks *given, int visible, int logging) {
    text refused = NULL;
    (void)resources, (void)visible;
    if (type != 1) refused = "this line is for co-simulation alone";
    if (guid == NULL || strcmp(guid, TOKEN) != 0)
        refused = "the GUID is not this model's: description and binary are of two";
    if (refused != NULL) {
        if (given != NULL && given->log != NULL)
            given->log(given->environment, name, fmi2Error, "logStatusError", "%s", refused);
        return NULL;
    }
    fmu *it = calloc(1, sizeof *it);
    if (it == NULL) return NULL;
    if (given != NULL) it->given = *given;
    snprintf(it->name, sizeof it->name, "%s", name == NULL ? "" : name);
    begin(&it->line);
    line_connect(&it->line);
    it->line.memory.logging = logging;
    return it;
}

API(void, fmi2FreeInstance)(fmi2Component of) { free(of); }

API(fmi2Status, fmi2SetupExperiment)(fmi2Component of, int tolerance_defined, double tolerance,
                                     double start, int stop_defined, double stop) {
    fmu *it = of;
    (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
    it->line.memory.start_s = start;
    return fmi2OK;
}

API(fmi2Status, fmi2EnterInitializationMode)(fmi2Component of) {
    line *it = &((fmu *)of)->line;
    begin_at(it, it->memory.start_s);
    return fmi2OK;
}

API(fmi2Status, fmi2ExitInitializationMode)(fmi2Component of) {
    fmu *it = of;
    if (!prepare(&it->line)) return failed(it);
    it->line.memory.phase = STEPPING;
    return fmi2OK;
}

API(fmi2Status, fmi2Terminate)(fmi2Component of) {
    ((fmu *)of)->line.memory.phase = TERMINATED;
    return fmi2OK;
}

API(fmi2Status, fmi2Reset)(fmi2Component of) {
    begin(&((fmu *)of)->line);
    return fmi2OK;
}

#define NUMBERS_OF(ending, type, kind)                                                           \
    API(fmi2Status, fmi2Get##ending)(fmi2Component of, const vref refs[], size_t n,             \
                                     type values[]) {                                           \
        fmu *it = of;                                                                           \
        for (size_t k = 0; k < n; k++) {                                                        \
            double value = 0.0;                                                                 \
            if (!get_number(&it->line, refs[k], kind, &value)) return failed(it);               \
            values[k] = (type)value;                                                            \
        }                                                                                       \
        return fmi2OK;                                                                          \
    }                                                                                           \
    API(fmi2Status, fmi2Set##ending)(fmi2Component of, const vref refs[], size_t n,             \
                                     const type values[]) {                                     \
        fmu *it = of;                                                                           \
        for (size_t k = 0; k < n; k++)                                                          \
            if (!set_number(&it->line, refs[k], kind, (double)values[k])) return failed(it);    \
        return fmi2OK;                                                                          \
    }
NUMBERS_OF(Real, double, REAL)
NUMBERS_OF(Integer, int, INTEGER)
NUMBERS_OF(Boolean, int, TRUTH)

API(fmi2Status, fmi2GetString)(fmi2Component of, const vref refs[], size_t n, text values[]) {
    (void)refs, (void)values;
    return n == 0 ? fmi2OK : unasked(of, "fmi2GetString");
}
API(fmi2Status, fmi2SetString)(fmi2Component of, const vref refs[], size_t n,
                               const text values[]) {
    (void)refs, (void)values;
    return n == 0 ? fmi2OK : unasked(of, "fmi2SetString");
}

API(fmi2Status, fmi2DoStep)(fmi2Component of, double now, double step, int no_state_before) {
    fmu *it = of;
    (void)no_state_before;
    if (it->line.memory.phase != STEPPING)
        return tell(it, fmi2Error, "a step is asked for before the initialization ended");
    line_answer answer = advance(&it->line, now, step);
    if (answer == LINE_FAILS) return failed(it);
    return answer == LINE_WARNS ? tell(it, fmi2Warning, it->line.message) : fmi2OK;
}

API(fmi2Status, fmi2GetFMUstate)(fmi2Component of, void **state) {
    fmu *it = of;
    if (*state == NULL) *state = malloc(sizeof(saved_line));
    if (*state == NULL) return tell(it, fmi2Error, "no memory for a saved state");
    save(&it->line, *state);
    return fmi2OK;
}

API(fmi2Status, fmi2SetFMUstate)(fmi2Component of, void *state) {
    fmu *it = of;
    return restore(&it->line, state) ? fmi2OK : failed(it);
}

API(fmi2Status, fmi2FreeFMUstate)(fmi2Component of, void **state) {
    (void)of;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

API(fmi2Status, fmi2SerializedFMUstateSize)(fmi2Component of, void *state, size_t *size) {
    (void)of, (void)state;
    *size = sizeof(saved_line);
    return fmi2OK;
}

API(fmi2Status, fmi2SerializeFMUstate)(fmi2Component of, void *state, char bytes[], size_t size) {
    if (size < sizeof(saved_line))
        return tell((fmu *)of, fmi2Error, "no room for a serialized state: ask for its size");
    memcpy(bytes, state, sizeof(saved_line));
    return fmi2OK;
}

API(fmi2Status, fmi2DeSerializeFMUstate)(fmi2Component of, const char bytes[], size_t size,
                                         void **state) {
    if (size != sizeof(saved_line))
        return tell((fmu *)of, fmi2Error, "these bytes are no state of this model");
    if (*state == NULL) *state = malloc(sizeof(saved_line));
    if (*state == NULL) return tell((fmu *)of, fmi2Error, "no memory for a saved state");
    memcpy(*state, bytes, sizeof(saved_line));
    return fmi2OK;
}

#include "fmi2_unoffered.h"
