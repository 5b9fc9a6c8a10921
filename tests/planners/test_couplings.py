"""Why vehicles were planned together."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc import from_dict, plan
from radmpc.experiments.families import circle, fleet, paper


def components(scenario, couplings):
    part_of = {v.name: frozenset([v.name]) for v in scenario.vehicles}
    for coupling in couplings:
        whole = part_of[coupling.vehicle] | part_of[coupling.other]
        part_of |= dict.fromkeys(whole, whole)
    return set(part_of.values())


@pytest.mark.slow
@pytest.mark.sampled(4)
@pytest.mark.parametrize("planner", ["multi-vehicle", "certified", "distance(6)"])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_couplings_connect_the_vehicles_of_every_set_and_no_others(planner, seed):
    scenario = paper(5, seed=seed)
    result = plan(scenario, planner, rng=0)
    assert components(scenario, result.couplings) == {frozenset(s) for s in result.sets}


@pytest.mark.nightly
def test_a_fleets_couplings_connect_its_sets():
    scenario = fleet(12, seed=3)
    result = plan(scenario, rng=0, time_limit=30.0)
    assert len(result.sets) < 12
    assert max(len(members) for members in result.sets) > 2
    assert components(scenario, result.couplings) == {frozenset(s) for s in result.sets}


@pytest.mark.slow
def test_couplings_tell_the_risk_that_exceeds_the_threshold():
    result = plan(paper(5, seed=3), "multi-vehicle(1e-4)", rng=0)
    told = [c.value for c in result.couplings if c.reason == "risk"]
    assert told
    assert all(1e-4 < value <= 1.0 for value in told)


def test_couplings_by_distance_tell_how_close_the_ways_alone_come():
    result = plan(paper(4, seed=2), "distance(6)", rng=0)
    assert result.couplings
    assert all(0.0 <= c.value <= 6.0 for c in result.couplings)


def test_plans_made_together_because_they_would_collide_do_collide_apart():
    scenario = circle(2)
    [coupling] = plan(scenario, rng=0).couplings
    alone = [plan(scenario.subset((i,), 0.5 * scenario.risk_bound)).require() for i in range(2)]
    gap = np.subtract(*(a.trajectories[0].means[:, :2] for a in alone))
    assert coupling.value > scenario.risk_bound / 100
    assert np.abs(gap).max(axis=1).min() < 2.5


def test_planners_that_take_all_together_give_no_reason():
    assert plan(paper(2, seed=1), "ira").couplings == ()


def holding_place_while_a_ferry_passes():
    """Two vehicles at rest in their goals, which both have to leave for a while from step 3 on."""
    outlines = [
        [[-1.2, y - 1], [1.2, y - 1], [1.2, y + 1], [-1.2, y + 1]] for y in range(-12, 10, 2)
    ]
    noise = [0.001, 0.001, 0.0001, 0.0001]
    return from_dict(
        {
            "format": "radmpc/scenario/1",
            "name": "hold",
            "dt": 1.0,
            "horizon": 10,
            "risk_bound": 0.05,
            "avoidance": "steps",
            "obstacles": [{"name": "ferry", "moving": outlines}],
            "defaults": {
                "radius": 0.4,
                "control_limit": 1.5,
                "speed_limit": 2.5,
                "initial_covariance": noise,
                "disturbance_covariance": noise,
            },
            "vehicles": [
                {
                    "name": name,
                    "start": [x, 0.0],
                    "goal": {"center": [x, 0.0], "half_width": 0.4, "speed": 1.0},
                }
                for name, x in (("a", -0.2), ("b", -2.1))
            ],
        }
    )


def test_vehicles_that_meet_on_the_way_back_to_goals_they_had_left_are_planned_together():
    result = plan(holding_place_while_a_ferry_passes(), "multi-vehicle", rng=0)
    assert result.sets == (("a", "b"),)
    assert result.is_certified
