/* Lattice searches as functions. */
#include "arrays.h"
#include "modules.h"

#include <math.h>
#include <string.h>

static int is_shape(const Lattice *lattice) {
    return lattice->width > 0 && lattice->width % 2 && lattice->rows > 0 && lattice->columns > 0 &&
           lattice->width < 1000 && lattice->rows < 100000 && lattice->columns < 100000;
}

static Py_ssize_t size_of(const Lattice *lattice) {
    return (Py_ssize_t)lattice->width * lattice->width * lattice->rows * lattice->columns;
}

static int is_within(const Lattice *lattice, const Box *box) {
    return 0 <= box->row && box->row <= box->row_end && box->row_end <= lattice->rows && 0 <= box->column &&
           box->column <= box->column_end && box->column_end <= lattice->columns;
}

static PyObject *measured(PyObject *Py_UNUSED(module), PyObject *args) {
    PyObject *o[6];
    Lattice lattice = {0};
    Obstacle obstacle = {0};
    if (!PyArg_ParseTuple(args, "(iii)OOOOOO(dd)(dd)", &lattice.width, &lattice.rows, &lattice.columns, &o[0], &o[1],
                          &o[2], &o[3], &o[4], &o[5], &obstacle.longest[0], &obstacle.longest[1], &obstacle.least,
                          &obstacle.little))
        return NULL;
    Arrays arrays;
    if (!arrays_look(&arrays, o, "dddddd")) return NULL;
    const Py_ssize_t *sizes = arrays.sizes;
    if (!is_shape(&lattice) || sizes[0] != sizes[1] || sizes[0] % 3 || sizes[2] != lattice.rows ||
        sizes[3] != lattice.columns || sizes[4] != lattice.rows + lattice.width - 1 ||
        sizes[5] != lattice.columns + lattice.width - 1)
        return arrays_refuse(&arrays, "arrays of other lengths");
    obstacle.count = (int)(sizes[0] / 3);
    obstacle.here = AT(arrays, 0);
    obstacle.ahead = AT(arrays, 1);
    obstacle.x = AT(arrays, 2);
    obstacle.y = AT(arrays, 3);
    obstacle.x_ahead = AT(arrays, 4);
    obstacle.y_ahead = AT(arrays, 5);
    Slacks slacks;
    int is_done = lattice_measure(&lattice, &obstacle, &slacks);
    arrays_release(&arrays);
    PyObject *found = NULL;
    if (is_done) {
        size_t bits = slacks.is_blocked ? ((size_t)size_of(&lattice) + 7) / 8 : 0;
        found = Py_BuildValue("NNN", bytes_of(slacks.bits, bits),
                              bytes_of(slacks.numbers, slacks.count * sizeof *slacks.numbers),
                              bytes_of(slacks.values, slacks.count * sizeof *slacks.values));
    }
    slacks_free(&slacks);
    return is_done ? found : PyErr_NoMemory();
}

static PyObject *add_tails(PyObject *Py_UNUSED(module), PyObject *args) {
    PyObject *objects[4];
    float scale;
    if (!PyArg_ParseTuple(args, "OOOOf", &objects[0], &objects[1], &objects[2], &objects[3], &scale)) return NULL;
    Arrays arrays;
    if (!arrays_look(&arrays, objects, "Fuff")) return NULL;
    float *risks = AT(arrays, 0);
    const unsigned *numbers = AT(arrays, 1);
    const float *slacks = AT(arrays, 2), *tails = AT(arrays, 3);
    Py_ssize_t count = arrays.sizes[1];
    int half = (int)(arrays.sizes[3] / 2);
    if (arrays.sizes[2] != count || arrays.sizes[3] != 2 * half + 1)
        return arrays_refuse(&arrays, "arrays of other lengths");
    float most = (float)half;
    for (Py_ssize_t i = 0; i < count; i++) {
        if ((Py_ssize_t)numbers[i] >= arrays.sizes[0]) return arrays_refuse(&arrays, "no such displacement");
        float place = slacks[i] * scale;
        place = place < most ? place : most;
        risks[numbers[i]] += tails[half + (int)(place > -most ? place : -most)];
    }
    arrays_release(&arrays);
    Py_RETURN_NONE;
}

static int read_box(const Lattice *lattice, Box *box) { return is_shape(lattice) && is_within(lattice, box); }

static PyObject *change(PyObject *Py_UNUSED(module), PyObject *args) {
    PyObject *objects[3];
    Lattice lattice = {0};
    Box box;
    int axis;
    if (!PyArg_ParseTuple(args, "(iii)f(iiii)OOiO", &lattice.width, &lattice.rows, &lattice.columns,
                          &lattice.infeasible, &box.row, &box.row_end, &box.column, &box.column_end, &objects[0],
                          &objects[1], &axis, &objects[2]))
        return NULL;
    Arrays arrays;
    if (!arrays_look(&arrays, objects, "ffF")) return NULL;
    if (!read_box(&lattice, &box) || arrays.sizes[0] != size_of(&lattice) || arrays.sizes[2] != arrays.sizes[0] ||
        arrays.sizes[1] != (Py_ssize_t)lattice.width * lattice.width)
        return arrays_refuse(&arrays, "arrays of other lengths");
    lattice_change(&lattice, &box, AT(arrays, 0), AT(arrays, 1), axis, AT(arrays, 2));
    arrays_release(&arrays);
    Py_RETURN_NONE;
}

static PyObject *move(PyObject *Py_UNUSED(module), PyObject *args) {
    PyObject *objects[4];
    Lattice lattice = {0};
    Box from, to, *in_time;
    Toll toll;
    in_time = &toll.in_time;
    if (!PyArg_ParseTuple(args, "(iii)f(iiii)(iiii)OOO(fff)(iiii)O", &lattice.width, &lattice.rows, &lattice.columns,
                          &lattice.infeasible, &from.row, &from.row_end, &from.column, &from.column_end, &to.row,
                          &to.row_end, &to.column, &to.column_end, &objects[0], &objects[1], &objects[2],
                          &toll.weight, &toll.most, &toll.late, &in_time->row, &in_time->row_end, &in_time->column,
                          &in_time->column_end, &objects[3]))
        return NULL;
    Arrays arrays;
    if (!arrays_look(&arrays, objects, "ffbF")) return NULL;
    if (!read_box(&lattice, &from) || !read_box(&lattice, &to) || arrays.sizes[0] != size_of(&lattice) ||
        arrays.sizes[1] != arrays.sizes[0] || arrays.sizes[2] != (arrays.sizes[0] + 7) / 8 ||
        arrays.sizes[3] != arrays.sizes[0])
        return arrays_refuse(&arrays, "arrays of other lengths");
    toll.risks = AT(arrays, 1);
    toll.blocked = AT(arrays, 2);
    if (!lattice_move(&lattice, &from, &to, &toll, AT(arrays, 0), AT(arrays, 3))) return arrays_no_memory(&arrays);
    arrays_release(&arrays);
    Py_RETURN_NONE;
}

PyMethodDef lattice_functions[] = {
    {"lattice_slacks", measured, METH_VARARGS,
     "Measure what an obstacle leaves displacements: shape, half-planes here and ahead, axes, axes ahead, longest, "
     "bounds."},
    {"lattice_add_tails", add_tails, METH_VARARGS,
     "Add tails to risks: risks, numbers, slacks, table of tails, its entries per meter."},
    {"lattice_change", change, METH_VARARGS,
     "Change displacements along an axis: shape, infeasible, box, values, table, axis, into."},
    {"lattice_move", move, METH_VARARGS,
     "Move by displacements: shape, infeasible, boxes from and to, values, risks, blocked, (weight, most, late), box "
     "in time, into."},
    {NULL, NULL, 0, NULL},
};
