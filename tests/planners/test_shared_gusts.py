"""Plans for vehicles in one wind."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radmpc
from radmpc.errors import ScenarioError
from radmpc.gaussian import tail_probability
from radmpc.model.dynamics import double_integrator
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.certified import inter_set_risk
from radmpc.planners.certified.inter_set_risk import pair_risks_across_sets
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.program.relative import relative_covariances

GUST = np.vstack([0.5 * np.eye(2), np.eye(2)])


def passing(*sources: tuple[str, np.ndarray] | None, **more: object) -> Scenario:
    """Two that swap places, in the winds that each meets."""
    system = double_integrator(1.0, 2)
    noise = np.diag([2e-3, 2e-3, 5e-4, 5e-4])
    ends = [([0.0, 0.0], [6.0, 0.5]), ([6.0, 0.2], [0.0, 0.1])]
    vehicles = [
        Vehicle(
            name,
            system,
            start,
            Goal(np.array(goal) - 0.3, np.array(goal) + 0.3, np.zeros(2)),
            0.4,
            1.0,
            noise,
            noise,
            shared=() if source is None else (SharedDisturbance(*source, 0.01),),
        )
        for name, (start, goal), source in zip("ab", ends, sources, strict=True)
    ]
    return Scenario("passing", 1.0, 6, 0.05, vehicles, **more)


@pytest.mark.slow
def test_a_gust_that_both_feel_costs_nothing_and_one_for_each_does():
    found = {
        name: radmpc.plan(scenario, "ira", rng=0).require()
        for name, scenario in {
            "still air": passing(None, None),
            "one gust": passing(("wind", GUST), ("wind", GUST)),
            "two gusts": passing(("west", GUST), ("east", GUST)),
        }.items()
    }
    cost = {name: plan.cost for name, plan in found.items()}
    assert cost["one gust"] == pytest.approx(cost["still air"], rel=2e-3)
    assert cost["two gusts"] > 1.1 * cost["one gust"]
    assert all(plan.risk.certified <= 0.05 for plan in found.values())


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_no_plan_is_cheaper_than_what_is_proven_in_opposite_gusts(avoidance):
    scenario = passing(("wind", GUST), ("wind", -GUST), avoidance=avoidance)
    result = radmpc.plan(scenario, "certified", rng=0, time_limit=30.0)
    plan = result.require()
    assert result.is_certified
    assert plan.certified_lower_bound is not None
    assert plan.certified_lower_bound <= plan.cost * (1.0 + 1e-9)
    ira = radmpc.plan(scenario, "ira", rng=0).require()
    assert plan.cost <= ira.cost * (1.0 + 2e-3)


@pytest.mark.parametrize("planner", ["radmpc", "multi-vehicle", "dmpc", "rmpc-rrt"])
def test_planners_of_one_vehicle_at_a_time_refuse_shared_gusts_in_one_line(planner):
    scenario = passing(("wind", GUST), ("wind", GUST))
    with pytest.raises(ScenarioError, match="use certified, ira or distance") as caught:
        radmpc.plan(scenario, planner, rng=0)
    assert "\n" not in str(caught.value)


@pytest.mark.slow
def test_a_fleet_in_one_gust_is_planned_in_sets():
    scenario = passing(("wind", GUST), ("wind", GUST))
    away = np.array([0.0, 30.0])
    far = tuple(
        replace(
            v,
            name=v.name.upper(),
            start=v.start + np.append(away, [0.0, 0.0]),
            goal=Goal(v.goal.lower + away, v.goal.upper + away, v.goal.speed),
        )
        for v in scenario.vehicles
    )
    fleet = replace(scenario, vehicles=(*scenario.vehicles, *far))
    result = radmpc.plan(fleet, "certified", rng=0)
    assert result.is_certified
    assert len(result.require().sets) == 2


def test_what_is_laid_out_for_the_fleet_is_what_programs_say_of_pairs():
    scenario = passing(("wind", GUST), ("wind", -GUST))
    calm = replace(scenario.vehicles[0], name="calm", shared=())
    scenario = replace(scenario, vehicles=(*scenario.vehicles, calm))
    models = condensed_models(scenario)
    hazards = Hazards.of(scenario, models)
    steps = np.arange(7)
    for i, j in ((0, 1), (0, 2), (1, 2)):
        first, second = np.full(7, i), np.full(7, j)
        expected = relative_covariances(models[i], models[j])
        assert hazards.joint(steps, first, second) == pytest.approx(expected, rel=1e-12)
        # What counts as near is near whatever the correlation.
        widest = np.linalg.eigvalsh(expected[1:])[:, -1]
        assert np.all(hazards.variances[i] + hazards.variances[j] >= widest)


def test_the_risk_between_sets_is_that_of_relative_positions():
    scenario = passing(("wind", GUST), ("wind", -GUST), avoidance="steps")
    hazards = Hazards.of(scenario, condensed_models(scenario))
    means = np.zeros((2, 7, 2))
    means[1, :, 0] = 1.3
    owners = np.array([0, 1])
    arguments = (scenario, means, hazards.covariances, owners, None)
    independent = pair_risks_across_sets(*arguments)
    opposite = pair_risks_across_sets(*arguments, hazards.common)
    assert hazards.common is not None
    alike = pair_risks_across_sets(*arguments, np.abs(hazards.common))
    covariances = relative_covariances(*hazards.models)[1:]
    expected = tail_probability(0.5 / np.sqrt(covariances[:, 0, 0])).sum()
    assert opposite[0, 1] == pytest.approx(expected, rel=1e-9)
    assert alike[0, 1] < independent[0, 1] < opposite[0, 1]


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_the_risks_between_sets_are_the_same_however_many_pairs_are_looked_at_at_once(
    avoidance: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    two = passing(("wind", GUST), ("wind", -GUST), avoidance=avoidance)
    names = ("a", "b", "c", "d")
    vehicles = [replace(two.vehicles[k % 2], name=name) for k, name in enumerate(names)]
    scenario = replace(two, vehicles=tuple(vehicles))
    hazards = Hazards.of(scenario, condensed_models(scenario))
    rng = np.random.default_rng(5)
    means = rng.normal(0.0, 0.8, (4, 7, 2))
    sagittas = rng.normal(0.0, 0.02, (4, 6, 2))
    arguments = (scenario, means, hazards.covariances, np.arange(4), sagittas, hazards.common)
    together = pair_risks_across_sets(*arguments)
    assert len(set(together.values())) > 3
    for block in (1, 60):
        monkeypatch.setattr(inter_set_risk, "_BLOCK", block)
        assert pair_risks_across_sets(*arguments) == together
