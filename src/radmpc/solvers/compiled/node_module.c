/* The nodes of a search as a Python type. */
#include "arrays.h"
#include "modules.h"
#include "node.h"

#include <stdlib.h>

/* It holds the chance rows, what is rated, and arrays of Python. */
typedef struct {
    PyObject_HEAD
    Nodes nodes;
    PyObject *rows, *ratings;
    Arrays arrays;
    Numbers chosen;
    int crowd, crowd_each;
} NodesObject;

enum { OWNERS, IS_REFINED, WEIGHTS, FACTORS, POINT, SELECTION, SHORTFALL, NUM_ARRAYS };

static const char *fill(Nodes *nodes, const Arrays *arrays) {
    const Ratings *r = nodes->ratings;
    const Py_ssize_t *sizes = arrays->sizes;
    Py_ssize_t avoidances = r->num_avoidances, alternatives = r->num_alternatives;
    if (nodes->rows->ratings != r) return "chance rows of another program";
    if (!avoidances) return "nothing to branch on";
    if (sizes[OWNERS] != alternatives || !are_below(AT(*arrays, OWNERS), alternatives, r->num_avoidances))
        return "an avoidance per alternative";
    if (sizes[IS_REFINED] != alternatives) return "a flag per alternative";
    if (sizes[WEIGHTS] != avoidances || sizes[SELECTION] != avoidances) return "a number per avoidance";
    if (sizes[FACTORS] != 3) return "three factors";
    if (sizes[POINT] != nodes->rows->num_columns) return "a number per decision variable";
    if (sizes[SHORTFALL] != avoidances * r->width) return "a shortfall per entry of the table";
    nodes->owners = AT(*arrays, OWNERS);
    nodes->is_refined = AT(*arrays, IS_REFINED);
    nodes->weights = AT(*arrays, WEIGHTS);
    nodes->factors = AT(*arrays, FACTORS);
    nodes->best_point = AT(*arrays, POINT);
    nodes->best_selection = AT(*arrays, SELECTION);
    nodes->rated.shortfall = AT(*arrays, SHORTFALL);
    return nodes_reserve(nodes) ? NULL : "no memory";
}

static PyObject *nodes_new(PyTypeObject *type, PyObject *args, PyObject *Py_UNUSED(named)) {
    PyObject *rows, *ratings, *objects[NUM_ARRAYS], **o = objects;
    Nodes nodes = {0};
    int crowd, crowd_each;
    if (!PyArg_ParseTuple(args, "OOOOOOOOO(ddddd)(ddd)(iiiii)", &rows, &ratings, &o[0], &o[1], &o[2], &o[3], &o[4], &o[5],
                          &o[6], &nodes.gap, &nodes.scale, &nodes.inside, &nodes.headroom, &nodes.tie,
                          &nodes.most_of_row, &nodes.most_risk, &nodes.missing, &nodes.rounds, &nodes.pivots,
                          &nodes.pivots_each, &crowd, &crowd_each))
        return NULL;
    nodes.rows = risk_rows_in(rows);
    nodes.ratings = nodes.rows ? ratings_in(ratings) : NULL;
    if (!nodes.ratings) return NULL;
    allocfunc allocate = (allocfunc)PyType_GetSlot(type, Py_tp_alloc);
    PyObject *self = allocate(type, 0);
    if (!self) return NULL;
    NodesObject *object = (NodesObject *)self;
    if (!arrays_look(&object->arrays, objects, "ibDdDQD")) {
        Py_DECREF(self);
        return NULL;
    }
    object->nodes = nodes;
    object->crowd = crowd;
    object->crowd_each = crowd_each;
    const char *wrong = fill(&object->nodes, &object->arrays);
    if (wrong) {
        Py_DECREF(self);
        PyErr_SetString(PyExc_ValueError, wrong);
        return NULL;
    }
    object->rows = Py_NewRef(rows);
    object->ratings = Py_NewRef(ratings);
    return self;
}

static void nodes_dealloc(PyObject *self) {
    PyTypeObject *type = Py_TYPE(self);
    NodesObject *object = (NodesObject *)self;
    nodes_release(&object->nodes);
    arrays_release(&object->arrays);
    free(object->chosen.values);
    Py_XDECREF(object->rows);
    Py_XDECREF(object->ratings);
    freefunc let_go = (freefunc)PyType_GetSlot(type, Py_tp_free);
    let_go(self);
    Py_DECREF(type);
}

/* Switch the node's alternatives on, and solve it. */
static NodeState solve_from(NodesObject *object, PyObject *basis, Node *node) {
    Nodes *nodes = &object->nodes;
    const Numbers *chosen = &object->chosen;
    int done = risk_rows_activate(nodes->rows, chosen->count, chosen->values, object->crowd, object->crowd_each);
    if (done < 0) return NODE_NO_MEMORY;
    if (!done) return NODE_CROWDED;
    if (PyBytes_Size(basis) && !basis_begin(nodes->rows->lp, basis)) return NODE_NO_MEMORY;
    return nodes_solve(nodes, chosen->count, chosen->values, node);
}

static PyObject *solve(PyObject *self, PyObject *args) {
    PyObject *tuple, *basis;
    Node node = {0};
    node.avoidance = -1;
    if (!PyArg_ParseTuple(args, "OSddp", &tuple, &basis, &node.bound, &node.value, &node.has_plan)) return NULL;
    NodesObject *object = (NodesObject *)self;
    if (!numbers_read(&object->chosen, tuple, object->nodes.ratings->num_alternatives)) return NULL;
    NodeState state = solve_from(object, basis, &node);
    if (state == NODE_NO_MEMORY) return PyErr_Occurred() ? NULL : PyErr_NoMemory();
    PyObject *vertex = state == NODE_OPEN ? basis_of(object->nodes.rows->lp) : PyBytes_FromStringAndSize(NULL, 0);
    if (!vertex) return NULL;
    return Py_BuildValue("idiiiNOdd", (int)state, node.bound, node.avoidance, node.solves, node.attempt, vertex,
                         node.is_better ? Py_True : Py_False, node.cost, node.risk);
}

static PyMethodDef methods[] = {
    {"solve", solve, METH_VARARGS, "Solve a node: alternatives, basis, its bound, the incumbent's value, if any."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot slots[] = {
    {Py_tp_new, nodes_new},
    {Py_tp_dealloc, nodes_dealloc},
    {Py_tp_methods, methods},
    {Py_tp_doc, "The nodes of a search at a price of risk."},
    {0, NULL},
};

static PyType_Spec spec = {
    "radmpc.solvers._compiled.Nodes", sizeof(NodesObject), 0, Py_TPFLAGS_DEFAULT, slots,
};

PyObject *nodes_type(void) { return PyType_FromSpec(&spec); }
