/* What the module is made of. */
#ifndef RADMPC_MODULES_H
#define RADMPC_MODULES_H

#include "arrays.h"
#include "lp.h"
#include "rating.h"

PyObject *program_type(void);
PyObject *ratings_type(void);
PyObject *risk_rows_type(void);

/* What an object is made of; NULL, with an error, where it is of another type. */
Lp *program_in(PyObject *object);
Ratings *ratings_in(PyObject *object);

extern PyMethodDef rating_functions[];

#endif
