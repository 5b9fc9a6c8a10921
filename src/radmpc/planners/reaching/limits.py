"""Goals and visits that control and speed limits rule out in time, with nothing in the way."""

from __future__ import annotations

from bisect import bisect_left

import numpy as np

from radmpc.model.scenario import Scenario
from radmpc.planners.reaching.drifting import strong_drift_text
from radmpc.planners.reaching.empty_space import in_empty_space
from radmpc.planners.reaching.reserves import reserve_reason, reserve_text
from radmpc.planners.reaching.visiting import UNREACHED, makes_visits, reaches_goal
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.records import replace
from radmpc.wording import count_text

__all__ = ["is_late_whatever_horizon", "reach_texts", "sure_reach_texts", "too_fast_texts"]

Texts = tuple[str, str]
"""What follows "Vehicle 'name'", and the same of several vehicles."""


def sure_reach_texts(scenario: Scenario, model: CondensedModel) -> Texts | None:
    """Return why a vehicle cannot be in time, as far as full throttle on each axis tells.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    model : CondensedModel
        The vehicle over the whole horizon.

    Returns
    -------
    pair of str or None
        What follows "Vehicle 'name'", and the same of several vehicles; None where it may be.
    """
    too_fast = too_fast_texts(model)
    if too_fast is not None:
        return too_fast
    if np.any(model.reach_lower - model.reach_upper > UNREACHED):
        return reach_texts(scenario, model)
    goal = model.vehicle.goal
    there = slice(goal.window(model.horizon)[1], None)
    gap = np.maximum(model.reach_lower[there] - goal.upper, goal.lower - model.reach_upper[there])
    return _late(scenario, model) if np.any(gap > UNREACHED) else _beyond_reach(model)


def reach_texts(scenario: Scenario, model: CondensedModel) -> Texts:
    """Return the reason of a vehicle that cannot be in time: horizon, arrival window, or visits.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    model : CondensedModel
        The vehicle over the whole horizon.

    Returns
    -------
    pair of str
        What follows "Vehicle 'name'", and the same of several vehicles.
    """
    within = model.vehicle.goal.within
    if is_late_whatever_horizon(model):
        return _late(scenario, model)
    if model.vehicle.via and makes_visits(model) is False and reaches_goal(model, within):
        return _unvisited(scenario, model)
    return _too_far(scenario, model)


def is_late_whatever_horizon(model: CondensedModel) -> bool:
    """Whether a vehicle cannot be at its goal by the end of a window before the horizon.

    Parameters
    ----------
    model : CondensedModel
        The vehicle over the whole horizon.
    """
    within = model.vehicle.goal.within
    return within is not None and within[1] < model.horizon and not reaches_goal(model, within)


def too_fast_texts(model: CondensedModel) -> Texts | None:
    """Say that a vehicle cannot brake in time for its speed limit.

    Parameters
    ----------
    model : CondensedModel
        The vehicle over the whole horizon.

    Returns
    -------
    pair of str or None
        What follows "Vehicle 'name'", and the same of several vehicles; None where it can.
    """
    limit, velocity, drift = model.vehicle.speed_limit, model.velocity, model.drift_velocity
    if limit is None or velocity is None or drift is None:
        return None
    brakes = np.abs(velocity) @ np.maximum(model.control_bounds, 0.0).ravel()
    above = np.abs(drift[1:]) - brakes[1:] - limit > UNREACHED
    if not above.any():
        return None
    step, axis = (int(k) for k in np.argwhere(above)[0] + (1, 0))
    along, most = f"along {'xyz'[axis]}", f"speed_limit {limit[axis]:g}"
    start = abs(float(drift[0, axis]))
    if step == 1 and start > limit[axis]:
        left = "" if model.vehicle.gain is None else ", which is what its feedback leaves,"
        text = (
            f"starts at {start:g} m/s {along} and cannot be below {most} at step 1 (braking by "
            f"{brakes[1, axis]:.3g} m/s{left} in a step)."
        )
        return text, text.replace("starts", "start", 1).replace("its", "their")
    least = abs(float(drift[step, axis])) - float(brakes[step, axis])
    text = (
        f"is at {least:.3g} m/s or more {along} at step {step}, whatever its control: above {most}."
    )
    return text, text.replace("is", "are", 1).replace("its", "their")


def _limits(model: CondensedModel) -> str:
    """Name the limits of a vehicle."""
    return "control limits" if model.vehicle.speed_limit is None else "control and speed limits"


def _because(model: CondensedModel) -> str:
    """Return what feedback keeps back, where that is much, in brackets."""
    kept = reserve_reason(model)
    return f" (the feedback {kept})" if kept else ""


def _too_far(scenario: Scenario, model: CondensedModel) -> Texts:
    """Return the sentence that a goal is out of reach by the horizon."""
    steps = count_text(scenario.horizon, "step")
    drift = strong_drift_text(model.vehicle, scenario.dt, scenario.horizon)
    because = _because(model) if drift is None else f" ({drift})"
    end = (
        f" within {steps} ({scenario.horizon * scenario.dt:g} s) under its control and speed "
        f"limits{because}, obstacles aside."
    )
    return (
        f"cannot reach its goal{end}",
        f"cannot reach their goals{end.replace(' its ', ' their ')}",
    )


def _late(scenario: Scenario, model: CondensedModel) -> Texts:
    """Return the sentence that a goal is out of reach by the end of its window."""
    due, last = model.vehicle.goal.window(model.horizon)[1], model.horizon
    best = _earliest(model, due, last)
    if best is None:
        told = f", nor within {count_text(last, 'step')} ({last * scenario.dt:g} s),"
        cure = "widen `goal.within` and lengthen the horizon"
    else:
        told = f" ({count_text(best, 'step')} at best, {best * scenario.dt:g} s),"
        cure = "widen `goal.within`"
    text = (
        f"cannot be at its goal by step {due}, the end of its window{told} under its "
        f"{_limits(model)}{_because(model)}, obstacles aside: {cure}."
    )
    return text, _of_many(text)


def _earliest(model: CondensedModel, failed: int, horizon: int) -> int | None:
    """Return the first step from which on a vehicle can be at its goal until the horizon."""
    if not reaches_goal(model, None):
        return None
    later = range(failed + 1, horizon)
    return later.start + bisect_left(later, True, key=lambda step: reaches_goal(model, (1, step)))


def _beyond_reach(model: CondensedModel) -> Texts | None:
    """Say that full throttle does not lead to a box and on to the goal in time."""
    if not model.vehicle.via:
        return None
    from radmpc.model.visits import steps_of_visits  # noqa: PLC0415 - few visit anything

    via = model.vehicle.via
    for j, (first, last) in enumerate(steps_of_visits(via, model.horizon)):
        during = slice(first, last + 1)
        gap = np.maximum(
            model.reach_lower[during] - via[j].upper, via[j].lower - model.reach_upper[during]
        )
        if float(gap.max(axis=1).min()) > UNREACHED:
            text = (
                f"cannot be in the box of via[{j}] at any step from {first} to {last} and at its "
                f"goal in time under its {_limits(model)}, obstacles aside."
            )
            return text, _of_many(text)
    return None


def _unvisited(scenario: Scenario, model: CondensedModel) -> Texts:
    """Return the sentence that visits take more time or control than there is."""
    due = model.vehicle.goal.window(model.horizon)[1]
    under = f"under its {_limits(model)}"
    if model.vehicle.gain is not None and makes_visits(_without_feedback(scenario, model)):
        under = (
            f"under what its feedback leaves of its {_limits(model)} (the feedback "
            f"{reserve_text(model)}; without it there is a way)"
        )
    text = (
        f"cannot make {_visits(model)} and be at its goal by step {due} ({due * scenario.dt:g} s) "
        f"{under}, obstacles aside."
    )
    return text, _of_many(text)


def _without_feedback(scenario: Scenario, model: CondensedModel) -> CondensedModel:
    """Return a vehicle with all of its control."""
    bare = in_empty_space(scenario, replace(model.vehicle, gain=None))
    return condensed_models(bare)[0]


def _visits(model: CondensedModel) -> str:
    """Name the visit that is too much by itself, or else all of them."""
    via = model.vehicle.via
    for j, visit in enumerate(via):
        alone = replace(model, vehicle=replace(model.vehicle, via=(visit,)))
        if len(via) == 1 or makes_visits(alone) is False:
            between = visit.between
            if between is None:
                return f"its visit via[{j}]"
            first, last = between
            when = f"at step {first}" if first == last else f"between steps {first} and {last}"
            return f"its visit via[{j}] {when}"
    return f"its {len(via)} visits in order"


def _of_many(text: str) -> str:
    """Return what is said of a vehicle as it is said of several."""
    many = text.replace(" its ", " their ").replace("their goal ", "their goals ")
    for one in ("window", "visit"):
        many = many.replace(f"their {one} ", f"their {one}s ").replace(
            f"their {one},", f"their {one}s,"
        )
    return many
