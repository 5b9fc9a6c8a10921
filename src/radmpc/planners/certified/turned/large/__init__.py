"""Large fleets: which vehicles share a linear program, and which stay as they are."""
