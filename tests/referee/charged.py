"""Vehicles and the risks of their rows."""

from dataclasses import replace

import numpy as np
from referee_scenes import glider
from scipy.special import ndtr


def row_risks(certificate):
    return {(r.cause, r.vehicle, r.other, r.step): r.risk for r in certificate.ledger}


def turning_back():
    """A glider that goes 0.5 m to the right and returns, in and after a step of 2 s."""
    vehicle = glider("a", [0, 0], [0, 0], dt=2.0, noise=0.0, initial_covariance=np.eye(4) * 0.01)
    vehicle = replace(vehicle, start=np.array([0.0, 0.0, 1.0, 0.0]))
    return vehicle, np.array([[-1.0, 0.0], [1.0, 0.0]])


def beyond(limit):
    """How likely ``x(t) + p + v t`` exceeds a limit on the way of `turning_back`, exactly.

    p and v are the deviations at the start, 0.1 m and 0.1 m/s, and the only noise.
    """
    time = np.linspace(0.0, 4.0, 4001)
    mean = np.where(time < 2.0, time - time**2 / 2, (time - 2.0) ** 2 / 2 - (time - 2.0))
    nodes, weights = np.polynomial.hermite_e.hermegauss(80)
    furthest = (mean + 0.1 * nodes[:, None] * time).max(axis=1)
    return float(ndtr((furthest - limit) / 0.1) @ weights / weights.sum())
