"""Files: scenarios, plans, and the formats of other groups."""
