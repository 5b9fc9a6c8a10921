"""What is to be said of the time until a goal is due: the horizon, or the end of a window."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import ceil
from typing import Literal

import numpy as np

from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners.reaching.around import late_text
from radmpc.planners.reaching.drifting import strong_drift_text
from radmpc.preflight.cures import time_cures
from radmpc.preflight.outlook import MOST_TIMES, VehicleOutlook
from radmpc.records import dataclass
from radmpc.wording import count_text

__all__ = ["TimeConcern", "describe_late", "describe_time", "describe_unable"]

_TIGHT = 0.9
"""Share of the horizon that the least time may take before it is a concern [-]. Of the drawn
scenarios whose cure was a longer horizon the tightest took 0.92 of it; `harbor` takes 0.75."""

_ROOMY = 1.3
"""Multiple of the least time that is recommended as the horizon [-]: imports choose 1.5."""


@dataclass(frozen=True, slots=True)
class TimeConcern:
    """A concern about the time of one vehicle.

    Attributes
    ----------
    kind : str
        What it is about.
    text : str
        What follows the vehicle's name.
    weight : float
        How bad it is, among those of its kind.
    is_fatal : bool
        Whether there is no plan.
    horizon : int or None
        Steps that it recommends as the horizon.
    cures : callable or None
        Tries what follows the text after a colon.
    """

    kind: Literal["time", "visit"]
    text: str
    weight: float
    is_fatal: bool = True
    horizon: int | None = None
    cures: Callable[[], str] | None = None


def describe_unable(scenario: Scenario, vehicle: Vehicle) -> TimeConcern | None:
    """Return why limits leave a vehicle no plan, whatever the horizon, or with its visits.

    Parameters
    ----------
    scenario : Scenario
        Whose step and horizon count.
    vehicle : Vehicle
        Of it.

    Returns
    -------
    TimeConcern or None
        None where there is no such reason.
    """
    is_fast = _starts_fast(vehicle)
    is_due = vehicle.goal.window(scenario.horizon)[1] < scenario.horizon
    if not (vehicle.via or is_fast or is_due):
        return None
    from radmpc.preflight.general import why_unable  # noqa: PLC0415 - a solver, for few

    unable = why_unable(scenario, vehicle)
    if unable is None:
        return None
    kind, text = unable
    cures = partial(time_cures, scenario, vehicle) if is_fast else None
    return TimeConcern(kind, text, np.inf, cures=cures)


def _starts_fast(vehicle: Vehicle) -> bool:
    """Whether a vehicle starts above its speed limit."""
    if vehicle.speed_limit is None or vehicle.system.velocity is None:
        return False
    speeds = np.abs(vehicle.start[list(vehicle.system.velocity)])
    return bool(np.any(speeds > vehicle.speed_limit))


def describe_late(scenario: Scenario, seen: VehicleOutlook) -> TimeConcern | None:
    """Return what a vehicle is late for that would be in time with no obstacle in the way.

    Parameters
    ----------
    scenario : Scenario
        Whose step and horizon count.
    seen : VehicleOutlook
        What was seen of the vehicle.

    Returns
    -------
    TimeConcern or None
        None where nothing is known, or it is late for more than obstacles.
    """
    late, least = seen.late, seen.least_steps_with_feedback
    if late is None or seen.closed is not None or least is None or least > scenario.horizon:
        return None
    cure, horizon = "", None
    if late.is_horizon and late.least is not None:
        horizon = ceil(_ROOMY * late.least)
        cure = f": lengthen the horizon to {late.least} or more"
    elif late.least is not None:
        window = "`goal.within`" if late.visit is None else "its window"
        cure = f": let {window} end at step {late.least} or later"
    kind: Literal["time", "visit"] = "time" if late.visit is None else "visit"
    text = f"{late_text(scenario, late)}{cure}"
    return TimeConcern(kind, text, np.inf, horizon=horizon)


def describe_time(scenario: Scenario, vehicle: Vehicle, seen: VehicleOutlook) -> TimeConcern | None:
    """Return what is to be said of the time that a vehicle has.

    Parameters
    ----------
    scenario : Scenario
        Whose horizon counts.
    vehicle : Vehicle
        Of it; limits leave it a plan by the end of the window of its arrival.
    seen : VehicleOutlook
        What was seen of it.

    Returns
    -------
    TimeConcern or None
        None where there is time enough.
    """
    least, horizon = seen.least_steps_with_feedback, scenario.horizon
    due = vehicle.goal.window(horizon)[1]
    if seen.reserve.share > 1.0 or (least is not None and least <= _TIGHT * due):
        return None  # without control no horizon helps
    seconds = f"{count_text(horizon, 'step')} ({horizon * scenario.dt:g} s)"
    if least is None:
        # Out of reach in many times the horizon, it may be a drift that only then is too much.
        drift = strong_drift_text(vehicle, scenario.dt, MOST_TIMES * horizon)
        if drift is not None:
            text = f"goal out of reach, {drift}: check both, and the signs of drift"
            return TimeConcern("time", text, np.inf)
        cures = time_cures(scenario, vehicle)
        text = (
            f"goal out of reach in many times the horizon of {seconds}, with nothing in the way: "
            f"check units{', or ' if cures else ''}{cures}"
        )
        return TimeConcern("time", text, np.inf)
    whole = seen.least_steps
    kept = f", {whole} without feedback" if whole is not None and whole < least else ""
    head = f"goal {count_text(least, 'step')} away at least{kept}"
    more = max(ceil(_ROOMY * least), horizon + 1)
    if least > horizon:
        cures = time_cures(scenario, vehicle)
        text = f"{head}, horizon {seconds}: lengthen it to {least} or more"
        text = f"{text}{', or ' if cures else ''}{cures}"
        return TimeConcern("time", text, least / horizon, horizon=more)
    left = max(due - least, 0)
    room = (
        f"{'none is' if left == 0 else f'only {left} are' if left > 1 else 'only 1 is'} left for "
        "paths around obstacles and others"
    )
    if due < horizon:
        text = f"{head}, due at step {due}, the end of its window: {room}; widen `goal.within`"
        return TimeConcern("time", text, least / due, is_fatal=False)
    text = f"{head}, horizon {seconds}: {room}; lengthen it to about {more}"
    return TimeConcern("time", text, least / horizon, is_fatal=False, horizon=more)
