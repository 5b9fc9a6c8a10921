"""Missions whose every tick is written down, and recomputed from what was written alone."""
