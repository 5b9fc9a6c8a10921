"""Texts in and out: JSON and YAML with the line of every value."""
