"""What would help where there is no plan, or hardly room for one: tried before it is told."""
