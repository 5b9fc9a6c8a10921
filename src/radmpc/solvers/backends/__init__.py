"""Mixed-integer solvers behind one small protocol, one file each."""
