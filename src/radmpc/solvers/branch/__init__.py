"""Branch and bound over alternatives at fixed margins, vehicles apart while they can be."""
