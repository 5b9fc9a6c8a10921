"""When vehicles make their visits, in a line of the report."""

from __future__ import annotations

from radmpc.model.plan import Plan

__all__ = ["visits_text"]

_MOST = 6
"""Vehicles whose visits a report names; the rest is counted."""


def visits_text(plan: Plan) -> str:
    """Return the steps and seconds at which means make their visits; empty where there are none.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    """
    if not any(vehicle.via for vehicle in plan.scenario.vehicles):
        return ""
    from radmpc.model.visits import steps_visited  # noqa: PLC0415 - few visit anything

    told = []
    for vehicle, trajectory in zip(plan.scenario.vehicles, plan.trajectories, strict=True):
        if not vehicle.via:
            continue
        system, means = vehicle.system, trajectory.means
        speeds = None if system.velocity is None else means[:, list(system.velocity)]
        steps = steps_visited(vehicle.via, means[:, list(system.position)], speeds)
        made = ", ".join(f"{k} ({k * plan.scenario.dt:g} s)" for k in steps)
        missing = len(vehicle.via) - len(steps)
        lacking = f", {missing} not made" if missing else ""
        told.append(f"{vehicle.name} at step {made or '–'}{lacking}")
    rest = len(told) - _MOST
    return "; ".join(told[:_MOST]) + (f"; and {rest} more vehicles" if rest > 0 else "")
