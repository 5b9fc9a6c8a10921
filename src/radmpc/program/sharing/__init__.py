"""Rows that programs of several sets of a fleet have in common."""
