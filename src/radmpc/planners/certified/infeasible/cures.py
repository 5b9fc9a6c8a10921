"""What would help, tried before it is said: each cure is planned, in a few seconds for all."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from functools import partial

from radmpc.errors import ScenarioError
from radmpc.model.obstacle import MovingShape
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.infeasible.least_risk import feasible_within
from radmpc.planners.certified.infeasible.tuning import TUNING
from radmpc.planners.cures.endpoints import endpoint_cures
from radmpc.planners.cures.variants import (
    helps_sentence,
    longer_text,
    softened,
    with_horizon,
    with_noise,
)
from radmpc.planners.cures.windows import later_visit, later_window
from radmpc.planners.endpoints.floors import floors
from radmpc.planners.explain import unable_alone
from radmpc.planners.presolve import hazards_of
from radmpc.planners.reaching.drifting import strong_drift_text
from radmpc.planners.reaching.limits import is_late_whatever_horizon, too_fast_texts
from radmpc.planners.reaching.reserves import reserve_reason
from radmpc.planners.within_norms import models_within_norms
from radmpc.planners.wording import listed
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.ranges import FILE_STEPS
from radmpc.records import dataclass
from radmpc.solvers.solution import Limits

__all__ = ["Cures", "cure_sentence", "endpoint_sentence", "find_cures", "has_plan_within"]


@dataclass(frozen=True, slots=True)
class Cures:
    """What was tried and did.

    Attributes
    ----------
    found : tuple of str
        Each in the imperative, without a full stop; the cheapest to carry out first.
    failed : tuple of str
        What was tried in vain.
    """

    found: tuple[str, ...]
    failed: tuple[str, ...]


def find_cures(scenario: Scenario, limits: Limits) -> Cures:
    """Try what could give vehicles a plan within their bound.

    Parameters
    ----------
    scenario : Scenario
        Vehicles without a plan, alone in their world.
    limits : Limits
        When to stop trying.

    Returns
    -------
    Cures
        Only what led to a plan within Δ by union bounds counts as found.
    """
    models = models_within_norms(scenario)
    if any(too_fast_texts(model) is not None for model in models):
        return Cures((), ())  # other limits or another start help
    found, failed = _more_time(scenario, models, limits.within(TUNING.seconds))
    has_gain = any(v.gain is not None for v in scenario.vehicles)
    is_short = not has_gain and any(unable_alone(scenario, one) is not None for one in models)
    carried = (strong_drift_text(v, scenario.dt, scenario.horizon) for v in scenario.vehicles)
    if is_short and (found or not failed or any(carried)):
        # Out of reach with all of its control: noise has no part in it, feedback leaves less.
        return Cures(tuple(found), () if found else tuple(failed))
    feedback = _feedback(scenario, limits.within(TUNING.seconds))
    if feedback is not None:
        found.append(f"{'soften the' if has_gain else 'add'} feedback ({feedback})")
    elif _is_noisy(scenario):
        failed.append("softer feedback" if has_gain else "feedback")
    if not found and len(failed) > 1:
        found += _both(scenario, limits.within(TUNING.seconds))
    if not found:
        factor = _quieter(scenario, limits.within(TUNING.seconds))
        if factor is not None:
            found.append(f"reduce the noise to {factor:g} of its standard deviations")
    return Cures(tuple(found), tuple(failed))


def cure_sentence(scenario: Scenario, limits: Limits) -> str:
    """Return what would help vehicles that have no plan, in one or two sentences.

    Parameters
    ----------
    scenario : Scenario
        These vehicles alone.
    limits : Limits
        When to stop trying.

    Returns
    -------
    str
        Empty where time was up before anything could be tried.
    """
    if limits.reached:
        return ""
    told = []
    kept = reserve_reason(condensed_models(scenario)[0])
    if kept is not None and scenario.num_vehicles == 1:
        told.append(f"The feedback {kept}.")
    cures = find_cures(scenario, limits)
    if cures.found:
        told.append(helps_sentence(cures.found))
    elif cures.failed:
        told.append(f"Did not help: {listed(cures.failed)}.")
    return " ".join(told)


def endpoint_sentence(scenario: Scenario, members: tuple[int, ...], limits: Limits) -> str:
    """Return what would help vehicles whose starts and goals alone are above Δ.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    members : tuple of int
        Those vehicles.
    limits : Limits
        When to stop trying.

    Returns
    -------
    str
        A sentence; empty where nothing that was tried gives them a plan within Δ.
    """
    if limits.reached:
        return ""
    hazards = hazards_of(floors(scenario, condensed_models(scenario)), members)
    trial = limits.within(TUNING.seconds)
    if not hazards:
        return ""

    def accepts(changed: Scenario) -> bool:
        return has_plan_within(changed, trial.within(TUNING.trial_seconds))

    return helps_sentence(endpoint_cures(scenario, hazards, accepts))


def has_plan_within(scenario: Scenario, limits: Limits) -> bool:
    """Whether a plan within Δ by union bounds is found in the time given.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    limits : Limits
        When to stop looking.
    """
    return feasible_within(scenario, limits) is True


def _more_time(
    scenario: Scenario, models: Sequence[CondensedModel], limits: Limits
) -> tuple[list[str], list[str]]:
    """Return which later end of windows or of the horizon does, and what was tried in vain."""

    def does(changed: Scenario) -> bool:
        return has_plan_within(changed, limits.within(TUNING.trial_seconds))

    late = [i for i, model in enumerate(models) if is_late_whatever_horizon(model)]
    if late:
        later = later_window(scenario, late, does)
        return ([later], []) if later else ([], [])
    told = list(filter(None, (later_visit(scenario, *one, does) for one in _visits(scenario))))
    if told:
        return told, []
    horizon = _longer(scenario, limits)
    if isinstance(horizon, int):
        return [longer_text(scenario, horizon)], []
    return [], [horizon] if horizon else []


def _visits(scenario: Scenario) -> list[tuple[int, int]]:
    """Return the visits whose windows are tried: those that end before the horizon."""
    return [
        (i, j)
        for i, vehicle in enumerate(scenario.vehicles)
        for j, visit in enumerate(vehicle.via)
        if visit.between is not None and visit.between[1] < scenario.horizon
    ][: TUNING.cured]


def _longer(scenario: Scenario, limits: Limits) -> int | str:
    """Return the shortest horizon tried that does, or what was tried; empty where none can be."""
    if any(isinstance(obstacle.shape, MovingShape) for obstacle in scenario.obstacles):
        # They are given for this horizon alone.
        return ""
    first = _least_time(scenario, limits)
    last, step = max(scenario.horizon, first - 1), 1
    most = min(2 * max(first, scenario.horizon), max(scenario.horizon, FILE_STEPS))
    begun = last
    while last < most and not limits.reached:
        tried = min(last + step, most)
        if _does(scenario, tried, limits):
            between = range(last + 1, tried)
            does = partial(_does, scenario, limits=limits)
            return between.start + bisect_left(between, True, key=does)
        last, step = tried, 2 * step
    return f"a horizon of {last} steps" if last > begun else ""


def _least_time(scenario: Scenario, limits: Limits) -> int:
    """Return the fewest steps, the scenario's at least, in which all reach their goals alone."""
    failed, works = scenario.horizon - 1, scenario.horizon
    while not _reaches(scenario, works):
        failed, works = works, min(works + (works + 1) // 2, max(works, FILE_STEPS))
        is_longest = works == failed or works > TUNING.most_times * scenario.horizon
        if limits.reached or is_longest:
            return scenario.horizon
    between = range(failed + 1, works)
    return between.start + bisect_left(between, True, key=partial(_reaches, scenario))


def _reaches(scenario: Scenario, horizon: int) -> bool:
    """Whether every vehicle reaches its goal in time through empty space."""
    longer = with_horizon(scenario, horizon)
    if longer is None:
        return False
    return all(unable_alone(longer, s) is None for s in models_within_norms(longer))


def _does(scenario: Scenario, horizon: int, limits: Limits) -> bool:
    """Whether a horizon gives a plan; not once time is up."""
    longer = with_horizon(scenario, horizon)
    if longer is None:
        return False
    return has_plan_within(longer, limits.within(TUNING.trial_seconds))


def _feedback(scenario: Scenario, limits: Limits) -> str | None:
    """Return the feedback that does, softer than what there is."""
    for weight, trial in _softer(scenario):
        if limits.reached:
            return None
        if has_plan_within(trial, limits.within(TUNING.trial_seconds)):
            return f"lqr with Q = 1, R = {weight:g} does"
    return None


def _both(scenario: Scenario, limits: Limits) -> Iterator[str]:
    """Yield the feedback that does together with a longer horizon."""
    for weight, trial in _softer(scenario):
        if limits.reached:
            return
        horizon = _longer(trial, limits)
        if isinstance(horizon, int):
            word = "soften the" if any(v.gain is not None for v in scenario.vehicles) else "add"
            told = longer_text(scenario, horizon)
            yield f"{told}, and {word} feedback (lqr with Q = 1, R = {weight:g} does)"
            return


def _softer(scenario: Scenario) -> Iterator[tuple[float, Scenario]]:
    """Yield weights and scenarios with feedback softer than what there is, where noise asks for it.

    One that takes all control is none.
    """
    for weight in TUNING.weights if _is_noisy(scenario) else ():
        candidates = [softened(v, weight, scenario.horizon) for v in scenario.vehicles]
        if any(v is None for v in candidates):
            continue
        try:
            yield weight, scenario.with_vehicles(v for v in candidates if v is not None)
        except ScenarioError:
            continue


def _quieter(scenario: Scenario, limits: Limits) -> float | None:
    """Return how much less noise does."""
    if not _is_noisy(scenario):
        return None
    for factor in TUNING.quieter:
        if has_plan_within(with_noise(scenario, factor**2), limits.within(TUNING.trial_seconds)):
            return factor
    return None


def _is_noisy(scenario: Scenario) -> bool:
    """Whether there is any noise."""
    return any(
        bool(v.initial_covariance.any() or v.disturbance_covariance.any())
        for v in scenario.vehicles
    )
