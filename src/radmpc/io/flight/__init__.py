"""Flight files, ``radmpc/flight/1``: a plan and what became of it, a line per tick."""
