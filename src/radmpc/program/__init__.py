"""The disjunctive chance-constrained program."""
