"""What comes of planning: trajectories, the content of a plan file, plans handed on under way."""
