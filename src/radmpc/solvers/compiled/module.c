/* What searches do most, compiled: see the Python files that use it. */
#include "modules.h"

static int add_type(PyObject *module, const char *name, PyObject *type) {
    if (!type) return -1;
    int failed = PyModule_AddObjectRef(module, name, type);
    Py_DECREF(type);
    return failed;
}

static int begin_module(PyObject *module) {
    if (PyModule_AddFunctions(module, lattice_functions) || PyModule_AddFunctions(module, passing_functions)) return -1;
    return add_type(module, "Program", program_type()) || add_type(module, "Ratings", ratings_type()) ||
                   add_type(module, "RiskRows", risk_rows_type()) || add_type(module, "Nodes", nodes_type())
               ? -1
               : 0;
}

static PyModuleDef_Slot module_slots[] = {{Py_mod_exec, begin_module}, {0, NULL}};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "_compiled", "What searches do most, compiled.", 0, rating_functions,
    module_slots, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit__compiled(void) { return PyModuleDef_Init(&definition); }
