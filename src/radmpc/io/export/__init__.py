"""Plans in the formats of the vehicles' own tools: one format per file."""
