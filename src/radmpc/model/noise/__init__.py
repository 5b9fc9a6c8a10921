"""Noise as it is measured: what it does to a vehicle whose dynamics are linear."""
