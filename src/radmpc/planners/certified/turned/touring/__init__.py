"""A first plan of vehicles on their way from visit to visit, each clear of those planned before."""
