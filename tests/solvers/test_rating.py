"""Ratings and choices of compiled code against the same in NumPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import clutter, paper
from radmpc.model.scenario import Scenario
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.compiled_code import is_compiled
from radmpc.solvers.priced.branching import BranchingChoice
from radmpc.solvers.priced.rating import Rater, Rating
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

pytestmark = pytest.mark.skipif(not is_compiled(), reason="no compiled code here")

UNIT, PRICE = 0.2, 0.3

SCENES = {
    "pairs and obstacles at steps": paper(3, 0),
    "along intervals": replace(paper(3, 1), avoidance="intervals"),
    "among boxes": clutter(1, 20, 0),
    **{
        f"covariances from {count} samples": replace(paper(3, 2), covariance_samples=count)
        for count in (3, 6, 40, 1000)
    },
    "no noise": replace(
        paper(2, 0),
        vehicles=tuple(
            replace(v, disturbance_covariance=0.0, initial_covariance=0.0)
            for v in paper(2, 0).vehicles
        ),
    ),
}


def rater_of(scenario: Scenario) -> Rater:
    models = condensed_models(scenario)
    return Rater(build_program(scenario, models, risk_bound=scenario.risk_bound), UNIT)


def points_of(rater: Rater, rng: np.random.Generator) -> list[np.ndarray]:
    """Points that a search looks at, and some anywhere."""
    limits = {"gap": 1e-3, "scale": 1e-3, "limits": Limits()}
    tree = RiskTree(rater.program, UNIT, PRICE, rater=rater, **limits)
    seen: list[np.ndarray] = []
    rate = rater.rate
    rater.rate = lambda z: (seen.append(z.copy()), rate(z))[1]  # type: ignore[method-assign] # to see what it is asked
    # Compiled code rates its points itself.
    tree._solver.solve = tree._solver._by_python  # type: ignore[method-assign] # for this search
    tree.run(60)
    del rater.rate
    program = rater.program
    span = program.upper - program.lower
    return [*seen, *(program.lower + span * rng.random(span.size) for _ in range(10))]


@pytest.mark.parametrize("scene", SCENES)
def test_points_are_rated_as_by_numpy(scene: str) -> None:
    rng = np.random.default_rng(1)
    rater = rater_of(SCENES[scene])
    points = points_of(rater, rng)
    assert len(points) > 11
    for z in points:
        ours, theirs = rater.rate(z), rater._rated(z)
        np.testing.assert_allclose(ours.clearances, theirs.clearances, atol=1e-9)
        np.testing.assert_allclose(ours.short, theirs.short, atol=1e-9)
        np.testing.assert_allclose(ours.cheapest, theirs.cheapest, rtol=1e-9, atol=1e-250)
        # Which of two is chosen that are as cheap to the last digit is left open.
        other = ours.selection != theirs.selection
        certain = (theirs.cheapest[other] <= 1e-250) | (theirs.cheapest[other] > 1.0 - 1e-12)
        assert certain.all()
        if not other.any():
            assert ours.risk == pytest.approx(theirs.risk, rel=1e-9)
            assert ours.largest == pytest.approx(theirs.largest, rel=1e-9)
        rows = np.arange(0, ours.clearances.size, 7)
        np.testing.assert_allclose(
            ours.risks(rows), rater.program.tail.probability(theirs.clearances[rows]), rtol=1e-6
        )


@pytest.mark.parametrize("has_plan", [True, False])
@pytest.mark.parametrize("scene", ["pairs and obstacles at steps", "along intervals"])
def test_the_same_avoidance_is_branched_on(scene: str, has_plan: bool) -> None:
    rng = np.random.default_rng(2)
    rater = rater_of(SCENES[scene])
    choice = BranchingChoice(rater.program, rater)
    for z in points_of(rater, rng):
        rating: Rating = rater._rated(z)
        chosen = [int(a) for a in rating.selection[rng.random(rating.selection.size) < 0.2]]
        free = np.ones(rating.cheapest.size, dtype=bool)
        free[choice.owners[chosen]] = False
        found = choice.most_promising(chosen, rating, has_plan=has_plan)
        assert found == choice._worst(free, rating, by_weight=not has_plan)
        if chosen and rng.random() < 0.5:
            choice.failed(chosen[0])


def test_a_rater_is_sent_to_others_without_what_was_compiled() -> None:
    rater = rater_of(paper(2, 0))
    rater.rate(np.zeros(rater.program.num_columns))
    assert not {"compiled", "tangents"} & set(rater.__getstate__())
