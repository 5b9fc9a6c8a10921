"""Noise from a plan's own flights in a simulator, and what plans that know it are worth."""
