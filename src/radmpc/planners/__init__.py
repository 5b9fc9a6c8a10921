"""The planning algorithms."""
