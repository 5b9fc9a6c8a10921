"""Routes and paces through passages that are narrow, for vehicles in the plane."""
