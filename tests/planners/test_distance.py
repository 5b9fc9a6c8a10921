"""Planning together whoever comes close."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from radmpc.errors import ScenarioError
from radmpc.experiments.families import paper
from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners import Couplings, Distance, Ira, Planner, Pool, Receding
from radmpc.planners.distance import close_pairs
from radmpc.planners.paper.algorithm_2_radmpc import approximate
from radmpc.planning import plan
from radmpc.referee import certify
from radmpc.solvers.branch.branch import Branch
from running import silent_run


def nearest(one, two):
    """Return how close two straight ways come, by trying many times."""
    shares = np.linspace(0.0, 1.0, 400)[:, None]
    return min(
        np.linalg.norm((a + shares * (b - a)) - (c + shares * (d - c)), axis=1).min()
        for a, b, c, d in zip(one[:-1], one[1:], two[:-1], two[1:], strict=True)
    )


def passing_walls_beside_one_at_rest():
    """Return two vehicles far apart, each with a wall to pass, and one that is in its goal."""
    noise = np.diag([1e-3, 1e-3, 1e-4, 1e-4])

    def vehicle(name, start, goal):
        box = Goal(np.array(goal) - 0.2, np.array(goal) + 0.2, np.full(2, 0.05))
        system = double_integrator(1.0, 2)
        start = np.array([*start, 0.0, 0.0])
        return Vehicle(name, system, start, box, 0.4, np.full(2, 2.0), noise, noise)

    vehicles = (
        vehicle("a", (0, 0), (6, 2.2)),
        vehicle("b", (0, 20), (6, 22.2)),
        vehicle("c", (0, 40), (0, 40)),
    )
    walls = (Obstacle.box("o", [2, 0.5], [3, 5]), Obstacle.box("p", [2, 20.5], [3, 25]))
    return Scenario("walls", 1.0, 8, 0.05, vehicles, walls, avoidance="steps")


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("dimension", [2, 3])
def test_close_pairs_are_those_that_come_within_the_distance(seed, dimension):
    rng = np.random.default_rng(seed)
    ways = rng.uniform(0.0, 30.0, (12, 1, dimension)) + rng.normal(size=(12, 6, dimension)).cumsum(
        axis=1
    )
    pairs, distances = close_pairs(ways, 4.0)
    found = {(int(i), int(j)): d for (i, j), d in zip(pairs, distances, strict=True)}
    for i, j in combinations(range(12), 2):
        distance = nearest(ways[i], ways[j])
        assert found.get((i, j), distance) == pytest.approx(distance, abs=1e-3)
        if abs(distance - 4.0) > 1e-3:
            assert ((i, j) in found) == (distance < 4.0)


@pytest.mark.slow
def test_no_distance_leaves_all_apart_and_a_large_one_joins_all():
    scenario = paper(4, 2)
    assert {len(s) for s in plan(scenario, "distance(0)").sets} == {1}
    together = plan(scenario, "distance(100)")
    assert len(together.sets) == 1
    reference = plan(scenario, Planner(Ira(), Branch(), Distance(1e6)))
    assert together.cost == pytest.approx(reference.cost)
    assert certify(together.require()).certified == pytest.approx(
        together.certificate.certified, rel=1e-9
    )


@pytest.mark.slow
def test_sets_of_the_default_distance_never_lose_a_vehicle():
    for seed in range(2):
        result = plan(paper(6, seed), "distance")
        names = sorted(name for members in result.sets for name in members)
        assert names == sorted(v.name for v in paper(6, seed).vehicles)


@pytest.mark.parametrize("meters", [-1.0, float("inf"), float("nan")])
def test_a_distance_that_is_none_is_refused(meters):
    with pytest.raises(ScenarioError, match="distance"):
        Distance(meters)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({}, "receding"),
        ({"covariances": "reset"}, "receding(reset)"),
        ({"arrivals": "every_step"}, "receding(every_step)"),
        ({"sigmas": 3.44}, "receding(3.44 sigmas)"),
    ],
)
def test_other_readings_of_the_paper_are_options_told_by_the_planner(options, text):
    receding = Receding(**options)
    assert str(receding) == text
    coupled = Planner(Ira(), Branch(), Couplings(approximation=receding))
    assert text in str(Planner(Pool(), Branch(), receding))
    assert ("couplings(1e-06)" if receding == Receding() else text) in str(coupled)


def test_a_controller_that_is_trusted_to_measure_plans_at_less_cost_and_more_risk():
    trusting, careful = (
        plan(paper(3, 4), Planner(Pool(), Branch(), Receding(covariances)))
        for covariances in ("reset", "schedule")
    )
    assert trusting.cost < 0.9 * careful.cost
    assert trusting.certificate.certified > 2.0 * careful.certificate.certified


@pytest.mark.slow
def test_larger_obstacles_of_the_approximation_find_smaller_couplings():
    near, far = (
        plan(paper(3, 4), Planner(Ira(), Branch(), Couplings(approximation=Receding(sigmas=s))))
        for s in (3.0, 6.0)
    )
    assert far.couplings[0].value < 0.9 * near.couplings[0].value


def test_who_counts_again_at_every_step_that_somebody_has_arrived_spends_the_pool_sooner():
    left = {}
    for arrivals in ("once", "every_step"):
        planner = Planner(Pool(), Branch(), Receding(arrivals=arrivals))
        run = approximate(passing_walls_beside_one_at_rest(), planner, silent_run())
        left[arrivals] = run.pool[-1]
    assert 0.0 <= left["every_step"] < 0.9 * left["once"]


@pytest.mark.slow
def test_larger_temporal_obstacles_keep_vehicles_further_apart():
    scenario = paper(6, 2)
    costs = [
        plan(scenario, Planner(Pool(), Branch(), Receding(sigmas=s))).cost for s in (0.0, 3.0, 6.0)
    ]
    assert costs[0] < costs[1] < costs[2]


def test_risk_moved_to_inactive_rows_does_not_lower_the_cost():
    scenario = paper(3, 0)
    right = plan(scenario, Planner(Ira(), Branch(), Distance(100.0)))
    wrong = plan(scenario, Planner(Ira(direction="to_inactive"), Branch(), Distance(100.0)))
    assert right.cost < wrong.cost
    with pytest.raises(ScenarioError, match="direction"):
        Ira(direction="sideways")


@pytest.mark.parametrize("options", [{"arrivals": "never"}, {"sigmas": -1.0}])
def test_unknown_readings_are_refused(options):
    with pytest.raises(ScenarioError, match="must"):
        Receding(**options)
