"""Warnings: what, where, the value, and what cures it; what rules out any plan comes first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Literal

import numpy as np

from radmpc.arguments import check_kind
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners.reaching.passing import blocked_pairs, blocked_text
from radmpc.preflight.cures import (
    control_cures,
    deviation_cures,
    saturation_cures,
    visit_cures,
)
from radmpc.preflight.endpoint_concerns import describe_endpoints
from radmpc.preflight.feedback import is_unstable, stable_cures, unstable_text
from radmpc.preflight.narrow_concerns import describe_narrow, narrow_cures
from radmpc.preflight.noise import NoiseKind, idle_measurement, noise_warnings, quiet_axes
from radmpc.preflight.outlook import Outlook, VehicleOutlook
from radmpc.preflight.time_concerns import describe_late, describe_time, describe_unable
from radmpc.records import dataclass, replace

__all__ = ["Concern", "Kind", "concerns_of"]

Kind = (
    Literal["feedback", "control", "time", "visit", "endpoint", "narrow", "saturation", "deviation"]
    | NoiseKind
)

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
    cures : callable or None
        Tries what follows the text after a colon, if anything does: asked only where it is told.
    """

    kind: Kind
    name: str
    text: str
    weight: float
    is_fatal: bool = False
    horizon: int | None = None
    cures: Callable[[], str] | None = None

    @property
    def line(self) -> str:
        """The text, with what was tried and cures it."""
        found = "" if self.cures is None else self.cures()
        return f"{self.text}: {found}" if found else self.text


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

    Raises
    ------
    ArgumentTypeError
        If it is no outlook.
    """
    hint = "radmpc.preflight.outlook_of makes one"
    check_kind(outlook, Outlook, "outlook", "an Outlook", hint)
    scenario = outlook.scenario
    found = [
        one
        for vehicle, seen in zip(scenario.vehicles, outlook.vehicles, strict=True)
        for one in _of_vehicle(scenario, vehicle, seen)
    ]
    noise = (Concern(kind, (), text, False) for kind, text in noise_warnings(scenario))
    ends = (Concern("endpoint", *told) for told in describe_endpoints(outlook))
    told = [*ends, *_risky_visits(outlook), *_grouped(found), *_blocked(scenario), *noise]
    return tuple(sorted(told, key=lambda concern: not concern.is_fatal))


def _blocked(scenario: Scenario) -> Iterator[Concern]:
    """Yield the pairs that have to pass each other where there is no room for two."""
    for pair in blocked_pairs(scenario):
        names = tuple(scenario.vehicles[i].name for i in pair.members)
        yield Concern("narrow", names, blocked_text(scenario, pair).rstrip("."), is_fatal=True)


def _risky_visits(outlook: Outlook) -> Iterator[Concern]:
    """Yield the visits that alone risk more than Δ."""
    if any(vehicle.via for vehicle in outlook.scenario.vehicles):
        from radmpc.preflight.visit_risks import describe_risky_visits  # noqa: PLC0415 - few visit

        for names, text in describe_risky_visits(outlook):
            yield Concern("visit", names, text, is_fatal=True)


def _of_vehicle(scenario: Scenario, vehicle: Vehicle, seen: VehicleOutlook) -> Iterator[_Found]:
    """Yield what is to be said of one vehicle."""
    if not is_unstable(vehicle):
        yield from _with_any_feedback(scenario, vehicle, seen)
        return
    text, is_fatal = unstable_text(vehicle), seen.reserve.share > 1.0
    cures = partial(stable_cures, scenario, vehicle, _MUCH)
    yield _Found("feedback", seen.name, text, np.inf, is_fatal, cures=cures)
    for one in _with_any_feedback(scenario, vehicle, seen):
        # These follow from it: softer or stiffer would not cure them.
        follows = one.kind in {"control", "saturation", "deviation"}
        yield replace(one, cures=None) if follows else one


def _with_any_feedback(
    scenario: Scenario, vehicle: Vehicle, seen: VehicleOutlook
) -> Iterator[_Found]:
    """Yield what is to be said of one vehicle whose feedback is stable, or would be."""
    yield from _control(scenario, vehicle, seen)
    yield from _time(scenario, vehicle, seen)
    for text, weight in describe_narrow(scenario, seen):
        cures, is_closed = partial(narrow_cures, scenario, seen), seen.closed is not None
        yield _Found("narrow", seen.name, text, weight, is_closed, cures=cures)
    most = _SMALL * scenario.risk_bound
    if seen.saturation is not None and seen.saturation > most:
        yield _Found(
            "saturation",
            seen.name,
            f"feedback asks for more control than the cheapest plan leaves with a probability of "
            f"{seen.saturation:.2g} (risk_bound {scenario.risk_bound:g}), and a certificate does "
            "not speak of that",
            seen.saturation,
            cures=partial(saturation_cures, scenario, vehicle, most),
        )
    for told in (quiet_axes(vehicle, scenario.horizon), idle_measurement(vehicle)):
        if told is not None:
            yield _Found("noise", seen.name, told, 1.0)
    ratio = seen.end_deviation / vehicle.radius
    if ratio > _SCATTERED:
        most = _SCATTERED * vehicle.radius
        yield _Found(
            "deviation",
            seen.name,
            f"standard deviation {seen.end_deviation:.3g} m at the end, {ratio:.2g} times its "
            "radius",
            ratio,
            cures=partial(deviation_cures, scenario, vehicle, most, _MUCH),
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
        f"{reserve.step}",
        reserve.share,
        is_fatal=reserve.share > 1.0,
        cures=partial(control_cures, scenario, vehicle, _MUCH),
    )


def _time(scenario: Scenario, vehicle: Vehicle, seen: VehicleOutlook) -> Iterator[_Found]:
    """Yield what is to be said of the horizon, windows and visits."""
    unable = describe_unable(scenario, vehicle)
    if unable is not None and unable.kind == "time":
        yield _Found("time", seen.name, unable.text, unable.weight, True, cures=unable.cures)
        return
    late = describe_late(scenario, seen) if unable is None else None
    if late is not None:
        yield _Found(late.kind, seen.name, late.text, late.weight, True, late.horizon)
        return
    time = describe_time(scenario, vehicle, seen)
    if time is not None:
        yield _Found("time", seen.name, time.text, time.weight, time.is_fatal, time.horizon)
    visits: list[tuple[str, float]] = []
    if seen.visits:
        from radmpc.preflight.visits import describe_visits  # noqa: PLC0415 - few visit anything

        visits = list(describe_visits(vehicle, seen.visits, scenario.horizon))
    if unable is not None and not any(weight == np.inf for _, weight in visits):
        visits = [(unable.text, unable.weight)]
    for text, weight in visits:
        cures = partial(visit_cures, scenario, vehicle)
        yield _Found("visit", seen.name, text, weight, is_fatal=weight > 1.0, cures=cures)


def _grouped(found: Sequence[_Found]) -> Iterator[Concern]:
    """Yield concerns about vehicles; of three or more of a kind the worst, and who shares it."""
    groups: dict[tuple[Kind, bool], list[_Found]] = {}
    for one in found:
        groups.setdefault((one.kind, one.is_fatal), []).append(one)
    for (kind, is_fatal), group in groups.items():
        if len(group) < _GROUPED:
            for one in group:
                text = f"Vehicle {one.name!r}: {one.line}"
                yield Concern(kind, (one.name,), text, is_fatal, one.horizon)
            continue
        ranked = sorted(group, key=lambda one: -one.weight)
        names = ", ".join(repr(one.name) for one in ranked[:_NAMED])
        hidden = len(ranked) - _NAMED
        more = f" and {hidden} more" if hidden else ""
        is_same = len({one.text for one in group}) == 1
        who = "" if is_same else f"; the worst, {ranked[0].name!r}"
        everyone = tuple(one.name for one in group)
        text = f"Vehicles {names}{more}{who}: {ranked[0].line}"
        yield Concern(kind, everyone, text, is_fatal, ranked[0].horizon)
