/* Arrays and arguments of the module's functions; a part of module.c.
 *
 * An `Arrays` holds what one part of a law owns. What a function is given besides (guests) is held
 * too and known again by identity: the same arrays come in every tick, and cost nothing then. */
#ifndef AFF_ARRAYS_H
#define AFF_ARRAYS_H

#define Py_LIMITED_API 0x030B0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "arithmetic.h"

/* ---- arrays: taken once, known by identity from then on ---- */

enum { SLOTS = 32 };

typedef struct {
    PyObject_HEAD
    int own;                  /* slots that were given at the start; the others are guests' */
    PyObject *array[SLOTS];
    Py_buffer view[SLOTS];
} arrays;

static int hold(arrays *self, int slot, PyObject *array)
{
    if (self->array[slot]) PyBuffer_Release(&self->view[slot]);
    Py_CLEAR(self->array[slot]);
    if (PyObject_GetBuffer(array, &self->view[slot], PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE) < 0)
        return -1;
    self->array[slot] = Py_NewRef(array);
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
        PyErr_Format(PyExc_ValueError, "%d arrays given, at most %d can be held", self->own, SLOTS);
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

/* ---- arguments: read one after the other, the first mistake is told in the end ---- */

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

static void *checked(call *c, int slot, Py_ssize_t bytes)
{
    if (PyErr_Occurred()) return NULL;
    const Py_ssize_t there = slot < SLOTS && c->held->array[slot] ? c->held->view[slot].len : -1;
    if (there == bytes) return c->held->view[slot].buf;
    PyErr_Format(PyExc_ValueError, "%s: array %d has %zd bytes, %zd wanted", c->name, slot, there,
                 bytes);
    return NULL;
}

/* the next of the arrays given at the start */
static void *own(call *c, Py_ssize_t count, Py_ssize_t each)
{
    const int slot = c->own++;
    return checked(c, slot < c->held->own ? slot : SLOTS, count * each);
}

/* the next argument, an array */
static void *guest(call *c, Py_ssize_t count, Py_ssize_t each)
{
    PyObject *array = c->args[c->next++];
    const int slot = c->guest++;
    if (PyErr_Occurred()) return NULL;
    if (slot < SLOTS && c->held->array[slot] != array && hold(c->held, slot, array) < 0) return NULL;
    return checked(c, slot, count * each);
}

/* the same, or None: NULL */
static void *optional(call *c, Py_ssize_t count, Py_ssize_t each)
{
    if (c->args[c->next] != Py_None) return guest(c, count, each);
    c->next++, c->guest++;
    return NULL;
}

static double number(call *c) { return PyFloat_AsDouble(c->args[c->next++]); }
static long whole(call *c) { return PyLong_AsLong(c->args[c->next++]); }
static Py_ssize_t bytes_of(call *c, int slot) { return c->held->view[slot].len; }

#define DOUBLES(c, count) ((double *)own(c, count, sizeof(double)))
#define FLAGS(c, count) ((flag *)own(c, count, sizeof(flag)))
#define GUESTS(c, count) ((double *)guest(c, count, sizeof(double)))
#define RETURN_NONE                          \
    do {                                     \
        if (PyErr_Occurred()) return NULL;   \
        Py_RETURN_NONE;                      \
    } while (0)

#endif
