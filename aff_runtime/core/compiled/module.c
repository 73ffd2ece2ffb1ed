/* The law's arithmetic for Python: `core.compiled.binary.Arithmetic` says what is here.
 *
 * Built on the limited API, so that one binary serves every Python from 3.11 on. */
#include "arrays.h"

enum { MOST_TICKS = 1000 }; /* so that no call takes long */

/* ---- the loop's convolution: ring, tails, reversed, place, out ---- */

static loop_filter loop_of(call *c, double **out)
{
    const long row = count_of(c, 4, 1), length = count_of(c, 0, 2 * row);
    loop_filter p = {.row = row, .length = length};
    p.ring = DOUBLES(c, 2 * length * row);
    p.tail = DOUBLES(c, 2 * BLOCK * row);
    p.reversed = DOUBLES(c, BLOCK + length);
    p.place = WHOLES(c, 2);
    *out = DOUBLES(c, row);
    if (PyErr_Occurred()) return p;
    const int64_t at = p.place[0], read = p.place[1];
    if (length % BLOCK || row % 4 || at < 0 || at >= length || read < 0 || read > 1)
        PyErr_Format(PyExc_ValueError, "%s: %ld rows of %ld, at %ld, tail %ld", c->name, length,
                     row, (long)at, (long)read);
    return p;
}

static PyObject *py_loop_push(PyObject *m, PyObject *const *args, Py_ssize_t given)
{
    (void)m;
    call c;
    double *out;
    if (begin(&c, "loop_push", args, given, 5) < 0) return NULL;
    loop_filter p = loop_of(&c, &out);
    const double *b = GUESTS(&c, p.row / 2), *weight = GUESTS(&c, p.row / 2);
    const double ratio = number(&c);
    const long ticks = whole(&c);
    if (!PyErr_Occurred() && (ticks < 0 || ticks > MOST_TICKS))
        PyErr_Format(PyExc_ValueError, "loop_push: %ld ticks, 0 to %d wanted", ticks, MOST_TICKS);
    if (!PyErr_Occurred()) loop_push(&p, b, weight, ratio, ticks);
    RETURN_NONE;
}

static PyObject *py_loop_read(PyObject *m, PyObject *const *args, Py_ssize_t given)
{
    (void)m;
    call c;
    double *out;
    if (begin(&c, "loop_read", args, given, 1) < 0) return NULL;
    loop_filter p = loop_of(&c, &out);
    if (!PyErr_Occurred()) loop_read(&p, out);
    RETURN_NONE;
}

/* ---- the Kalman filter: drift, state, covariance, h, gain, start, turn_s ---- */

static shape_filter filter_of(call *c)
{
    const long n = count_of(c, 0, 1), size = 4 * n + 1;
    shape_filter p = {.n = n, .drift = DOUBLES(c, n)};
    p.state = DOUBLES(c, size);
    p.covariance = DOUBLES(c, size * size);
    p.h = DOUBLES(c, size);
    p.gain = DOUBLES(c, size);
    p.start = DOUBLES(c, size);
    p.turn_s = DOUBLES(c, n);
    return p;
}

static PyObject *py_filter_update(PyObject *m, PyObject *const *args, Py_ssize_t given)
{
    (void)m;
    call c;
    if (begin(&c, "filter_update", args, given, 8) < 0) return NULL;
    shape_filter p = filter_of(&c);
    const double *phi = GUESTS(&c, 2 * p.n);
    double *psi = GUESTS(&c, 2 * p.n);
    const double error = number(&c);
    p.sd = number(&c);
    p.news_limit = number(&c);
    const long first = whole(&c), imbalance = whole(&c);
    if (!PyErr_Occurred() && (first >= p.n || imbalance >= p.n || (imbalance >= 0 && first < 0)))
        PyErr_Format(PyExc_ValueError, "no columns %ld and %ld of %ld", first, imbalance, p.n);
    if (PyErr_Occurred()) return NULL;
    return PyFloat_FromDouble(filter_update(&p, error, phi, psi, first, imbalance));
}

static PyObject *py_filter_predict(PyObject *m, PyObject *const *args, Py_ssize_t given)
{
    (void)m;
    call c;
    if (begin(&c, "filter_predict", args, given, 8) < 0) return NULL;
    shape_filter p = filter_of(&c);
    const double *phi = GUESTS(&c, 2 * p.n);
    c.guest++; /* psi, of the update */
    const double *turn_s = GUESTS(&c, p.n);
    const double *of = GUESTS(&c, 5);
    const double passed_s = number(&c), dt_s = number(&c);
    p.sd = number(&c);
    p.memory_turns = number(&c);
    if (PyErr_Occurred()) return NULL;
    const drift_numbers numbers = {of[0], of[1], of[2], of[3], of[4]};
    filter_predict(&p, &numbers, phi, turn_s, passed_s, dt_s);
    Py_RETURN_NONE;
}

/* ---- the monitor: pull, phasor, size, now, age, slow, bad, lost, judged, rest, without, astray,
 * meets, share, numbers ---- */

static shape_monitor monitor_of(call *c, monitor_numbers *numbers)
{
    const long n = count_of(c, 0, 1);
    shape_monitor p = {.n = n, .pull = DOUBLES(c, n)};
    double **each[] = {&p.size, &p.now, &p.age, &p.slow, &p.bad, &p.lost, &p.judged, &p.rest,
                       &p.without};
    p.phasor = DOUBLES(c, 2 * n);
    for (unsigned i = 0; i < sizeof each / sizeof *each; i++) *each[i] = DOUBLES(c, n);
    p.astray = FLAGS(c, n);
    p.meets = FLAGS(c, n);
    p.share = DOUBLES(c, n);
    const double *of = DOUBLES(c, 8);
    if (of) *numbers = (monitor_numbers){of[0], of[1], of[2], of[3], of[4], of[5], of[6], of[7]};
    return p;
}

static PyObject *py_monitor_hear(PyObject *m, PyObject *const *args, Py_ssize_t given)
{
    (void)m;
    call c;
    monitor_numbers numbers;
    if (begin(&c, "monitor_hear", args, given, 4) < 0) return NULL;
    shape_monitor p = monitor_of(&c, &numbers);
    const double *turn_s = GUESTS(&c, p.n);
    const double passed_s = number(&c), dt_s = number(&c);
    if (!PyErr_Occurred()) monitor_hear(&p, &numbers, turn_s, passed_s, dt_s);
    RETURN_NONE;
}

static PyObject *py_monitor_follow(PyObject *m, PyObject *const *args, Py_ssize_t given)
{
    (void)m;
    call c;
    monitor_numbers numbers;
    if (begin(&c, "monitor_follow", args, given, 3) < 0) return NULL;
    shape_monitor p = monitor_of(&c, &numbers);
    c.guest++; /* turn_s, of monitor_hear */
    const double *phi = GUESTS(&c, 2 * p.n);
    const double error = number(&c);
    if (!PyErr_Occurred()) monitor_follow(&p, error, phi);
    RETURN_NONE;
}

static PyObject *py_monitor_judge(PyObject *m, PyObject *const *args, Py_ssize_t given)
{
    (void)m;
    call c;
    monitor_numbers numbers;
    if (begin(&c, "monitor_judge", args, given, 9) < 0) return NULL;
    shape_monitor p = monitor_of(&c, &numbers);
    const double *turn_s = GUESTS(&c, p.n);
    c.guest++; /* phi, of monitor_follow */
    const double *deviation = GUESTS(&c, 2 * p.n), *ratio = GUESTS(&c, 2 * p.n);
    const double passed_s = number(&c), dt_s = number(&c), sd = number(&c);
    const long first = whole(&c), imbalance = whole(&c);
    if (!PyErr_Occurred() && (first >= p.n || imbalance >= p.n || (imbalance >= 0 && first < 0)))
        PyErr_Format(PyExc_ValueError, "no columns %ld and %ld of %ld", first, imbalance, p.n);
    if (PyErr_Occurred()) return NULL;
    return PyBool_FromLong(monitor_judge(&p, &numbers, deviation, ratio, turn_s, passed_s, dt_s,
                                         sd, first, imbalance));
}

/* ---- the basis: order, owns, roll_of, per_roll, arm, turns, low, before, b, fade, Hz, numbers;
 * the phases of its rolls ---- */

enum { RADIUS, THETA, OMEGA, NAMES };
static PyObject *phase_names[NAMES];

static int read_roll(shape_basis *p, const basis_numbers *numbers, long roll, PyObject *phase,
                     double speed_m_s, double slope_m_s2)
{
    double found[NAMES];
    if (!phase) return -1;
    Py_INCREF(phase); /* the list may lose it while it is asked */
    for (int k = 0; k < NAMES && !PyErr_Occurred(); k++) {
        PyObject *value = PyObject_GetAttr(phase, phase_names[k]);
        found[k] = value ? PyFloat_AsDouble(value) : 0.0;
        Py_XDECREF(value);
    }
    Py_DECREF(phase);
    if (PyErr_Occurred()) return -1;
    basis_read(p, numbers, roll, found[RADIUS], found[THETA], found[OMEGA], speed_m_s, slope_m_s2);
    return 0;
}

static PyObject *py_basis_step(PyObject *m, PyObject *const *args, Py_ssize_t given)
{
    (void)m;
    call c;
    if (begin(&c, "basis_step", args, given, 5) < 0) return NULL;
    const long n = count_of(&c, 0, 1);
    shape_basis p = {.n = n, .order = DOUBLES(&c, n)};
    p.owns = DOUBLES(&c, n);
    p.roll_of = WHOLES(&c, n);
    p.rolls = count_of(&c, 3, 6);
    p.per_roll = DOUBLES(&c, 6 * p.rolls);
    p.arm = DOUBLES(&c, 2 * n);
    p.turns = DOUBLES(&c, 6 * n);
    p.low = DOUBLES(&c, 4 * n);
    p.before = DOUBLES(&c, 4 * n);
    p.b = DOUBLES(&c, 2 * n);
    p.fade = DOUBLES(&c, n);
    p.frequency_Hz = DOUBLES(&c, n);
    const double *of = DOUBLES(&c, 6);
    PyObject *phases = args[c.next++];
    const double speed_m_s = number(&c), slope_m_s2 = number(&c), dt_s = number(&c);
    if (PyErr_Occurred()) return NULL;
    const basis_numbers numbers = {of[0], of[1], of[2], of[3], of[4], of[5]};
    if (!PyList_Check(phases) || PyList_Size(phases) != p.rolls)
        return PyErr_Format(PyExc_ValueError, "basis_step: a list of %ld phases wanted", p.rolls);
    for (long i = 0; i < p.rolls; i++)
        if (read_roll(&p, &numbers, i, PyList_GetItem(phases, i), speed_m_s, slope_m_s2) < 0)
            return NULL;
    /* only now: to read the attributes of a phase may run any Python code */
    for (long i = 0; i < n; i++)
        if (p.roll_of[i] < 0 || p.roll_of[i] >= p.rolls)
            return PyErr_Format(PyExc_ValueError, "column %ld: no roll %ld", i,
                                (long)p.roll_of[i]);
    basis_step(&p, &numbers, dt_s);
    Py_RETURN_NONE;
}

/* ---- the law: weight, step_1_s, deviation, ratio, rest, held; turn_s ---- */

static PyObject *py_newton_step(PyObject *m, PyObject *const *args, Py_ssize_t given)
{
    (void)m;
    call c;
    if (begin(&c, "newton_step", args, given, 9) < 0) return NULL;
    const long n = count_of(&c, 0, 2);
    double *weight = DOUBLES(&c, 2 * n), *step_1_s = DOUBLES(&c, n);
    const double *deviation = DOUBLES(&c, 2 * n), *ratio = DOUBLES(&c, 2 * n);
    const double *turn_s = GUESTS(&c, n);
    const double *rest = optional(&c, n, REAL);
    const flag *held = optional(&c, n, FLAG);
    const double turns = number(&c), from = number(&c), to = number(&c);
    const double limit_m = number(&c), dt_s = number(&c);
    if (!PyErr_Occurred())
        newton_step(n, weight, step_1_s, deviation, ratio, turn_s, rest, held, turns, from, to,
                    limit_m, dt_s);
    RETURN_NONE;
}

/* ---- sending: weight, b, carrier, factor, three shares, step_1_s, order, sent, parts, and of the
 * bound its orders, order_of, cosines, sines, sums; omega_rad_s ---- */

static PyObject *step_names[3];

/* a class of Python's own making, straight from object: its objects need none of its code */
static int is_plain_class(PyObject *given)
{
    if (!PyType_Check(given)) return 0;
    PyTypeObject *type = (PyTypeObject *)given;
    return PyType_GetFlags(type) & Py_TPFLAGS_HEAPTYPE &&
           PyType_GetSlot(type, Py_tp_base) == &PyBaseObject_Type &&
           PyType_GetSlot(type, Py_tp_new) == PyType_GetSlot(&PyBaseObject_Type, Py_tp_new);
}

/* ActuatorStep(value=..., peak_bound=..., slew_bound=...), without its Python code */
static PyObject *step_of(PyObject *type, const double found[3])
{
    PyObject *step = PyType_GenericNew((PyTypeObject *)type, NULL, NULL);
    for (int k = 0; k < 3 && step; k++) {
        PyObject *value = PyFloat_FromDouble(found[k]);
        if (!value || PyObject_GenericSetAttr(step, step_names[k], value) < 0) Py_CLEAR(step);
        Py_XDECREF(value);
    }
    return step;
}

static PyObject *py_send(PyObject *m, PyObject *const *args, Py_ssize_t given)
{
    (void)m;
    call c;
    double found[3];
    if (begin(&c, "send", args, given, 7) < 0) return NULL;
    PyObject *step_type = args[c.next++];
    if (!is_plain_class(step_type)) return PyErr_Format(PyExc_TypeError, "send: no class given");
    const long n = count_of(&c, 0, 2);
    sending p = {.n = n, .weight = DOUBLES(&c, 2 * n)};
    p.b = DOUBLES(&c, 2 * n);
    p.carrier = DOUBLES(&c, 2 * n);
    p.factor = DOUBLES(&c, 2 * n);
    for (int k = 0; k < 3; k++) p.shares[k] = DOUBLES(&c, n);
    p.step_1_s = DOUBLES(&c, n);
    p.order = DOUBLES(&c, n);
    p.sent = DOUBLES(&c, 2 * n);
    p.parts = DOUBLES(&c, 2 * n);
    const long orders = count_of(&c, c.own, 1);
    peak_bound bound = {.orders = orders, .order = DOUBLES(&c, orders)};
    bound.order_of = WHOLES(&c, n);
    bound.points = count_of(&c, c.own, orders);
    bound.cosines = DOUBLES(&c, orders * bound.points);
    bound.sines = DOUBLES(&c, orders * bound.points);
    bound.sums = DOUBLES(&c, 4 * orders + 8 * bound.points);
    p.omega_rad_s = GUESTS(&c, n);
    const double gate = number(&c), ramp_s = number(&c);
    bound.slack = number(&c);
    p.at = whole(&c);
    if (PyErr_Occurred()) return NULL;
    for (long i = 0; i < n; i++)
        if (bound.order_of[i] >= orders || p.at < 0 || p.at >= n)
            return PyErr_Format(PyExc_ValueError, "column %ld: no such order", i);
    law_send(&p, &bound, gate, ramp_s, found);
    return step_of(step_type, found);
}

#define KERNEL(name) {#name, (PyCFunction)(void (*)(void))py_##name, METH_FASTCALL, NULL}
static PyMethodDef kernels[] = {
    KERNEL(loop_push),      KERNEL(loop_read),    KERNEL(filter_update), KERNEL(filter_predict),
    KERNEL(monitor_hear),   KERNEL(monitor_follow), KERNEL(monitor_judge), KERNEL(basis_step),
    KERNEL(newton_step),    KERNEL(send),         {NULL, NULL, 0, NULL}};

static int prepare(PyObject *module)
{
    static const char *const of_phase[] = {"radius_m", "theta_rad", "omega_rad_s"};
    static const char *const of_step[] = {"value", "peak_bound", "slew_bound"};
    for (int k = 0; k < 3; k++) {
        phase_names[k] = PyUnicode_InternFromString(of_phase[k]);
        step_names[k] = PyUnicode_InternFromString(of_step[k]);
        if (!phase_names[k] || !step_names[k]) return -1;
    }
    PyObject *numpy = PyImport_ImportModule("numpy");
    if (!numpy) return -1;
    Py_CLEAR(numpy_array);
    numpy_array = PyObject_GetAttrString(numpy, "ndarray");
    Py_DECREF(numpy);
    if (!numpy_array) return -1;
    if (!arrays_type) arrays_type = PyType_FromSpec(&arrays_spec);
    return arrays_type ? PyModule_AddObjectRef(module, "Arrays", arrays_type) : -1;
}

static PyModuleDef_Slot module_slots[] = {{Py_mod_exec, prepare}, {0, NULL}};
static struct PyModuleDef module = {
    PyModuleDef_HEAD_INIT, "_arithmetic", NULL, 0, kernels, module_slots, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit__arithmetic(void) { return PyModuleDef_Init(&module); }
