"""One vehicle's linear program over its controls has the optimum of the one over its positions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from visiting import scene

from radmpc.experiments.families import circle, clutter, paper
from radmpc.experiments.swarms import swarm
from radmpc.model.scenario import Scenario
from radmpc.model.visits import Visit
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear.alone_lp import plan_alone
from radmpc.planners.certified.turned.linear.group_lp import GroupLp
from radmpc.planners.certified.turned.linear.margins import Margins, fixed_margins
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.paths import Paths, arched
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.program.limits.hard import keeps_hard_rows

CLEARANCE = 3.0


def along(scenario: Scenario) -> Scenario:
    return replace(scenario, avoidance="intervals")


def drawn(scenario: Scenario, seed: int) -> tuple[Hazards, Paths]:
    """Return paths that wander about straight lines, whether or not any controls follow them."""
    rng, hazards = np.random.default_rng(seed), Hazards.of(scenario, condensed_models(scenario))
    paths = Paths(hazards)
    for i in range(hazards.count):
        places = arched(hazards, i, rng.uniform(-0.3, 0.3))
        at = np.linspace(0.0, 1.0, hazards.horizon + 1)
        line = np.linspace(0.0, 1.0, len(places))
        timed = np.stack([np.interp(at, line, axis) for axis in places.T], axis=1)
        paths.refer(i, timed + np.sin(np.pi * at)[:, None] * rng.normal(0.0, 0.2, timed.shape))
    return hazards, paths


def asked(hazards: Hazards, paths: Paths, i: int, penalty: float) -> tuple[HalfSpaces, Margins]:
    near = Near(CLEARANCE, float(hazards.reaches[i]), is_refined=False)
    spaces = half_spaces(hazards, paths, (i,), near)
    return spaces, fixed_margins(spaces.deviations, CLEARANCE, penalty)


def effort(model: CondensedModel, controls: np.ndarray) -> float:
    return model.vehicle.cost_weight * float(np.abs(controls).sum())


def missed(
    hazards: Hazards,
    i: int,
    controls: np.ndarray,
    paths: Paths,
    asked_of: tuple[HalfSpaces, Margins],
) -> float:
    """Return what the ends of half-spaces miss in all, by looking at each."""
    spaces, margins = asked_of
    flown = Paths(hazards)
    flown.restore(paths.state())
    flown.fly(i, controls)
    total = 0.0
    for w in range(spaces.count):
        window, share = int(spaces.windows[w]), float(spaces.shares[w])
        for end, kept in ((0, share), (1, 1.0 - share)):
            if end == 0 and not hazards.intervals:
                continue
            heights = [height(flown, spaces, w, end, kept)] if kept and hazards.intervals else []
            # Where a vehicle starts is given.
            heights += [height(flown, spaces, w, end, 0.0)] if window + end else []
            asked_for = float(spaces.offsets[w, end] + margins.distances[w, end])
            total += max([asked_for - each for each in heights] + [0.0])
    return total


def height(paths: Paths, spaces: HalfSpaces, w: int, end: int, kept: float) -> float:
    """Return the left side of a half-space at an end, less the reserve that is kept there [m]."""
    window, found = int(spaces.windows[w]), 0.0
    for sign, who in ((1.0, int(spaces.first[w])), (-1.0, int(spaces.second[w]))):
        if who >= 0:
            at = paths.means[who, window + end] - 4.0 * kept**2 * paths.sagittas[who, window]
            found += sign * float(spaces.normals[w] @ at)
    return found


@pytest.mark.sampled(10)
@pytest.mark.parametrize("penalty", [3.0, 300.0])
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    "scenario",
    [paper(5, 0), along(paper(5, 1)), along(clutter(3, 30, 0)), swarm(8, 0), along(circle(6))],
    ids=["steps", "intervals", "boxes", "space", "circle"],
)
def test_both_programs_find_plans_worth_the_same(
    scenario: Scenario, seed: int, penalty: float
) -> None:
    hazards, paths = drawn(scenario, seed)
    for i, model in enumerate(hazards.models):
        spaces, margins = asked(hazards, paths, i, penalty)
        found = plan_alone(hazards, i, spaces, paths, margins)
        other = GroupLp(hazards, (i,)).solve(spaces, paths, margins)
        assert found is not None
        assert other is not None
        (controls,) = found.controls
        assert keeps_hard_rows(model, controls)
        told = missed(hazards, i, controls, paths, (spaces, margins))
        assert told == pytest.approx(found.shortfall, abs=1e-6)
        value = effort(model, controls) + penalty * found.shortfall
        wanted = effort(model, other.controls[0]) + penalty * other.shortfall
        assert value == pytest.approx(wanted, rel=1e-7, abs=1e-6)


def test_nothing_in_the_way_leaves_the_least_effort() -> None:
    scenario = paper(2, 0)
    hazards, paths = drawn(scenario, 0)
    spaces, margins = asked(hazards, paths, 0, 1.0)
    nothing = np.zeros(spaces.count, dtype=bool)
    found = plan_alone(hazards, 0, spaces.of(nothing), paths, margins.of(nothing))
    alone = GroupLp(hazards, (0,)).alone()
    assert found is not None
    assert alone is not None
    assert found.shortfall == 0.0
    model = hazards.models[0]
    assert effort(model, found.controls[0]) == pytest.approx(effort(model, alone[0]), rel=1e-9)


def test_who_cannot_reach_its_goal_has_no_plan() -> None:
    scenario = paper(2, 0)
    first = scenario.vehicles[0]
    far = replace(
        first, goal=replace(first.goal, lower=first.goal.lower + 1e3, upper=first.goal.upper + 1e3)
    )
    hazards, paths = drawn(scenario, 0)
    models = condensed_models(replace(scenario, vehicles=(far, *scenario.vehicles[1:])))
    unreachable = replace(hazards, models=models)
    spaces, margins = asked(hazards, paths, 0, 1.0)
    assert plan_alone(unreachable, 0, spaces, paths, margins) is None


def test_visits_at_given_steps_are_made() -> None:
    visit = Visit(lower=np.array([3.0, 1.0]), upper=np.array([3.5, 1.5]), between=(4, 4))
    hazards, paths = drawn(scene(visit), 0)
    spaces, margins = asked(hazards, paths, 0, 100.0)
    found = plan_alone(hazards, 0, spaces, paths, margins)
    assert found is not None
    assert keeps_hard_rows(hazards.models[0], found.controls[0])
