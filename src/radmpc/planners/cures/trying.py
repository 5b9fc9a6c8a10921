"""What gives vehicles a plan that have none: changes tried by whatever tells that they have one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners.cures.variants import (
    LIMIT_FACTORS,
    MOST_RISK,
    WEIGHTS,
    helps_sentence,
    longer_horizons,
    longer_text,
    regulated,
    with_horizon,
    with_noise,
)
from radmpc.rounding import rounded_up
from radmpc.solvers.solution import Limits

__all__ = ["passage_sentence", "reach_sentence"]

_SECONDS = 4.0
"""Time for all trials [s]."""

_TRIAL_SECONDS = 1.2
"""Most that a single trial may take of it [s]."""

_QUIETER = (0.5, 0.25, 0.1)
"""Factors of the noise's standard deviations that are tried [-]."""

_RISKS = (2.0, 4.0)
"""Multiples of Δ that are tried [-]."""

_FACES = (8, 16)
"""Faces around pairs that are tried in the plane [-]."""

Does = Callable[[Scenario, Limits], bool]
"""Whether a scenario that was changed has what was missing; ends by the limits."""


def passage_sentence(
    scenario: Scenario, does: Does, limits: Limits, fleet_bound: float | None = None
) -> str:
    """Return what gives vehicles room that find no way: horizon, Δ, faces, or else less noise.

    Parameters
    ----------
    scenario : Scenario
        These vehicles alone.
    does : callable
        Whether they have a way in a changed scenario.
    limits : Limits
        When to stop trying.
    fleet_bound : float or None
        Δ of the whole fleet, of which these have a share; None where theirs is all of it.

    Returns
    -------
    str
        A sentence; empty where nothing that was tried does.
    """
    within = limits.within(_SECONDS)
    bolder = _bolder(scenario, does, within, fleet_bound or scenario.risk_bound)
    found = [*_longer(scenario, does, within), *bolder]
    if scenario.num_vehicles > 1 and scenario.dimension == 2:
        more = (count for count in _FACES if count > scenario.num_pair_faces)
        finer = ((f"{count}", replace(scenario, pair_faces=count)) for count in more)
        found += [f"raise pair_faces to {told}" for told in _first(finer, does, within)]
    if not found:
        quieter = ((f"{factor:g}", with_noise(scenario, factor**2)) for factor in _QUIETER)
        found += [
            f"reduce the noise to {told} of its standard deviations"
            for told in _first(quieter, does, within)
        ]
    return helps_sentence(found)


def reach_sentence(scenario: Scenario, late: Iterable[int], does: Does, limits: Limits) -> str:
    """Return what brings goals into reach: horizon, control limit, speed limit, softer feedback.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    late : iterable of int
        Vehicles that cannot reach their goals through empty space.
    does, limits
        As in `passage_sentence`: what brings a goal into reach may leave no way to it.

    Returns
    -------
    str
        The same for these.
    """
    within = limits.within(_SECONDS)
    part = scenario.subset(tuple(late), scenario.risk_bound)
    found = list(_longer(part, does, within))
    for limit in ("control_limit", "speed_limit"):
        raised = ((f"{factor:g}", _raised(part, limit, factor)) for factor in LIMIT_FACTORS)
        found += [
            f"raise {limit} to {told} times its value" for told in _first(raised, does, within)
        ]
    if any(vehicle.gain is not None for vehicle in part.vehicles):
        softer = ((f"{weight:g}", _softer(part, weight)) for weight in WEIGHTS)
        found += [
            f"soften the feedback (lqr with Q = 1, R = {told} does)"
            for told in _first(softer, does, within)
        ]
    return helps_sentence(found)


def _longer(scenario: Scenario, does: Does, limits: Limits) -> Iterator[str]:
    """Yield the shortest horizon that does, of those tried."""
    longer = ((n, with_horizon(scenario, n)) for n in longer_horizons(scenario))
    for told in _first(((str(n), changed) for n, changed in longer), does, limits):
        yield longer_text(scenario, int(told))


def _bolder(scenario: Scenario, does: Does, limits: Limits, fleet_bound: float) -> Iterator[str]:
    """Yield the smallest bound of the fleet that does, of those tried."""
    share = scenario.risk_bound / fleet_bound
    bounds = [rounded_up(factor * fleet_bound, 3) for factor in _RISKS]
    bolder = ((f"{b:g}", replace(scenario, risk_bound=share * b)) for b in bounds if b <= MOST_RISK)
    for told in _first(bolder, does, limits):
        yield f"raise risk_bound to {told}"


def _first(
    candidates: Iterable[tuple[str, Scenario | None]], does: Does, limits: Limits
) -> Iterator[str]:
    """Yield what is told of the first candidate that does, if any does in time."""
    for told, changed in candidates:
        if limits.reached:
            return
        if changed is not None and does(changed, limits.within(_TRIAL_SECONDS)):
            yield told
            return


def _raised(scenario: Scenario, limit: str, factor: float) -> Scenario | None:
    """Return a scenario with a limit of every vehicle multiplied; None without such a limit."""
    if any(getattr(vehicle, limit) is None for vehicle in scenario.vehicles):
        return None
    return replace(scenario, vehicles=tuple(_faster(v, limit, factor) for v in scenario.vehicles))


def _faster(vehicle: Vehicle, limit: str, factor: float) -> Vehicle:
    """Return a vehicle with a limit multiplied."""
    if limit == "control_limit":
        return replace(vehicle, control_limit=factor * vehicle.control_limit)
    assert vehicle.speed_limit is not None
    return replace(vehicle, speed_limit=factor * vehicle.speed_limit)


def _softer(scenario: Scenario, weight: float) -> Scenario | None:
    """Return a scenario under regulators of a weight; None where there is none for a vehicle."""
    fleet = [regulated(vehicle, weight) for vehicle in scenario.vehicles]
    candidates = tuple(vehicle for vehicle in fleet if vehicle is not None)
    return replace(scenario, vehicles=candidates) if len(candidates) == len(fleet) else None
