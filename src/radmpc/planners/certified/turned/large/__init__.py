"""Large fleets: who shares a linear program, and who is left where they are."""
