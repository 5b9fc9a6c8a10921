"""The disjunctive chance-constrained programme."""
