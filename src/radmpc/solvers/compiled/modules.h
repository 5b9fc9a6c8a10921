/* What the module is made of. */
#ifndef RADMPC_MODULES_H
#define RADMPC_MODULES_H

#include "arrays.h"

PyObject *program_type(void);
PyObject *ratings_type(void);
extern PyMethodDef rating_functions[];

#endif
