"""Half-spaces of any direction, turned to the plan at hand again and again."""
