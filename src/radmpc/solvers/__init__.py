"""A program and margins in, a solution with its bound out."""
