/* Arrays and arguments of the module's functions; a part of module.c.
 *
 * An `Arrays` holds what one part of a law owns. What a function is given besides (guests) is held
 * too and known again by identity: the same arrays come in every tick, and cost nothing then.
 *
 * Whatever is given, no memory is read or written but that of the arrays, and no Python code runs
 * between the checks and the work: only arrays of numpy itself, floats and ints are taken, arrays
 * contiguous and of the kind of number and the size that the function asks for. */
#ifndef AFF_ARRAYS_H
#define AFF_ARRAYS_H

#define Py_LIMITED_API 0x030B0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <string.h>

#include "arithmetic.h"

/* ---- arrays: taken once, known by identity from then on ---- */

enum { SLOTS = 32, MOST = 1 << 20 }; /* arrays; entries of one, so that no product overflows */
enum { REAL = 'd', WHOLE = 'q', FLAG = '?' };

typedef struct {
    PyObject_HEAD
    int own;                  /* slots that were given at the start; the others are guests' */
    PyObject *array[SLOTS];
    Py_buffer view[SLOTS];
    char kind[SLOTS];         /* REAL (complex: pairs of them), WHOLE, FLAG; else 0 */
} arrays;

static PyObject *numpy_array; /* the class */

static char kind_of(const Py_buffer *view)
{
    const char *format = view->format ? view->format : "B";
    const Py_ssize_t each = view->itemsize;
    if (!strcmp(format, "Zd") && each == 2 * (Py_ssize_t)sizeof(double)) return REAL;
    if (format[0] == 0 || format[1] != 0) return 0; /* other byte orders, records */
    if (format[0] == 'd' && each == (Py_ssize_t)sizeof(double)) return REAL;
    const int is_whole = format[0] == 'l' || format[0] == 'q';
    if (is_whole && each == (Py_ssize_t)sizeof(int64_t)) return WHOLE;
    return format[0] == '?' && each == (Py_ssize_t)sizeof(flag) ? FLAG : 0;
}

static int hold(arrays *self, int slot, PyObject *array)
{
    if (self->array[slot]) PyBuffer_Release(&self->view[slot]);
    Py_CLEAR(self->array[slot]);
    self->kind[slot] = 0;
    self->view[slot].len = 0;
    if (!Py_IS_TYPE(array, (PyTypeObject *)numpy_array)) {
        PyErr_Format(PyExc_TypeError, "array %d is no numpy.ndarray", slot);
        return -1;
    }
    const int asked = PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE | PyBUF_FORMAT;
    if (PyObject_GetBuffer(array, &self->view[slot], asked) < 0) return -1;
    self->array[slot] = Py_NewRef(array);
    self->kind[slot] = kind_of(&self->view[slot]);
    return 0;
}

static PyObject *arrays_new(PyTypeObject *type, PyObject *given, PyObject *named)
{
    (void)named;
    allocfunc alloc = (allocfunc)PyType_GetSlot(type, Py_tp_alloc);
    arrays *self = (arrays *)alloc(type, 0);
    if (!self) return NULL;
    self->own = (int)PyTuple_Size(given);
    if (self->own > SLOTS) {
        PyErr_Format(PyExc_ValueError, "%d arrays given, at most %d can be held", self->own,
                     SLOTS);
        self->own = 0;
    } else {
        for (int i = 0; i < self->own && !PyErr_Occurred(); i++)
            hold(self, i, PyTuple_GetItem(given, i));
    }
    if (!PyErr_Occurred()) return (PyObject *)self;
    Py_DECREF(self);
    return NULL;
}

static void arrays_dealloc(PyObject *object)
{
    arrays *self = (arrays *)object;
    PyTypeObject *type = Py_TYPE(object);
    for (int i = 0; i < SLOTS; i++) {
        if (self->array[i]) PyBuffer_Release(&self->view[i]);
        Py_XDECREF(self->array[i]);
    }
    ((freefunc)PyType_GetSlot(type, Py_tp_free))(object);
    Py_DECREF(type);
}

static PyObject *arrays_type;

static PyType_Slot arrays_slots[] = {
    {Py_tp_new, arrays_new}, {Py_tp_dealloc, arrays_dealloc}, {0, NULL}};
static PyType_Spec arrays_spec = {
    "aff_runtime.core.compiled.Arrays", sizeof(arrays), 0, Py_TPFLAGS_DEFAULT, arrays_slots};

/* ---- arguments: read one after the other, the first mistake is raised at the end ---- */

typedef struct {
    const char *name;
    arrays *held;
    PyObject *const *args;
    Py_ssize_t given, next;
    int own, guest;
} call;

static int begin(call *c, const char *name, PyObject *const *args, Py_ssize_t given,
                 Py_ssize_t wanted)
{
    *c = (call){.name = name, .args = args, .given = given, .next = 1};
    if (given != wanted || !Py_IS_TYPE(args[0], (PyTypeObject *)arrays_type)) {
        PyErr_Format(PyExc_TypeError, "%s: %zd arguments given, Arrays and %zd more wanted", name,
                     given, wanted - 1);
        return -1;
    }
    c->held = (arrays *)args[0];
    c->guest = c->held->own;
    return 0;
}

static Py_ssize_t size_of_kind(char kind)
{
    return kind == REAL ? sizeof(double) : kind == WHOLE ? sizeof(int64_t) : sizeof(flag);
}

static void *checked(call *c, int slot, Py_ssize_t count, char kind)
{
    if (PyErr_Occurred()) return NULL;
    const int is_there = slot < SLOTS && c->held->array[slot];
    const Py_ssize_t there = is_there ? c->held->view[slot].len : -1;
    const Py_ssize_t bytes = count * size_of_kind(kind);
    if (!is_there || there != bytes)
        PyErr_Format(PyExc_ValueError, "%s: array %d has %zd bytes, %zd wanted", c->name, slot,
                     there, bytes);
    else if (c->held->kind[slot] != kind)
        PyErr_Format(PyExc_TypeError, "%s: array %d holds other numbers than '%c'", c->name, slot,
                     kind);
    else
        return c->held->view[slot].buf;
    return NULL;
}

/* the next of the arrays given at the start */
static void *own(call *c, Py_ssize_t count, char kind)
{
    const int slot = c->own++;
    return checked(c, slot < c->held->own ? slot : SLOTS, count, kind);
}

/* the next argument, an array */
static void *guest(call *c, Py_ssize_t count, char kind)
{
    PyObject *array = c->args[c->next++];
    const int slot = c->guest++;
    if (PyErr_Occurred()) return NULL;
    const int is_new = slot < SLOTS && c->held->array[slot] != array;
    if (is_new && hold(c->held, slot, array) < 0) return NULL;
    return checked(c, slot, count, kind);
}

/* the same, or None: NULL */
static void *optional(call *c, Py_ssize_t count, char kind)
{
    if (c->args[c->next] != Py_None) return guest(c, count, kind);
    c->next++, c->guest++;
    return NULL;
}

/* the next argument, a number; no method of an object is asked for one */
static double number(call *c)
{
    PyObject *given = c->args[c->next++];
    if (PyErr_Occurred()) return -1.0;
    if (PyFloat_Check(given)) return PyFloat_AsDouble(given);
    if (PyLong_Check(given)) return PyLong_AsDouble(given);
    PyErr_Format(PyExc_TypeError, "%s: argument %zd is no number", c->name, c->next);
    return -1.0;
}

static long whole(call *c)
{
    PyObject *given = c->args[c->next++];
    if (PyErr_Occurred()) return -1;
    if (PyLong_Check(given)) return PyLong_AsLong(given);
    PyErr_Format(PyExc_TypeError, "%s: argument %zd is no whole number", c->name, c->next);
    return -1;
}

/* how many times `each` doubles are in an array, 1 to MOST */
static long count_of(call *c, int slot, long each)
{
    const Py_ssize_t bytes = slot < SLOTS ? c->held->view[slot].len : 0;
    const Py_ssize_t there = bytes / (Py_ssize_t)sizeof(double);
    const Py_ssize_t count = each > 0 ? there / each : 0;
    if (count >= 1 && count <= MOST) return (long)count;
    if (!PyErr_Occurred())
        PyErr_Format(PyExc_ValueError, "%s: array %d has %zd doubles", c->name, slot, there);
    return 1;
}

#define DOUBLES(c, count) ((double *)own(c, count, REAL))
#define FLAGS(c, count) ((flag *)own(c, count, FLAG))
#define WHOLES(c, count) ((int64_t *)own(c, count, WHOLE))
#define GUESTS(c, count) ((double *)guest(c, count, REAL))
#define RETURN_NONE                          \
    do {                                     \
        if (PyErr_Occurred()) return NULL;   \
        Py_RETURN_NONE;                      \
    } while (0)

#endif
