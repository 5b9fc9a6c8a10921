"""Monte Carlo simulation of the true motion, with feedback, curves and clipped controls."""
