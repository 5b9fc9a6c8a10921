/* Rating as a Python type, and the choice of an avoidance as a function. */
#include "arrays.h"
#include "modules.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is rated never changes: its arrays are those of Python, held. */
typedef struct {
    PyObject_HEAD
    Ratings ratings;
    Arrays arrays;
} RatingsObject;

static Ratings *ratings_of(PyObject *self) { return &((RatingsObject *)self)->ratings; }

static int is_sparse(const Arrays *arrays, int first, int columns, Matrix *matrix, int *rows) {
    const int *starts = AT(*arrays, first);
    Py_ssize_t count = arrays->sizes[first] - 1, entries = arrays->sizes[first + 1];
    if (count < 0 || starts[0] != 0 || starts[count] != entries || arrays->sizes[first + 2] != entries) return 0;
    for (Py_ssize_t i = 0; i < count; i++)
        if (starts[i + 1] < starts[i]) return 0;
    if (!are_below(AT(*arrays, first + 1), entries, columns)) return 0;
    matrix->starts = AT(*arrays, first);
    matrix->indices = AT(*arrays, first + 1);
    matrix->values = AT(*arrays, first + 2);
    *rows = (int)count;
    return 1;
}

enum { OUTPUTS, NORMALS = 3, CONSTANT = 6, OFFSETS, DEVIATIONS, TABLE, STARTS, ROWS, EVENTS, NUM_ARRAYS };

static const char *fill(Ratings *r, const Arrays *arrays, int num_columns, int num_events, int samples) {
    if (num_columns < 0 || num_events < 0 || samples < 0) return "counts >= 0";
    if (!is_sparse(arrays, OUTPUTS, num_columns, &r->outputs, &r->num_outputs)) return "outputs are no matrix";
    if (!is_sparse(arrays, NORMALS, r->num_outputs, &r->normals, &r->num_rows)) return "rows are no matrix";
    Py_ssize_t rows = r->num_rows, alternatives = arrays->sizes[STARTS] - 1;
    if (arrays->sizes[CONSTANT] != r->num_outputs) return "a constant per output";
    for (int i = OFFSETS; i <= DEVIATIONS; i++)
        if (arrays->sizes[i] != rows) return "a number per row";
    if (arrays->sizes[EVENTS] != rows || !are_below(AT(*arrays, EVENTS), rows, num_events)) return "no such event";
    const int *starts = AT(*arrays, STARTS), *table = AT(*arrays, TABLE);
    if (alternatives < 0 || starts[0] != 0 || starts[alternatives] != arrays->sizes[ROWS]) return "no such entries";
    for (Py_ssize_t a = 0; a < alternatives; a++)
        if (starts[a + 1] < starts[a]) return "no such entries";
    if (!are_below(AT(*arrays, ROWS), arrays->sizes[ROWS], r->num_rows)) return "no such row";
    for (Py_ssize_t t = 0; t < arrays->sizes[TABLE]; t++)
        if (table[t] < -1 || table[t] >= alternatives) return "no such alternative";
    r->num_columns = num_columns;
    r->num_alternatives = (int)alternatives;
    r->num_avoidances = r->width ? (int)(arrays->sizes[TABLE] / r->width) : 0;
    r->num_events = num_events;
    r->samples = samples;
    r->log_beta = samples ? log_beta(0.5 * samples, 0.5) : 0.0;
    r->is_distinct = num_events == r->num_rows && arrays->sizes[ROWS] == alternatives;
    for (Py_ssize_t a = 0; a < alternatives; a++) r->is_distinct &= starts[a + 1] == starts[a] + 1;
    r->constant = AT(*arrays, CONSTANT);
    r->offsets = AT(*arrays, OFFSETS);
    r->deviations = AT(*arrays, DEVIATIONS);
    r->table = AT(*arrays, TABLE);
    r->row_starts = AT(*arrays, STARTS);
    r->rows = AT(*arrays, ROWS);
    r->events = AT(*arrays, EVENTS);
    r->at = calloc((size_t)r->num_outputs + 1, sizeof(double));
    r->slacks = calloc((size_t)r->num_rows + 1, sizeof(double));
    r->least = calloc((size_t)r->width + 1, sizeof(double));
    r->event_clearances = malloc(((size_t)num_events + 1) * sizeof(double));
    r->chosen = malloc(((size_t)num_events + 1) * sizeof(int));
    for (int e = 0; r->event_clearances && e < num_events; e++) r->event_clearances[e] = NAN;
    return r->at && r->slacks && r->least && r->event_clearances && r->chosen ? NULL : "no memory";
}

static void release(Ratings *r) {
    void *all[] = {r->at, r->slacks, r->least, r->event_clearances, r->chosen};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
}

static PyObject *ratings_new(PyTypeObject *type, PyObject *args, PyObject *Py_UNUSED(named)) {
    PyObject *objects[NUM_ARRAYS], **o = objects;
    int num_columns, width, num_events, samples;
    double reference;
    if (!PyArg_ParseTuple(args, "OOOOOOOOOOOOOiiiid", &o[0], &o[1], &o[2], &o[3], &o[4], &o[5], &o[6], &o[7], &o[8],
                          &o[9], &o[10], &o[11], &o[12], &num_columns, &width, &num_events, &samples, &reference))
        return NULL;
    allocfunc allocate = (allocfunc)PyType_GetSlot(type, Py_tp_alloc);
    PyObject *self = allocate(type, 0);
    if (!self) return NULL;
    Arrays *arrays = &((RatingsObject *)self)->arrays;
    if (!arrays_look(arrays, objects, "iidiiddddiiii")) {
        Py_DECREF(self);
        return NULL;
    }
    ratings_of(self)->width = width;
    ratings_of(self)->reference = reference;
    const char *wrong = "a table of that width";
    if (width >= 0 && !(width && arrays->sizes[TABLE] % width))
        wrong = fill(ratings_of(self), arrays, num_columns, num_events, samples);
    if (!wrong) return self;
    Py_DECREF(self);
    PyErr_SetString(PyExc_ValueError, wrong);
    return NULL;
}

static void ratings_dealloc(PyObject *self) {
    PyTypeObject *type = Py_TYPE(self);
    release(ratings_of(self));
    arrays_release(&((RatingsObject *)self)->arrays);
    freefunc let_go = (freefunc)PyType_GetSlot(type, Py_tp_free);
    let_go(self);
    Py_DECREF(type);
}

static PyObject *rate(PyObject *self, PyObject *args) {
    PyObject *objects[5];
    int num_columns;
    if (!PyArg_ParseTuple(args, "iOOOOO", &num_columns, &objects[0], &objects[1], &objects[2], &objects[3],
                          &objects[4]))
        return NULL;
    Arrays arrays;
    if (!arrays_look(&arrays, objects, "dDDQD")) return NULL;
    Ratings *r = ratings_of(self);
    if (num_columns != r->num_columns || arrays.sizes[0] < num_columns || arrays.sizes[1] != r->num_rows ||
        arrays.sizes[2] != r->num_avoidances || arrays.sizes[3] != r->num_avoidances ||
        arrays.sizes[4] != (Py_ssize_t)r->num_avoidances * r->width)
        return arrays_refuse(&arrays, "arrays of other lengths");
    Rated into = {AT(arrays, 1), AT(arrays, 2), AT(arrays, 3), AT(arrays, 4), 0.0, 0.0};
    ratings_rate(r, AT(arrays, 0), &into);
    arrays_release(&arrays);
    return Py_BuildValue("dd", into.risk, into.largest);
}

static PyObject *choose(PyObject *Py_UNUSED(module), PyObject *args) {
    PyObject *objects[5];
    int by_weight;
    if (!PyArg_ParseTuple(args, "OOOOOp", &objects[0], &objects[1], &objects[2], &objects[3], &objects[4], &by_weight))
        return NULL;
    Arrays arrays;
    if (!arrays_look(&arrays, objects, "ddbdd")) return NULL;
    Py_ssize_t count = arrays.sizes[1], width = count ? arrays.sizes[0] / count : 0;
    if (arrays.sizes[0] != count * width || arrays.sizes[2] != count || arrays.sizes[3] != count ||
        arrays.sizes[4] != 3)
        return arrays_refuse(&arrays, "arrays of other lengths");
    int is_blunt = 0;
    int found = choose_avoidance((int)count, (int)width, AT(arrays, 0), AT(arrays, 1), AT(arrays, 2), AT(arrays, 3),
                                 by_weight, AT(arrays, 4), &is_blunt);
    arrays_release(&arrays);
    return Py_BuildValue("ii", found, is_blunt);
}

static PyMethodDef methods[] = {
    {"rate", rate, METH_VARARGS, "Rate a point: columns, point; clearances, cheapest, selection, shortfall to fill."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot slots[] = {
    {Py_tp_new, ratings_new},
    {Py_tp_dealloc, ratings_dealloc},
    {Py_tp_methods, methods},
    {Py_tp_doc, "A disjunctive chance-constrained program laid out for rating."},
    {0, NULL},
};

static PyType_Spec spec = {
    "radmpc.solvers._compiled.Ratings", sizeof(RatingsObject), 0, Py_TPFLAGS_DEFAULT, slots,
};

PyMethodDef rating_functions[] = {
    {"choose_avoidance", choose, METH_VARARGS,
     "Choose where to branch: shortfall, cheapest, decided, weights, factors, by weight."},
    {NULL, NULL, 0, NULL},
};

Ratings *ratings_in(PyObject *object) {
    if (PyType_GetSlot(Py_TYPE(object), Py_tp_dealloc) == (void *)ratings_dealloc) return ratings_of(object);
    PyErr_SetString(PyExc_TypeError, "expected Ratings");
    return NULL;
}

PyObject *ratings_type(void) { return PyType_FromSpec(&spec); }
