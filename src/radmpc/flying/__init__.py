"""Plans under way: what is left of the risk bound, and what may be flown instead."""
