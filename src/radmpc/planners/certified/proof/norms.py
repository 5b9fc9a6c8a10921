"""Limits of norms in bounds on any certified plan: the referee keeps the norm, programs less."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.arrays import Matrix
from radmpc.model.limits import all_outside_norms
from radmpc.planners.certified.fleet import Fleet
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.program.limits.norms import turned_outside

__all__ = ["outside_norms_of"]


def outside_norms_of(fleet: Fleet, controls: Sequence[Matrix] = ()) -> Fleet:
    """Return a fleet that may do whatever the referee lets it do; the same without norms.

    Parameters
    ----------
    fleet : Fleet
        The fleet, whose programs keep to polytopes within its norms.
    controls : sequence of (T, m) array
        A plan at which the polytopes around the norms touch these; empty for given directions.
    """
    if not fleet.keeps_norms:
        return fleet
    scenario = all_outside_norms(fleet.scenario)
    models = condensed_models(scenario)
    if controls:
        models = tuple(map(turned_outside, models, controls))
    outside = Fleet.of(
        scenario,
        fleet.gap,
        fleet.limits,
        progress=fleet.progress,
        executor=fleet.executor,
        hazards=Hazards.of(scenario, models),
    )
    if scenario.has_windows:
        from radmpc.planners.certified.proof.least_visits import with_least_visits  # noqa: PLC0415 - few have any

        outside = with_least_visits(outside)
    return outside
