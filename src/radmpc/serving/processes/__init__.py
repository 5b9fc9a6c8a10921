"""Processes that do what takes long, as the server sees them."""
