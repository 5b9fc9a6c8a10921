#include "arrays.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    char kind;
    size_t size;
    const char *formats, *name;
} Kind;

static const Kind KINDS[] = {
    {'d', sizeof(double), "d", "float64"},
    {'i', sizeof(int), "il", "int32"},
    {'q', sizeof(long long), "lq", "int64"},
    {'b', 1, "?bB", "bool"},
    {'f', sizeof(float), "f", "float32"},
    {'u', sizeof(unsigned), "IL", "uint32"},
};

/* Look into an array; -1, with an error, where it is none of the kind. */
static Py_ssize_t look(PyObject *array, char letter, Py_buffer *view) {
    const Kind *kind = KINDS;
    while (kind->kind != tolower(letter)) kind++;
    if (PyObject_GetBuffer(array, view, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) < 0) return -1;
    int is_kind = view->itemsize == (Py_ssize_t)kind->size && view->format && strchr(kind->formats, view->format[0]);
    if (is_kind && !(isupper(letter) && view->readonly)) return view->len / view->itemsize;
    PyBuffer_Release(view);
    if (is_kind) PyErr_SetString(PyExc_ValueError, "expected an array to be written");
    else PyErr_Format(PyExc_TypeError, "expected a contiguous array of %s", kind->name);
    return -1;
}

void arrays_release(Arrays *arrays) {
    while (arrays->count) PyBuffer_Release(&arrays->views[--arrays->count]);
}

int arrays_look(Arrays *arrays, PyObject *const *objects, const char *kinds) {
    arrays->count = 0;
    for (; *kinds; kinds++) {
        int i = arrays->count;
        arrays->sizes[i] = look(objects[i], *kinds, &arrays->views[i]);
        if (arrays->sizes[i] < 0) {
            arrays_release(arrays);
            return 0;
        }
        arrays->count++;
    }
    return 1;
}

PyObject *arrays_refuse(Arrays *arrays, const char *what) {
    arrays_release(arrays);
    PyErr_SetString(PyExc_ValueError, what);
    return NULL;
}

PyObject *arrays_no_memory(Arrays *arrays) {
    arrays_release(arrays);
    return PyErr_NoMemory();
}

PyObject *bytes_of(const void *values, size_t size) {
    return PyBytes_FromStringAndSize(values, (Py_ssize_t)size);
}

int numbers_read(Numbers *numbers, PyObject *tuple, int limit) {
    if (!PyTuple_Check(tuple)) {
        PyErr_SetString(PyExc_TypeError, "expected a tuple of alternatives");
        return 0;
    }
    Py_ssize_t count = PyTuple_Size(tuple);
    if (count > numbers->room) {
        int *larger = realloc(numbers->values, (size_t)count * 2 * sizeof *larger);
        if (!larger) {
            PyErr_NoMemory();
            return 0;
        }
        numbers->values = larger;
        numbers->room = (int)count * 2;
    }
    for (Py_ssize_t i = 0; i < count; i++) {
        long number = PyLong_AsLong(PyTuple_GetItem(tuple, i));
        if (number == -1 && PyErr_Occurred()) return 0;
        if (number < 0 || number >= limit) {
            PyErr_SetString(PyExc_ValueError, "no such alternative");
            return 0;
        }
        numbers->values[i] = (int)number;
    }
    numbers->count = (int)count;
    return 1;
}

int are_below(const int *numbers, Py_ssize_t count, int limit) {
    for (Py_ssize_t e = 0; e < count; e++)
        if (numbers[e] < 0 || numbers[e] >= limit) return 0;
    return 1;
}
