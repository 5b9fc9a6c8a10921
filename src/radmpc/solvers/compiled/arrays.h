/* Arrays that Python hands over: contiguous. */
#ifndef RADMPC_ARRAYS_H
#define RADMPC_ARRAYS_H

#define Py_LIMITED_API 0x030B0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>

/* Several arrays, released together. */
typedef struct {
    Py_buffer views[14];
    Py_ssize_t sizes[14];
    int count;
} Arrays;

#define AT(arrays, i) ((arrays).views[i].buf)

/* Look into arrays of the kinds named, 'd' for float64, 'i' for int32, 'q' for int64, 'b' for
 * bool or bytes, 'f' for float32, 'u' for uint32, in capitals what will be written; 0, with an error,
 * where one is none of its kind. */
int arrays_look(Arrays *arrays, PyObject *const *objects, const char *kinds);
void arrays_release(Arrays *arrays);

/* Release, and return an error. */
PyObject *arrays_refuse(Arrays *arrays, const char *what);
PyObject *arrays_no_memory(Arrays *arrays);

/* Values as bytes, for Python to look at as an array; to be filled where there are none yet (NULL). */
PyObject *bytes_of(const void *values, size_t size);

/* The integers of a tuple. */
typedef struct {
    int *values, count, room;
} Numbers;

/* Read those of a tuple; 0, with an error, where one is not from 0 to below `limit`. */
int numbers_read(Numbers *numbers, PyObject *tuple, int limit);

int are_below(const int *numbers, Py_ssize_t count, int limit);

#endif
