"""Paths of single vehicles on a lattice of positions and displacements."""
