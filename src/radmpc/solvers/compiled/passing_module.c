/* What moves along a route cost, as a function. */
#include "arrays.h"
#include "modules.h"

static PyObject *passing_costs(PyObject *Py_UNUSED(module), PyObject *args) {
    PyObject *objects[2];
    Passing passing = {0};
    if (!PyArg_ParseTuple(args, "OOi(ddd)p", &objects[0], &objects[1], &passing.moves, &passing.apart,
                          &passing.touching, &passing.price, &passing.is_along))
        return NULL;
    Arrays arrays;
    if (!arrays_look(&arrays, objects, "dd")) return NULL;
    const Py_ssize_t *sizes = arrays.sizes;
    const Py_ssize_t most = 1000000;
    if (sizes[0] % 2 || sizes[1] % 2 || sizes[1] < 2 || sizes[0] > most || sizes[1] > most || passing.moves < 1 ||
        passing.moves > most)
        return arrays_refuse(&arrays, "arrays of other lengths");
    passing.places = (int)(sizes[0] / 2);
    passing.steps = (int)(sizes[1] / 2) - 1;
    passing.route = AT(arrays, 0);
    passing.path = AT(arrays, 1);
    Costs costs;
    int is_done = passing_measure(&passing, &costs);
    arrays_release(&arrays);
    PyObject *found = NULL;
    if (is_done)
        found = Py_BuildValue("NNN", bytes_of(costs.steps, costs.count * sizeof *costs.steps),
                              bytes_of(costs.places, costs.count * sizeof *costs.places),
                              bytes_of(costs.costs, costs.count * (size_t)passing.moves * sizeof *costs.costs));
    costs_free(&costs);
    return is_done ? found : PyErr_NoMemory();
}

PyMethodDef passing_functions[] = {
    {"passing_costs", passing_costs, METH_VARARGS,
     "Measure what moves along a route cost where another vehicle passes: places, its path, moves, (apart, touching, "
     "price), whether distances count all along."},
    {NULL, NULL, 0, NULL},
};
