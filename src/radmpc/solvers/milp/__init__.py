"""Mixed-integer programs with big-M rows, behind one protocol: HiGHS, SCIP, Gurobi."""
