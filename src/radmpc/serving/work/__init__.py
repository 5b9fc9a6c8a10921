"""What worker processes do: plan, fly, simulate, look for causes. Only they load solvers."""
