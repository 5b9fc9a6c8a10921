"""Warnings: what, where, the value, and what cures it; what rules out any plan comes first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil
from typing import Literal

import numpy as np

from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.preflight.cures import control_cures, saturation_cures, time_cures
from radmpc.preflight.noise import NoiseKind, noise_warnings
from radmpc.preflight.outlook import Outlook, VehicleOutlook
from radmpc.preflight.places import Narrowest
from radmpc.preflight.reserve import tails

__all__ = ["Concern", "Kind", "concerns_of"]

Kind = (
    Literal["control", "time", "visit", "endpoint", "narrow", "saturation", "deviation"] | NoiseKind
)

_TIGHT = 0.9
"""Share of the horizon that the least time may take before it is a concern [-]. Of the drawn
scenarios whose cure was a longer horizon the tightest took 0.92 of it; `harbor` takes 0.75."""

_ROOMY = 1.3
"""Multiple of the least time that is recommended as the horizon [-]: imports choose 1.5."""

_MUCH = 0.5
"""Share of the control limit that feedback may keep back before it is a concern [-]."""

_SMALL = 0.1
"""Share of Δ up to which a probability is small against it [-], as in reports of plans."""

_SCATTERED = 2.0
"""Standard deviation at the end from which on it is a concern [hull radii]."""

_GROUPED = 3
"""Vehicles of one concern from which on one line names them all [-]."""

_NAMED = 3
"""Names that such a line lists [-]."""


@dataclass(frozen=True, slots=True)
class Concern:
    """A warning.

    Attributes
    ----------
    kind : str
        What it is about.
    vehicles : tuple of str
        Whom it is about; empty of all.
    text : str
        One line.
    is_fatal : bool
        Whether no plan can be within Δ.
    horizon : int or None
        Steps that it recommends as the horizon.
    """

    kind: Kind
    vehicles: tuple[str, ...]
    text: str
    is_fatal: bool
    horizon: int | None = None


@dataclass(frozen=True, slots=True)
class _Found:
    """A concern about one vehicle, before vehicles are put together.

    Attributes
    ----------
    kind : str
        What it is about.
    name : str
        The vehicle.
    text : str
        What follows the vehicle's name.
    weight : float
        How bad it is, among those of its kind.
    is_fatal : bool
        Whether no plan can be within Δ.
    horizon : int or None
        Steps that it recommends as the horizon.
    """

    kind: Kind
    name: str
    text: str
    weight: float
    is_fatal: bool = False
    horizon: int | None = None


def concerns_of(outlook: Outlook) -> tuple[Concern, ...]:
    """Return what an operator should know before planning.

    Parameters
    ----------
    outlook : Outlook
        What was seen of a scenario.

    Returns
    -------
    tuple of Concern
        What rules out any plan first; one line for vehicles that share a concern.
    """
    scenario = outlook.scenario
    found = [
        one
        for vehicle, seen in zip(scenario.vehicles, outlook.vehicles, strict=True)
        for one in _of_vehicle(scenario, vehicle, seen)
    ]
    noise = (Concern(kind, (), text, False) for kind, text in noise_warnings(scenario))
    told = [*_endpoints(outlook), *_grouped(found), *noise]
    return tuple(sorted(told, key=lambda concern: not concern.is_fatal))


def _of_vehicle(scenario: Scenario, vehicle: Vehicle, seen: VehicleOutlook) -> Iterator[_Found]:
    """Yield what is to be said of one vehicle."""
    yield from _control(scenario, vehicle, seen)
    yield from _time(scenario, vehicle, seen)
    if seen.visits:
        from radmpc.preflight.visits import told_of_visits  # noqa: PLC0415 - few visit anything

        for text, weight in told_of_visits(vehicle, seen.visits, scenario.horizon):
            yield _Found("visit", seen.name, text, weight, is_fatal=weight > 1.0)
    if isinstance(seen.narrowest, Narrowest):
        yield from _narrow(scenario, seen, seen.narrowest)
    most = _SMALL * scenario.risk_bound
    if seen.saturation is not None and seen.saturation > most:
        yield _Found(
            "saturation",
            seen.name,
            f"feedback asks for more control than the cheapest plan leaves with a probability of "
            f"{seen.saturation:.2g} (risk_bound {scenario.risk_bound:g}), and a certificate does "
            f"not speak of that: {saturation_cures(scenario, vehicle, most)}",
            seen.saturation,
        )
    ratio = seen.end_deviation / vehicle.radius
    if ratio > _SCATTERED:
        cure = "add feedback" if vehicle.gain is None else "stiffen the gain, or reduce the noise"
        yield _Found(
            "deviation",
            seen.name,
            f"standard deviation {seen.end_deviation:.3g} m at the end, {ratio:.2g} times its "
            f"radius: {cure}",
            ratio,
        )


def _control(scenario: Scenario, vehicle: Vehicle, seen: VehicleOutlook) -> Iterator[_Found]:
    """Yield what is to be said of the control that feedback keeps back."""
    reserve = seen.reserve
    if reserve.share <= _MUCH:
        return
    unit = " m/s²" if vehicle.system.is_double_integrator else ""
    yield _Found(
        "control",
        seen.name,
        f"feedback keeps back {reserve.kept:.3g} of {reserve.limit:.3g}{unit} "
        f"({100.0 * reserve.share:.0f} % of control_limit) on axis {reserve.axis} at step "
        f"{reserve.step}: {control_cures(scenario, vehicle, _MUCH)}",
        reserve.share,
        is_fatal=reserve.share > 1.0,
    )


def _time(scenario: Scenario, vehicle: Vehicle, seen: VehicleOutlook) -> Iterator[_Found]:
    """Yield what is to be said of the horizon."""
    least, horizon = seen.least_steps_with_feedback, scenario.horizon
    if seen.reserve.share > 1.0 or (least is not None and least <= _TIGHT * horizon):
        return  # without control no horizon helps
    seconds = f"{horizon} steps ({horizon * scenario.dt:g} s)"
    if least is None:
        cures = time_cures(scenario, vehicle)
        text = (
            f"goal out of reach in many times the horizon of {seconds}, with nothing in the way: "
            f"check units{', or ' if cures else ''}{cures}"
        )
        yield _Found("time", seen.name, text, np.inf, is_fatal=True)
        return
    whole = seen.least_steps
    kept = f", {whole} without feedback" if whole is not None and whole < least else ""
    head = f"goal {least} steps away at least{kept}, horizon {seconds}"
    more = max(ceil(_ROOMY * least), horizon + 1)
    if least > horizon:
        cures = time_cures(scenario, vehicle)
        text = f"{head}: lengthen it to {least} or more{', or ' if cures else ''}{cures}"
    else:
        left = horizon - least
        text = (
            f"{head}: {'none is' if left == 0 else f'only {left} are' if left > 1 else 'only 1 is'}"
            f" left for ways around obstacles and others; lengthen it to about {more}"
        )
    yield _Found("time", seen.name, text, least / horizon, least > horizon, more)


def _narrow(scenario: Scenario, seen: VehicleOutlook, place: Narrowest) -> Iterator[_Found]:
    """Yield what is to be said of the narrowest place."""
    if place.step in {0, scenario.horizon} and place.clearance >= 0.0:
        return  # it is the start or the goal, of which more is said elsewhere
    if max(seen.start_risk, seen.goal_risk) > scenario.risk_bound:
        return  # what is around those has to be changed first
    where = f"{_between(place)} near ({', '.join(f'{x:.4g}' for x in place.position)})"
    cure = "widen it, lengthen the horizon for a way around, or reduce the noise"
    if place.clearance < 0.0:
        text = (
            f"no way to the goal in time is wide enough: the roomiest lacks {-place.clearance:.2g} "
            f"m {where}; widen it, or lengthen the horizon for a way around"
        )
        yield _Found("narrow", seen.name, text, np.inf)
        return
    deviations = place.deviations
    if deviations is None:
        return
    risk = float(tails(np.array([deviations]), scenario.covariance_samples)[0])
    if risk <= _SMALL * scenario.risk_bound:
        return
    yield _Found(
        "narrow",
        seen.name,
        f"must pass {where} with {place.clearance:.2g} m to spare, {deviations:.2g} standard "
        f"deviations, a risk of about {risk:.2g} (risk_bound {scenario.risk_bound:g}): {cure}",
        risk,
    )


def _between(place: Narrowest) -> str:
    """Name what is beside a place."""
    names = ["the workspace border" if n is None else repr(n) for n in place.beside]
    if len(names) == 1:
        return f"beside {names[0]}"
    if names[0] == names[1]:
        return f"between sides of {names[0]}"
    return f"between {names[0]} and {names[1]}"


def _endpoints(outlook: Outlook) -> Iterator[Concern]:
    """Yield what is to be said of starts and goals: above Δ, or a large part of it."""
    if outlook.endpoints is None:
        return
    from radmpc.planners.presolve import endpoint_reasons, grouped  # noqa: PLC0415 - see `Outlook`

    scenario = outlook.scenario
    reasons = endpoint_reasons(scenario, outlook.endpoints)
    # Of goals that are shared others may risk less; starts stay as they are.
    worst_start = max((hazard.risk for hazard in outlook.endpoints.starts), default=0.0)
    is_fatal = not scenario.goals or worst_start > scenario.risk_bound
    for reason, (_, text) in zip(reasons, grouped(scenario, reasons), strict=False):
        names = tuple(scenario.vehicles[i].name for i in reason.members)
        yield Concern("endpoint", names, text, is_fatal)
    if reasons or outlook.least_risk <= _SMALL * scenario.risk_bound:
        return
    worst = max(outlook.hazards, key=lambda hazard: hazard.risk)
    names = tuple(scenario.vehicles[i].name for i in worst.members)
    place = "goal" if worst.at_goal else "start"
    if worst.cause == "pair":
        what = f"the {place}s of {names[0]!r} and {names[1]!r}"
    else:
        other = "the workspace border" if worst.other is None else f"obstacle {worst.other!r}"
        what = f"the {place} of {names[0]!r} at {other}"
    share = 100.0 * outlook.least_risk / scenario.risk_bound
    text = (
        f"Starts and goals alone take {outlook.least_risk:.2g} of risk_bound "
        f"{scenario.risk_bound:g} ({share:.0f} %), whatever the plan, most of it {what} "
        f"({worst.risk:.2g}): move them, reduce the noise, or raise risk_bound"
    )
    yield Concern("endpoint", names, text, False)


def _grouped(found: Sequence[_Found]) -> Iterator[Concern]:
    """Yield concerns about vehicles; of three or more of a kind the worst, and who shares it."""
    groups: dict[tuple[Kind, bool], list[_Found]] = {}
    for one in found:
        groups.setdefault((one.kind, one.is_fatal), []).append(one)
    for (kind, is_fatal), group in groups.items():
        if len(group) < _GROUPED:
            for one in group:
                text = f"Vehicle {one.name!r}: {one.text}"
                yield Concern(kind, (one.name,), text, is_fatal, one.horizon)
            continue
        ranked = sorted(group, key=lambda one: -one.weight)
        names = ", ".join(repr(one.name) for one in ranked[:_NAMED])
        hidden = len(ranked) - _NAMED
        more = f" and {hidden} more" if hidden else ""
        is_same = len({one.text for one in group}) == 1
        who = "" if is_same else f"; the worst, {ranked[0].name!r}"
        everyone = tuple(one.name for one in group)
        text = f"Vehicles {names}{more}{who}: {ranked[0].text}"
        yield Concern(kind, everyone, text, is_fatal, ranked[0].horizon)
