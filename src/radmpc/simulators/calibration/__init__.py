"""Noise from a plan's own missions in a simulator, and what plans that know it are worth."""
