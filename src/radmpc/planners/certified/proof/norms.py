"""Limits of norms in bounds on any certified plan: the referee keeps the norm, programs less."""

from __future__ import annotations

from radmpc.model.limits import outside_norms
from radmpc.planners.certified.fleet import Fleet
from radmpc.records import replace

__all__ = ["outside_norms_of"]


def outside_norms_of(fleet: Fleet) -> Fleet:
    """Return a fleet that may do whatever the referee lets it do; the same without norms.

    Parameters
    ----------
    fleet : Fleet
        The fleet, whose programs keep to polytopes within its norms.
    """
    scenario = fleet.scenario
    vehicles = tuple(map(outside_norms, scenario.vehicles))
    if all(one is other for one, other in zip(vehicles, scenario.vehicles, strict=True)):
        return fleet
    outside = Fleet.of(
        replace(scenario, vehicles=vehicles),
        fleet.gap,
        fleet.limits,
        progress=fleet.progress,
        executor=fleet.executor,
    )
    if scenario.has_windows:
        from radmpc.planners.certified.proof.least_visits import with_least_visits  # noqa: PLC0415 - few have any

        outside = with_least_visits(outside)
    return outside
