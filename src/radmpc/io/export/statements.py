"""What a reader of an export must know, as sentences for files and for the screen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.io.export.origin import Placement
from radmpc.io.text.files import one_line
from radmpc.model.ledger import bound_texts
from radmpc.model.plan import Plan

__all__ = ["height_sentence", "origin_sentence", "risk_sentence", "timing_sentence", "title"]

_LEAST_DIFFERENCE = 1.0
"""Difference of heights that is worth a warning [m]: altimeters are no better."""


def title(plan: Plan, vehicle: str | None = None) -> str:
    """Return what the file is of, in one line whatever the names hold.

    Parameters
    ----------
    plan : Plan
        What is exported.
    vehicle : str or None
        The one vehicle that the file holds; None is all.
    """
    whose = "" if vehicle is None else f", vehicle {vehicle}"
    return one_line(f"plan of {plan.scenario.name}{whose}, by radmpc")


def risk_sentence(plan: Plan, is_certified: bool) -> str:
    """Return what is certified, for the fleet as a whole.

    Parameters
    ----------
    plan : Plan
        What is exported.
    is_certified : bool
        Whether the certificate is within the risk bound.
    """
    if not is_certified or plan.risk.certified is None:
        return f"NOT certified within its risk bound {plan.scenario.risk_bound:g}"
    risk, bound = bound_texts(plan.risk.certified, plan.scenario.risk_bound)
    return (
        f"risk of any collision, whole fleet and whole mission: at most {risk}, risk bound {bound}"
    )


def timing_sentence(plan: Plan) -> str:
    """Return what waypoints leave out."""
    who = "the vehicle keeps" if plan.scenario.num_vehicles == 1 else "all vehicles keep"
    return (
        f"waypoints carry no time: the risk bound {plan.scenario.risk_bound:g} holds only if "
        f"{who} the plan's timing"
    )


def origin_sentence(placement: Placement) -> str:
    """Return where the plan's local coordinates are zero."""
    origin = placement.origin
    return (
        f"origin of the plan: latitude {origin.latitude:.9g}, longitude {origin.longitude:.9g}, "
        f"{origin.height:g} m above the WGS84 ellipsoid"
    )


def height_sentence(placement: Placement, paths: Sequence[Matrix]) -> str | None:
    """Return by how much heights above home or ground differ from the plan's own.

    Parameters
    ----------
    placement : Placement
        Where the plan lies.
    paths : sequence of (k, d) array
        Mean positions [m].

    Returns
    -------
    str or None
        None where it is less than a meter, or the plan has no heights of its own.
    """
    points = np.concatenate(paths)
    if points.shape[1] == 2:
        return None
    above = np.array(placement.levels(points)) - points[:, 2]
    worst = int(np.argmax(above))
    if above[worst] < _LEAST_DIFFERENCE:
        return None
    distance = float(np.hypot(*points[worst, :2])) / 1000.0
    return (
        f"heights are up to {above[worst]:.1f} m larger than the plan's z: {distance:.3g} km from "
        "its origin the ground lies as far below its plane"
    )
