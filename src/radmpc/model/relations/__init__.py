"""Ranges that vehicles keep, goals that they share, and which vehicles obstacles concern."""
