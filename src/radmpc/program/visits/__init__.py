"""Visits in a program: disjunctions over the steps at which they may take place, without risk.

A visit of one step is hard rows. Any other is a disjunction whose alternatives are steps, each with
rows for the mean position, and speed, at that step. Where the windows of consecutive visits
overlap, columns for their times, as shares of the horizon, keep them in order: the alternative of
step s fixes its visit's time at s / T, and times rise by 1 / T at least from visit to visit.
"""
