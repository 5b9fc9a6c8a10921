"""Scenarios in units in which their numbers are of order one, and what was planned in them.

Solvers and geometry have absolute tolerances, of 1e-9 and so: a control limit of 1e-9, as of a
drifting platform in kilometers and seconds, is within all of them. So a scenario whose lengths or
control limits are far from one is planned in other units (`choosing`), as another scenario
(`scenario`), and what comes of it is carried back (`planned`). All factors are powers of two, so
nothing is rounded on either way.
"""
