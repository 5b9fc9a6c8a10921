/* Chance rows in a linear program as a Python type. */
#include "arrays.h"
#include "modules.h"
#include "risk_rows.h"

#include <stdlib.h>

/* It holds the program, what is rated, and arrays of Python. */
typedef struct {
    PyObject_HEAD
    RiskRows rows;
    PyObject *program, *ratings;
    Arrays arrays;
    Numbers alternatives;
} RiskRowsObject;

static RiskRows *rows_of(PyObject *self) { return &((RiskRowsObject *)self)->rows; }

enum { DEVIATIONS, BLOCKS, BOUND_ROWS, HAS_BLOCK, FIRST, SLOPES, HEIGHTS, NUM_ARRAYS };

static const char *fill(RiskRows *rows, const Arrays *arrays) {
    const Py_ssize_t *sizes = arrays->sizes;
    Py_ssize_t bounds = sizes[BOUND_ROWS], blocks = bounds ? sizes[HAS_BLOCK] / bounds : 0;
    if (sizes[DEVIATIONS] != rows->ratings->num_rows) return "a deviation per row";
    if (sizes[HAS_BLOCK] != bounds * blocks || !are_below(AT(*arrays, BOUND_ROWS), bounds, rows->lp->num_rows))
        return "no such bounds";
    rows->num_columns = (int)sizes[BLOCKS];
    for (int output = 0; output < rows->ratings->num_outputs; output++) {
        const int *starts = rows->ratings->outputs.starts + output;
        if (!are_below(rows->ratings->outputs.indices + starts[0], starts[1] - starts[0], rows->num_columns))
            return "a block per decision variable";
    }
    if (rows->num_columns > rows->lp->num_columns || (bounds && !are_below(AT(*arrays, BLOCKS), sizes[BLOCKS], (int)blocks)))
        return "no such blocks";
    if (rows->budget_row < 0 || rows->budget_row >= rows->lp->num_rows) return "no such row";
    if (sizes[SLOPES] != sizes[FIRST] || sizes[HEIGHTS] != sizes[FIRST]) return "tangents differ in length";
    rows->deviations = AT(*arrays, DEVIATIONS);
    rows->blocks = AT(*arrays, BLOCKS);
    rows->bounds = (BoundRows){AT(*arrays, BOUND_ROWS), AT(*arrays, HAS_BLOCK), (int)bounds, (int)blocks};
    rows->first_clearances = AT(*arrays, FIRST);
    rows->first_slopes = AT(*arrays, SLOPES);
    rows->first_heights = AT(*arrays, HEIGHTS);
    rows->num_first = (int)sizes[FIRST];
    return risk_rows_reserve(rows) ? NULL : "no memory";
}

static PyObject *rows_new(PyTypeObject *type, PyObject *args, PyObject *Py_UNUSED(named)) {
    PyObject *program, *ratings, *objects[NUM_ARRAYS], **o = objects;
    RiskRows rows = {0};
    if (!PyArg_ParseTuple(args, "OOOOOOOOOidddddd", &program, &ratings, &o[0], &o[1], &o[2], &o[3], &o[4], &o[5], &o[6],
                          &rows.budget_row, &rows.unit, &rows.price, &rows.row_scale, &rows.row_cap, &rows.floor,
                          &rows.flat))
        return NULL;
    rows.lp = program_in(program);
    rows.ratings = rows.lp ? ratings_in(ratings) : NULL;
    if (!rows.ratings) return NULL;
    allocfunc allocate = (allocfunc)PyType_GetSlot(type, Py_tp_alloc);
    PyObject *self = allocate(type, 0);
    if (!self) return NULL;
    RiskRowsObject *object = (RiskRowsObject *)self;
    if (!arrays_look(&object->arrays, objects, "diibddd")) {
        Py_DECREF(self);
        return NULL;
    }
    object->rows = rows;
    const char *wrong = fill(&object->rows, &object->arrays);
    if (wrong) {
        Py_DECREF(self);
        PyErr_SetString(PyExc_ValueError, wrong);
        return NULL;
    }
    object->program = Py_NewRef(program);
    object->ratings = Py_NewRef(ratings);
    return self;
}

static void rows_dealloc(PyObject *self) {
    PyTypeObject *type = Py_TYPE(self);
    RiskRowsObject *object = (RiskRowsObject *)self;
    risk_rows_release(&object->rows);
    arrays_release(&object->arrays);
    free(object->alternatives.values);
    Py_XDECREF(object->program);
    Py_XDECREF(object->ratings);
    freefunc let_go = (freefunc)PyType_GetSlot(type, Py_tp_free);
    let_go(self);
    Py_DECREF(type);
}

static PyObject *activate(PyObject *self, PyObject *args) {
    PyObject *tuple;
    int crowd, crowd_each;
    if (!PyArg_ParseTuple(args, "Oii", &tuple, &crowd, &crowd_each)) return NULL;
    RiskRowsObject *object = (RiskRowsObject *)self;
    const Numbers *chosen = &object->alternatives;
    if (!numbers_read(&object->alternatives, tuple, object->rows.ratings->num_alternatives)) return NULL;
    int done = risk_rows_activate(&object->rows, chosen->count, chosen->values, crowd, crowd_each);
    return done < 0 ? PyErr_NoMemory() : PyBool_FromLong(done);
}

static PyObject *refine(PyObject *self, PyObject *args) {
    PyObject *objects[2];
    double tolerance;
    if (!PyArg_ParseTuple(args, "OOd", &objects[0], &objects[1], &tolerance)) return NULL;
    Arrays arrays;
    if (!arrays_look(&arrays, objects, "dd")) return NULL;
    RiskRows *rows = rows_of(self);
    if (arrays.sizes[0] != rows->ratings->num_rows || arrays.sizes[1] != rows->lp->num_columns)
        return arrays_refuse(&arrays, "arrays of other lengths");
    int added = risk_rows_refine(rows, AT(arrays, 0), AT(arrays, 1), tolerance);
    if (added < 0) return arrays_no_memory(&arrays);
    arrays_release(&arrays);
    return PyBool_FromLong(added);
}

static PyMethodDef methods[] = {
    {"activate", activate, METH_VARARGS, "Switch alternatives on, all others off, unless there are too many rows."},
    {"refine", refine, METH_VARARGS, "Add tangents where risk is underestimated: clearances, point, tolerance."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot slots[] = {
    {Py_tp_new, rows_new},
    {Py_tp_dealloc, rows_dealloc},
    {Py_tp_methods, methods},
    {Py_tp_doc, "Chance rows in a linear program, with a column each for their risk."},
    {0, NULL},
};

static PyType_Spec spec = {
    "radmpc.solvers._compiled.RiskRows", sizeof(RiskRowsObject), 0, Py_TPFLAGS_DEFAULT, slots,
};

RiskRows *risk_rows_in(PyObject *object) {
    if (PyType_GetSlot(Py_TYPE(object), Py_tp_dealloc) == (void *)rows_dealloc) return rows_of(object);
    PyErr_SetString(PyExc_TypeError, "expected RiskRows");
    return NULL;
}

PyObject *risk_rows_type(void) { return PyType_FromSpec(&spec); }
