"""Feedback, drift and memory by least squares, and what they leave open."""
