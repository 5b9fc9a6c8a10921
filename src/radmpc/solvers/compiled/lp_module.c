/* The linear program as a Python type. Arrays are contiguous, of float64 and int32. */
#include "arrays.h"
#include "modules.h"

#include <string.h>

typedef struct {
    PyObject_HEAD
    Lp *lp;
} Program;

static Lp *program_of(PyObject *self) { return ((Program *)self)->lp; }

static PyObject *program_new(PyTypeObject *type, PyObject *args, PyObject *Py_UNUSED(named)) {
    PyObject *objects[3];
    double tolerance;
    if (!PyArg_ParseTuple(args, "OOOd", &objects[0], &objects[1], &objects[2], &tolerance)) return NULL;
    Arrays arrays;
    if (!arrays_look(&arrays, objects, "ddd")) return NULL;
    if (arrays.sizes[0] != arrays.sizes[1] || arrays.sizes[0] != arrays.sizes[2])
        return arrays_refuse(&arrays, "cost and bounds differ in length");
    allocfunc allocate = (allocfunc)PyType_GetSlot(type, Py_tp_alloc);
    PyObject *self = allocate(type, 0);
    if (self) {
        Lp *lp = lp_new((int)arrays.sizes[0], AT(arrays, 0), AT(arrays, 1), AT(arrays, 2), tolerance);
        ((Program *)self)->lp = lp;
        if (!lp) {
            Py_DECREF(self);
            return arrays_no_memory(&arrays);
        }
    }
    arrays_release(&arrays);
    return self;
}

static void program_dealloc(PyObject *self) {
    PyTypeObject *type = Py_TYPE(self);
    lp_free(program_of(self));
    freefunc release = (freefunc)PyType_GetSlot(type, Py_tp_free);
    release(self);
    Py_DECREF(type);
}

static PyObject *add_rows(PyObject *self, PyObject *args) {
    PyObject *objects[5];
    if (!PyArg_ParseTuple(args, "OOOOO", &objects[0], &objects[1], &objects[2], &objects[3], &objects[4]))
        return NULL;
    Arrays arrays;
    if (!arrays_look(&arrays, objects, "iiddd")) return NULL;
    Lp *lp = program_of(self);
    const int *starts = AT(arrays, 0), *columns = AT(arrays, 1);
    const double *values = AT(arrays, 2), *lower = AT(arrays, 3), *upper = AT(arrays, 4);
    Py_ssize_t count = arrays.sizes[3];
    if (arrays.sizes[0] != count + 1 || arrays.sizes[4] != count || arrays.sizes[1] != arrays.sizes[2])
        return arrays_refuse(&arrays, "rows differ in length");
    if (!are_below(columns, arrays.sizes[1], lp->num_columns)) return arrays_refuse(&arrays, "no such column");
    for (Py_ssize_t i = 0; i < count; i++)
        if (starts[i] < 0 || starts[i + 1] < starts[i] || starts[i + 1] > arrays.sizes[1])
            return arrays_refuse(&arrays, "no such entries");
    for (Py_ssize_t i = 0; i < count; i++)
        if (!lp_add_row(lp, starts[i + 1] - starts[i], columns + starts[i], values + starts[i], lower[i], upper[i]))
            return arrays_no_memory(&arrays);
    arrays_release(&arrays);
    Py_RETURN_NONE;
}

static PyObject *add_column(PyObject *self, PyObject *args) {
    PyObject *objects[2];
    double cost, upper;
    if (!PyArg_ParseTuple(args, "ddOO", &cost, &upper, &objects[0], &objects[1])) return NULL;
    Arrays arrays;
    if (!arrays_look(&arrays, objects, "id")) return NULL;
    Lp *lp = program_of(self);
    if (arrays.sizes[0] != arrays.sizes[1]) return arrays_refuse(&arrays, "rows and values differ in length");
    if (!are_below(AT(arrays, 0), arrays.sizes[0], lp->num_rows)) return arrays_refuse(&arrays, "no such row");
    if (!lp_add_column(lp, cost, upper, (int)arrays.sizes[0], AT(arrays, 0), AT(arrays, 1)))
        return arrays_no_memory(&arrays);
    arrays_release(&arrays);
    Py_RETURN_NONE;
}

static PyObject *bound_rows(PyObject *self, PyObject *args) {
    PyObject *objects[3];
    if (!PyArg_ParseTuple(args, "OOO", &objects[0], &objects[1], &objects[2])) return NULL;
    Arrays arrays;
    if (!arrays_look(&arrays, objects, "idd")) return NULL;
    Lp *lp = program_of(self);
    const int *rows = AT(arrays, 0);
    const double *lower = AT(arrays, 1), *upper = AT(arrays, 2);
    if (arrays.sizes[0] != arrays.sizes[1] || arrays.sizes[0] != arrays.sizes[2])
        return arrays_refuse(&arrays, "rows and bounds differ in length");
    if (!are_below(rows, arrays.sizes[0], lp->num_rows)) return arrays_refuse(&arrays, "no such row");
    for (Py_ssize_t e = 0; e < arrays.sizes[0]; e++) {
        lp->row_lower[rows[e]] = lower[e];
        lp->row_upper[rows[e]] = upper[e];
    }
    arrays_release(&arrays);
    Py_RETURN_NONE;
}

static PyObject *change_cost(PyObject *self, PyObject *cost) {
    Arrays arrays;
    if (!arrays_look(&arrays, &cost, "d")) return NULL;
    Lp *lp = program_of(self);
    if (arrays.sizes[0] != lp->num_columns) return arrays_refuse(&arrays, "a cost per column");
    memcpy(lp->cost, AT(arrays, 0), (size_t)lp->num_columns * sizeof(double));
    arrays_release(&arrays);
    Py_RETURN_NONE;
}

static PyObject *solve(PyObject *self, PyObject *args) {
    double cutoff, bound;
    long most;
    if (!PyArg_ParseTuple(args, "dl", &cutoff, &most)) return NULL;
    Outcome outcome = lp_solve(program_of(self), cutoff, most, &bound);
    if (outcome == LP_NO_MEMORY) return PyErr_NoMemory();
    return Py_BuildValue("id", (int)outcome, bound);
}

static PyObject *point(PyObject *self, PyObject *into) {
    Arrays arrays;
    if (!arrays_look(&arrays, &into, "D")) return NULL;
    Lp *lp = program_of(self);
    if (arrays.sizes[0] != lp->num_columns) return arrays_refuse(&arrays, "a number per column");
    memcpy(AT(arrays, 0), lp->x, (size_t)lp->num_columns * sizeof(double));
    arrays_release(&arrays);
    Py_RETURN_NONE;
}

PyObject *basis_of(const Lp *lp) {
    PyObject *bytes = PyBytes_FromStringAndSize(NULL, 2 * (Py_ssize_t)lp->size * (Py_ssize_t)sizeof(int));
    if (!bytes) return NULL;
    size_t half = (size_t)lp->size * sizeof(int);
    memcpy(PyBytes_AsString(bytes), lp->active, half);
    memcpy(PyBytes_AsString(bytes) + half, lp->basic, half);
    return bytes;
}

static PyObject *basis(PyObject *self, PyObject *Py_UNUSED(nothing)) { return basis_of(program_of(self)); }

int basis_begin(Lp *lp, PyObject *bytes) {
    char *data;
    Py_ssize_t length;
    if (PyBytes_AsStringAndSize(bytes, &data, &length) < 0) return 0;
    int size = (int)(length / (2 * (Py_ssize_t)sizeof(int)));
    const int *rows = (const int *)(const void *)data, *columns = rows + size;
    if (length % (2 * (Py_ssize_t)sizeof(int)) || !are_below(rows, size, lp->num_rows) ||
        !are_below(columns, size, lp->num_columns)) {
        PyErr_SetString(PyExc_ValueError, "no basis of this program");
        return 0;
    }
    if (lp_begin_with(lp, size, rows, columns)) return 1;
    PyErr_NoMemory();
    return 0;
}

static PyObject *begin_with(PyObject *self, PyObject *bytes) {
    if (!basis_begin(program_of(self), bytes)) return NULL;
    Py_RETURN_NONE;
}

/* All of it: cost, lower, upper; starts, columns, values, lower and upper of rows. */
static PyObject *contents(PyObject *self, PyObject *Py_UNUSED(nothing)) {
    const Lp *lp = program_of(self);
    Py_ssize_t entries = 0;
    for (int i = 0; i < lp->num_rows; i++) entries += lp->rows[i].size;
    PyObject *starts = bytes_of(NULL, ((size_t)lp->num_rows + 1) * sizeof(int));
    PyObject *columns = bytes_of(NULL, (size_t)entries * sizeof(int));
    PyObject *values = bytes_of(NULL, (size_t)entries * sizeof(double));
    if (!starts || !columns || !values) {
        Py_XDECREF(starts);
        Py_XDECREF(columns);
        Py_XDECREF(values);
        return NULL;
    }
    int at = 0, *start = (int *)(void *)PyBytes_AsString(starts);
    for (int i = 0; i < lp->num_rows; i++) {
        const Entries *row = &lp->rows[i];
        start[i] = at;
        memcpy((int *)(void *)PyBytes_AsString(columns) + at, row->indices, (size_t)row->size * sizeof(int));
        memcpy((double *)(void *)PyBytes_AsString(values) + at, row->values, (size_t)row->size * sizeof(double));
        at += row->size;
    }
    start[lp->num_rows] = at;
    size_t by_column = (size_t)lp->num_columns * sizeof(double), by_row = (size_t)lp->num_rows * sizeof(double);
    return Py_BuildValue("NNNNNNNN", bytes_of(lp->cost, by_column), bytes_of(lp->lower, by_column),
                         bytes_of(lp->upper, by_column), starts, columns, values,
                         bytes_of(lp->row_lower, by_row), bytes_of(lp->row_upper, by_row));
}

static PyObject *get_pivots(PyObject *self, void *Py_UNUSED(nothing)) {
    return PyLong_FromLong(program_of(self)->pivots);
}

static PyMethodDef methods[] = {
    {"add_rows", add_rows, METH_VARARGS, "Append rows: starts, columns, values, lower, upper."},
    {"add_column", add_column, METH_VARARGS, "Append a column >= 0: cost, upper, rows, values."},
    {"bound_rows", bound_rows, METH_VARARGS, "Change bounds: rows, lower, upper."},
    {"change_cost", change_cost, METH_O, "Change the cost of every column."},
    {"solve", solve, METH_VARARGS, "Minimize: cutoff, most pivots; outcome, proven bound."},
    {"point", point, METH_O, "Write the columns of the last solve into an array."},
    {"basis", basis, METH_NOARGS, "Return the basis of the last solve: active rows, basic columns."},
    {"begin_with", begin_with, METH_O, "Begin the next solve with a basis."},
    {"contents", contents, METH_NOARGS, "Return columns and rows, as bytes."},
    {NULL, NULL, 0, NULL},
};

static PyObject *get_num_rows(PyObject *self, void *Py_UNUSED(nothing)) {
    return PyLong_FromLong(program_of(self)->num_rows);
}

static PyObject *get_num_columns(PyObject *self, void *Py_UNUSED(nothing)) {
    return PyLong_FromLong(program_of(self)->num_columns);
}

static PyGetSetDef fields[] = {
    {"num_rows", get_num_rows, NULL, "Rows now.", NULL},
    {"num_columns", get_num_columns, NULL, "Columns now.", NULL},
    {"pivots", get_pivots, NULL, "Exchanges of the basis in all solves so far.", NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

static PyType_Slot slots[] = {
    {Py_tp_new, program_new},
    {Py_tp_dealloc, program_dealloc},
    {Py_tp_methods, methods},
    {Py_tp_getset, fields},
    {Py_tp_doc, "A linear program with bounded columns: cost, lower, upper, tolerance."},
    {0, NULL},
};

static PyType_Spec spec = {
    "radmpc.solvers._compiled.Program", sizeof(Program), 0, Py_TPFLAGS_DEFAULT, slots,
};

Lp *program_in(PyObject *object) {
    if (PyType_GetSlot(Py_TYPE(object), Py_tp_dealloc) == (void *)program_dealloc) return program_of(object);
    PyErr_SetString(PyExc_TypeError, "expected a Program");
    return NULL;
}

PyObject *program_type(void) { return PyType_FromSpec(&spec); }
