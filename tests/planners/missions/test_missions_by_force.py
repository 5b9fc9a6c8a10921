"""Goals to assign, a window to visit in and a range to keep, all at once: every choice by force."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from visiting import vehicle

from radmpc import Goal, Keep, Scenario, Visit, certify, plan
from radmpc.model.relations.goals import places_of
from radmpc.model.visits import steps_visited

WITHIN = 4.0
BUOY = Visit.at([2.5, 5.0], 0.5, between=[1, 3])
GOALS = tuple(Goal.at(end, 0.5) for end in ([7.0, 0.0], [7.0, 3.0], [7.0, 12.0]))


def mission(keep: bool = True) -> Scenario:
    """Return two that share three goals, one of them by way of a buoy, as given crosswise."""
    fleet = [
        replace(vehicle("a", [0.0, 0.0], [0.0, 0.0], BUOY), goal=GOALS[1]),
        replace(vehicle("b", [0.0, 3.0], [0.0, 0.0]), goal=GOALS[0]),
    ]
    ranges = [Keep(["a", "b"], WITHIN)] if keep else []
    return Scenario("by force", 1.0, 5, 0.01, fleet, goals=GOALS, keep=ranges, avoidance="steps")


def every_choice(given: Scenario) -> list[Scenario]:
    """Return the mission with every assignment, and the visit at every step of its window."""
    found = []
    for places, step in itertools.product(itertools.permutations(range(3), 2), range(1, 4)):
        via = (replace(BUOY, between=(step, step)),)
        fleet = [replace(v, goal=GOALS[k]) for v, k in zip(given.vehicles, places, strict=True)]
        fleet[0] = replace(fleet[0], via=via)
        found.append(replace(given, vehicles=tuple(fleet), goals=()))
    return found


@pytest.mark.slow
def test_no_assignment_and_no_step_within_range_are_cheaper() -> None:
    given = mission()
    found = plan(given, "dlp")
    costs = [plan(one, "dlp").cost for one in every_choice(given)]
    assert found.cost == pytest.approx(min(c for c in costs if c is not None), rel=1e-3)
    planned = found.require()
    assert certify(planned).problems == ()
    a, b = (trajectory.means for trajectory in planned.trajectories)
    assert np.linalg.norm(a[:, :2] - b[:, :2], axis=1).max() < WITHIN
    steps = steps_visited(planned.scenario.vehicles[0].via, a[:, :2], a[:, 2:])
    assert steps is not None
    assert 1 <= steps[0] <= 3
    taken = places_of(GOALS, [v.goal for v in planned.scenario.vehicles])
    assert None not in taken
    # The range is what it costs: without it the buoy is visited on the way of one alone.
    free = plan(mission(keep=False), "dlp").cost
    assert free is not None
    assert found.cost is not None
    assert free < 0.99 * found.cost


@pytest.mark.slow
def test_bounds_hold_for_every_choice() -> None:
    given = mission()
    told: list[float] = []
    # A few better plans are enough: bounds hold whenever a search ends.
    found = plan(
        given, found=lambda cost, bound: told.append(cost), stop=lambda: len(told) > 3, rng=0
    )
    costs = [plan(one, "dlp").cost for one in every_choice(given)]
    assert found.plan is not None
    assert found.plan.certified_lower_bound is not None
    # Uniform margins are one choice among those that a certificate allows.
    assert found.plan.certified_lower_bound <= min(c for c in costs if c is not None) * (1 + 1e-6)
