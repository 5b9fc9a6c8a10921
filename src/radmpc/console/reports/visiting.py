"""When vehicles make their visits and arrive, in lines of the report."""

from __future__ import annotations

from radmpc.model.plan import Plan

__all__ = ["arrivals_text", "visits_text"]

_MOST = 6
"""Vehicles whose visits or arrivals a report names; the rest is counted."""


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
    return _shortened(told)


def arrivals_text(plan: Plan) -> str:
    """Return the steps and seconds at which means arrive; empty where all are due at the horizon.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    """
    told = []
    for vehicle, trajectory in zip(plan.scenario.vehicles, plan.trajectories, strict=True):
        if vehicle.goal.within is None:
            continue
        system, means = vehicle.system, trajectory.means
        speeds = None if system.velocity is None else means[:, list(system.velocity)]
        step = vehicle.goal.arrival(means[:, list(system.position)], speeds)
        when = "late" if step is None else f"at step {step} ({step * plan.scenario.dt:g} s)"
        told.append(f"{vehicle.name} {when}")
    return _shortened(told)


def _shortened(told: list[str]) -> str:
    """Return what is told of the first vehicles, and how many more there are."""
    rest = len(told) - _MOST
    return "; ".join(told[:_MOST]) + (f"; and {rest} more vehicles" if rest > 0 else "")
