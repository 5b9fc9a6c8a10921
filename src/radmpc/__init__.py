"""Fast chance-constrained path planning for fleets."""
