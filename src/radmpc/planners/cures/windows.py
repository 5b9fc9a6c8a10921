"""Later ends of windows of arrival and of visits, for vehicles that are late for theirs."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import replace

from radmpc.model.scenario import Scenario

__all__ = ["later_visit", "later_window"]


def later_window(
    scenario: Scenario, late: Sequence[int], does: Callable[[Scenario], bool]
) -> str | None:
    """Return the advice to let windows of arrival end later.

    Parameters
    ----------
    scenario : Scenario
        These vehicles alone.
    late : sequence of int
        Vehicles that cannot be at their goals by the ends of their windows.
    does : callable
        Whether a changed scenario has a plan; False once time is up.

    Returns
    -------
    str or None
        The earliest end that is found to do; None where that of the horizon does not.
    """
    ends = [scenario.vehicles[i].goal.window(scenario.horizon)[1] for i in late]
    failed, works = max(ends), scenario.horizon
    if not does(_ending_at(scenario, late, works)):
        return None
    later = range(failed + 1, works)
    works = later.start + bisect_left(
        later, True, key=lambda step: does(_ending_at(scenario, late, step))
    )
    return f"let `goal.within` end at step {works} ({works * scenario.dt:g} s)"


def _ending_at(scenario: Scenario, late: Sequence[int], step: int) -> Scenario:
    """Return a scenario whose late vehicles' windows end at a step."""
    vehicles = list(scenario.vehicles)
    for i in late:
        goal = vehicles[i].goal
        first = goal.window(scenario.horizon)[0]
        vehicles[i] = replace(vehicles[i], goal=replace(goal, within=(first, step)))
    return replace(scenario, vehicles=tuple(vehicles))


def later_visit(
    scenario: Scenario, i: int, visit: int, does: Callable[[Scenario], bool]
) -> str | None:
    """Return the advice to let the window of a visit end later.

    Parameters
    ----------
    scenario : Scenario
        These vehicles alone.
    i : int
        The vehicle that makes the visit.
    visit : int
        Which of its visits.
    does : callable
        As for `later_window`.

    Returns
    -------
    str or None
        The earliest end that is found to do; None where that before the horizon does not.
    """
    between = scenario.vehicles[i].via[visit].between
    if between is None:
        return None
    works = scenario.horizon - 1
    if between[1] >= works or not does(_visited_by(scenario, i, visit, works)):
        return None
    later = range(between[1] + 1, works)
    works = later.start + bisect_left(
        later, True, key=lambda step: does(_visited_by(scenario, i, visit, step))
    )
    whose = f" of vehicle {scenario.vehicles[i].name!r}" if scenario.num_vehicles > 1 else ""
    return f"let `between` of via[{visit}]{whose} end at step {works} ({works * scenario.dt:g} s)"


def _visited_by(scenario: Scenario, i: int, visit: int, step: int) -> Scenario:
    """Return a scenario in which the window of a visit ends at a step."""
    vehicles = list(scenario.vehicles)
    via = list(vehicles[i].via)
    between = via[visit].between
    assert between is not None
    via[visit] = replace(via[visit], between=(between[0], step))
    vehicles[i] = replace(vehicles[i], via=tuple(via))
    return replace(scenario, vehicles=tuple(vehicles))
