"""What is to be said of the narrowest place that a vehicle must pass, with what cures it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.geometry.through import leads_through
from radmpc.model.relations.concerns import met_by
from radmpc.model.scenario import Scenario
from radmpc.model.workspace import Workspace
from radmpc.planners.cures.variants import (
    longer_horizons,
    regulated,
    with_horizon,
    with_noise,
)
from radmpc.planners.reaching.enclosed import closed_text
from radmpc.preflight.outlook import VehicleOutlook, outlook_of
from radmpc.preflight.places import Narrowest, Passage
from radmpc.preflight.reserve import tails
from radmpc.rounding import rounded_down, rounded_up
from radmpc.wording import place_text

__all__ = ["describe_narrow", "narrow_cures"]

_SMALL = 0.1
"""Share of Δ up to which a probability is small against it [-], as of other concerns."""

_WEIGHTS = (1.0, 10.0, 100.0)
"""Weights R of the control that are tried for feedback, with Q = 1 [-]: each takes a search."""

_MUCH = 0.5
"""Share of the control limit that feedback may keep back [-], as of other concerns."""

_HALVINGS = 40
"""Bisections of a clearance [-]."""

_Test = Callable[[Scenario | None], bool]


def describe_narrow(scenario: Scenario, seen: VehicleOutlook) -> Iterator[tuple[str, float]]:
    """Yield what is to be said of the narrowest place, if anything.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    seen : VehicleOutlook
        What one of its vehicles meets.

    Yields
    ------
    str and float
        A sentence without the vehicle's name, and how bad it is: inf where nothing fits through.
    """
    place = seen.narrowest
    if seen.closed is not None:
        whom = next(v for v in scenario.vehicles if v.name == seen.name)
        yield closed_text(whom, seen.closed), np.inf
        return
    if place is Passage.CLOSED and seen.late is None:  # else that is said of its time
        yield _without_path(scenario, seen.name), np.inf
    elif isinstance(place, Narrowest):
        yield from _describe_place(scenario, seen, place)


def _describe_place(
    scenario: Scenario, seen: VehicleOutlook, place: Narrowest
) -> Iterator[tuple[str, float]]:
    """Yield what is to be said of a narrowest place that is known, if anything."""
    if place.step in {0, scenario.horizon} and place.clearance >= 0.0:
        return  # it is the start or the goal, of which more is said elsewhere
    if max(seen.start_risk, seen.goal_risk) > scenario.risk_bound:
        return  # what is around those has to be changed first
    where = f"{_between(place)} near {place_text(place.position)}"
    if place.clearance < 0.0:
        text = (
            f"no path to the goal in time is wide enough: the widest lacks {-place.clearance:.2g} "
            f"m {where}"
        )
        yield text, np.inf
        return
    deviations = place.deviations
    if deviations is None:
        return
    risk = _risk(scenario, deviations)
    if risk <= _SMALL * scenario.risk_bound:
        return
    text = (
        f"must pass {where} with {place.clearance:.2g} m to spare, {deviations:.2g} standard "
        f"deviations, a risk of about {risk:.2g} (risk_bound {scenario.risk_bound:g})"
    )
    yield text, risk


def narrow_cures(scenario: Scenario, seen: VehicleOutlook) -> str:
    """Return what leaves a vehicle enough room: each was tried, with the vehicle alone.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    seen : VehicleOutlook
        What the vehicle meets that is narrow.

    Returns
    -------
    str
        In the imperative, joined by "or"; empty where nothing that was tried does.
    """
    if seen.closed is not None and seen.closed.is_shut:
        return ""  # there is nothing to widen, and no hull is small enough
    i = [vehicle.name for vehicle in scenario.vehicles].index(seen.name)
    alone = scenario.subset((i,), scenario.risk_bound)
    place = seen.narrowest

    def does(candidate: Scenario | None) -> bool:
        return candidate is not None and _is_roomy(candidate)

    if not isinstance(place, Narrowest):
        return ", or ".join(_longer(alone, does))
    found = [*_wider(alone, place, does), *_longer(alone, does), *_steered(alone, does)]
    if place.clearance > 0.0 and place.deviations is not None:
        quieter = rounded_down(place.deviations / _enough(scenario))
        if quieter < 1.0 and does(with_noise(alone, quieter**2)):
            found.append(f"reduce the noise to {quieter:g} of its standard deviations")
    return ", or ".join(found)


def _without_path(scenario: Scenario, name: str) -> str:
    """Say that a vehicle gets to its goal in time through what stands there alone."""
    from radmpc.planners.wording import listed  # noqa: PLC0415 - loads what checks do without

    vehicle = next(v for v in scenario.vehicles if v.name == name)
    begin = vehicle.start_position[None]
    end = np.clip(begin, vehicle.goal.lower, vehicle.goal.upper)
    names = [
        repr(obstacle.name)
        for obstacle in met_by(scenario.obstacles, name)
        if any(leads_through(piece, begin, end)[0] for piece in obstacle.at(0))
    ]
    told = f", and straight ahead {listed(names)} {_stand(names)} in the way" if names else ""
    return f"no path to the goal in time is wide enough{told}"


def _stand(names: list[str]) -> str:
    """Return the verb of these."""
    return "stand" if len(names) > 1 else "stands"


def _is_roomy(alone: Scenario) -> bool:
    """Whether the only vehicle of a scenario has no narrow place before it, as far as is known."""
    (seen,) = outlook_of(alone).vehicles
    is_told = seen.narrowest not in {Passage.UNKNOWN, Passage.TOO_LARGE}
    if not is_told or seen.reserve.share > _MUCH:
        return False
    return not list(describe_narrow(alone, seen))


def _wider(alone: Scenario, place: Narrowest, does: _Test) -> Iterator[str]:
    """Yield how much wider the place has to be: tried on a smaller hull in a larger workspace."""
    (vehicle,) = alone.vehicles
    lacking = max(_enough(alone) * place.deviation, 0.0) - place.clearance
    count = len(place.beside)
    told = rounded_up(count * lacking, 3) if lacking > 0.0 else 0.0
    aside = told / count
    if not 0.0 < aside < vehicle.radius:
        return
    workspace = alone.workspace
    try:
        if workspace is not None:
            workspace = Workspace(workspace.lower - aside, workspace.upper + aside)
        smaller = replace(vehicle, radius=vehicle.radius - aside)
        candidate = replace(alone, vehicles=(smaller,), workspace=workspace)
    except ScenarioError:
        return
    if does(candidate):
        yield f"widen it by {told:g} m"


def _longer(alone: Scenario, does: _Test) -> Iterator[str]:
    """Yield the shortest horizon that does, of those tried: there may be a way around."""
    for horizon in longer_horizons(alone):
        if does(with_horizon(alone, horizon)):
            yield f"lengthen the horizon to {horizon}"
            return


def _steered(alone: Scenario, does: _Test) -> Iterator[str]:
    """Yield the stiffest feedback that does, of those tried, where there is none."""
    (vehicle,) = alone.vehicles
    if vehicle.gain is not None or not vehicle.disturbance_covariance.any():
        return
    for weight in _WEIGHTS:
        candidate = regulated(vehicle, weight)
        if candidate is not None and does(replace(alone, vehicles=(candidate,))):
            yield f"add feedback (lqr with Q = 1, R = {weight:g} does)"
            return


def _risk(scenario: Scenario, deviations: float) -> float:
    """Return how likely a clearance is used up."""
    return float(tails(np.array([deviations]), scenario.covariance_samples)[0])


def _enough(scenario: Scenario) -> float:
    """Return the clearance whose risk is small against Δ [standard deviations]."""
    low, high = 0.0, 1.0
    while _risk(scenario, high) > _SMALL * scenario.risk_bound:
        low, high = high, 2.0 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if _risk(scenario, middle) > _SMALL * scenario.risk_bound:
            low = middle
        else:
            high = middle
    return high


def _between(place: Narrowest) -> str:
    """Name what is beside a place."""
    names = ["the workspace border" if n is None else repr(n) for n in place.beside]
    if len(names) == 1:
        return f"beside {names[0]}"
    if names[0] == names[1]:
        return f"between sides of {names[0]}"
    return f"between {names[0]} and {names[1]}"
