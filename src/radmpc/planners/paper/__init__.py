"""The algorithms of the RADMPC paper: Algorithm 1 (multi-vehicle) and Algorithm 2 (RADMPC)."""
