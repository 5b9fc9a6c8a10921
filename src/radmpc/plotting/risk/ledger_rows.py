"""The rows of a ledger's picture: names and numbers."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.model.ledger import CAUSES, Hazard, hazards, risk_by_vehicle
from radmpc.model.plan import Plan
from radmpc.plotting.canvas.letters import shortened

__all__ = ["MAX_ROWS", "map_rows", "share_rows"]

MAX_ROWS = 20
"""Rows of the map, and bars, that are drawn; the rest shares one."""

_MAX_NAME = 12
"""Letters of a vehicle's or an obstacle's name; longer ones are shortened in the middle."""


def map_rows(plan: Plan, decades: int) -> tuple[list[str], Matrix]:
    """Return what may go wrong and its risk at every step, the largest first.

    Parameters
    ----------
    plan : Plan
        With a ledger.
    decades : int
        Causes that stay this many powers of ten below the largest get no row of their own.

    Returns
    -------
    names : list of str
        The 20 largest causes at most, and how many others there are.
    risks : (rows, T+1) array
        Risk; sums to the certificate [-].
    """
    found = hazards(plan.risk.ledger)
    risks = np.zeros((len(found), plan.scenario.horizon + 1))
    for row, hazard in enumerate(found):
        for step, risk in hazard.risks.items():
            risks[row, step] = risk
    large = risks.max(axis=1, initial=0.0) >= 10.0**-decades * risks.max(initial=0.0)
    shown = min(int(np.count_nonzero(large)), MAX_ROWS)
    names = [_cause_name(hazard) for hazard in found[:shown]]
    return _with_rest(names, risks)


def share_rows(plan: Plan) -> tuple[list[str], Matrix]:
    """Return the vehicles and their shares of the risk bound by cause, the largest first.

    Parameters
    ----------
    plan : Plan
        With a ledger.

    Returns
    -------
    names : list of str
        The 20 vehicles with the largest shares, and how many others there are.
    shares : (rows, 4) array
        Of Δ, for pair (half of each pair's risk), obstacle, workspace, range (half of each) [-].
    """
    table = risk_by_vehicle(plan.risk.ledger, [v.name for v in plan.scenario.vehicles])
    ordered = sorted(table, key=lambda name: sum(table[name].values()), reverse=True)
    shares = np.array([[table[name][cause] for cause in CAUSES] for name in ordered])
    names = [shortened(name, _MAX_NAME) for name in ordered[:MAX_ROWS]]
    return _with_rest(names, shares / plan.risk.bound)


def _with_rest(names: list[str], values: Matrix) -> tuple[list[str], Matrix]:
    """Sum the rows beyond the names into one."""
    hidden = len(values) - len(names)
    if hidden <= 0:
        return names, values
    rest = values[len(names) :].sum(axis=0)
    label = "1 other" if hidden == 1 else f"{hidden} others"
    return [*names, label], np.vstack([values[: len(names)], rest])


def _cause_name(hazard: Hazard) -> str:
    """Return which vehicle may hit what, in a few letters."""
    vehicle = shortened(hazard.vehicle, _MAX_NAME)
    if hazard.cause == "workspace":
        return f"{vehicle}, workspace"
    if hazard.other is None:
        return f"{vehicle}, far {hazard.cause}s"
    other = shortened(hazard.other, _MAX_NAME)
    if hazard.cause == "range":
        return f"{vehicle} – {other}, range"
    link = " – " if hazard.cause == "pair" else ", "
    return f"{vehicle}{link}{other}"
