"""Disturbance, its memory and measurement noise told apart by spectra of residuals."""
