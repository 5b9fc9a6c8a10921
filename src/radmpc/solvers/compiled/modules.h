/* What the module is made of. */
#ifndef RADMPC_MODULES_H
#define RADMPC_MODULES_H

#include "arrays.h"
#include "lattice.h"
#include "lp.h"
#include "passing.h"
#include "rating.h"
#include "risk_rows.h"

PyObject *program_type(void);
PyObject *ratings_type(void);
PyObject *risk_rows_type(void);
PyObject *nodes_type(void);

/* What an object is made of; NULL, with an error, where it is of another type. */
Lp *program_in(PyObject *object);
Ratings *ratings_in(PyObject *object);
RiskRows *risk_rows_in(PyObject *object);

/* A basis as bytes; begin a solve with one: 0, with an error, where it is none of this program. */
PyObject *basis_of(const Lp *lp);
int basis_begin(Lp *lp, PyObject *bytes);

extern PyMethodDef rating_functions[], lattice_functions[], passing_functions[];

#endif
