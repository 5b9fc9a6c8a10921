"""Monte Carlo of the motion that is flown, feedback, curves and clipped controls among it."""
