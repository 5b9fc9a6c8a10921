"""Hazards far from the plan at hand, which a relaxation leaves out at first."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import fleet, paper
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.proof.part import Part, PartOrder, PartTask, tails_for
from radmpc.planners.certified.proof.part_search import search_part, search_part_elsewhere
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planning import plan
from radmpc.program.build import condensed_models, point_of
from radmpc.program.relaxed.build import Relaxation, build_relaxation
from radmpc.program.relaxed.left_out import near_each_other
from radmpc.solvers.solution import Limits

PRICE = 3.0


def paths_of(scenario: Scenario, controls: tuple[np.ndarray, ...]) -> np.ndarray:
    models = condensed_models(scenario)
    return np.stack([model.path(u) for model, u in zip(models, controls, strict=True)])


def controls_of(scenario: Scenario) -> tuple[np.ndarray, ...]:
    result = plan(scenario, planner="certified(0)")
    assert result.plan is not None
    return tuple(each.controls for each in result.plan.trajectories)


def relaxed(scenario: Scenario, around: np.ndarray | None) -> Relaxation:
    models = condensed_models(scenario)
    return build_relaxation(scenario, models, tails_for(scenario), 16, around=around)


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_what_is_left_out_is_far_from_the_plan_and_what_is_not_is_as_it_was(
    avoidance: str,
) -> None:
    scenario = replace(paper(4, 0), avoidance=avoidance)
    paths = paths_of(scenario, controls_of(scenario))
    whole, near = relaxed(scenario, None), relaxed(scenario, paths)
    assert whole.left_out == ()
    assert near.left_out
    assert not any(vicinity.is_near(paths) for vicinity in near.left_out)
    kept = {(item.cause, item.vehicle, item.other) for item in near.program.avoidances}
    rows = [
        sum((item.cause, item.vehicle, item.other) in kept for item in made.program.avoidances)
        for made in (whole, near)
    ]
    assert rows[0] == rows[1] == near.program.num_avoidances < whole.program.num_avoidances


def test_a_path_through_what_was_left_out_is_close_to_it() -> None:
    scenario = paper(4, 0)
    paths = paths_of(scenario, controls_of(scenario))
    left_out = relaxed(scenario, paths).left_out
    assert left_out
    for vicinity in left_out:
        through = paths.copy()
        center = 0.5 * (vicinity.lower + vicinity.upper)[0]
        if vicinity.other >= 0:
            center = center + through[vicinity.other][vicinity.windows[0] + 1]
        through[vicinity.body][vicinity.windows + 1] = center
        assert vicinity.is_close(through)
        assert not vicinity.is_close(paths)


def past(*boxes: Obstacle) -> Scenario:
    """Return a vehicle with little noise that is to go 10 m along x, past boxes."""
    base = paper(1, 0)
    vehicle = replace(
        base.vehicles[0],
        start=np.zeros(4),
        goal=Goal(np.array([9.9, -0.1]), np.array([10.1, 0.1]), np.full(2, 0.05)),
        disturbance_covariance=1e-4 * np.eye(4),
        initial_covariance=1e-4 * np.eye(4),
    )
    return replace(base, vehicles=(vehicle,), obstacles=boxes, workspace=None)


def searched(scenario: Scenario, controls: tuple[np.ndarray, ...], *, is_whole: bool) -> RelaxedSet:
    """Return the first search of a part, or the one after it."""
    found = Fleet.of(scenario, 1e-3, Limits())
    members = tuple(range(scenario.num_vehicles))
    incumbent = FleetIncumbent(controls, 1e3, (members,))
    part = Part.of(found, incumbent, members, tails_for(scenario))
    order = PartOrder(PRICE, 16, 1e-3, 2_000, 0.0, float("inf"), is_whole=False)
    answer = search_part(PartTask(part, {}, order), Limits())
    if is_whole:
        order = replace(order, is_whole=True)
        answer = search_part(PartTask(part, answer.sets, order), Limits())
    return answer.sets[members]


def test_what_was_left_out_counts_where_the_best_point_goes_through_it() -> None:
    far_around = controls_of(past(Obstacle.box("large", (4.0, -3.0), (6.0, 9.0))))
    scenario = past(Obstacle.box("small", (4.5, -0.5), (5.5, 0.5)))
    first, then = (searched(scenario, far_around, is_whole=each) for each in (False, True))
    assert [vicinity.body for vicinity in first.built.left_out] == [0]
    assert first.bound == pytest.approx(first.base)
    assert not first.is_complete
    assert then.built.left_out == ()
    assert then.is_complete
    assert then.bound > 1.01 * first.bound
    # A bound at a price: what the plan costs with all that it may risk.
    assert then.bound <= plan(scenario).cost + PRICE * scenario.risk_bound


def test_what_nothing_is_lost_by_leaving_out_is_not_searched_anew() -> None:
    small = Obstacle.box("small", (4.5, -0.5), (5.5, 0.5))
    scenario = past(small, Obstacle.box("aside", (4.0, 4.5), (6.0, 5.0)))
    controls = controls_of(scenario)
    first, then = (searched(scenario, controls, is_whole=each) for each in (False, True))
    assert len(first.built.left_out) == 1
    assert first.is_complete
    assert then.built.program.num_avoidances == first.built.program.num_avoidances


@pytest.mark.parametrize("seed", range(3))
def test_bounds_found_near_a_plan_are_no_higher_than_those_of_all_hazards(seed: int) -> None:
    scenario = paper(3, seed)
    controls = controls_of(scenario)
    near, then = (searched(scenario, controls, is_whole=each) for each in (False, True))
    models = condensed_models(scenario)
    base = near.base
    whole = RelaxedSet.of(scenario, models, base, tails_for(scenario), 16)
    whole = whole.searched(Limits(), PRICE, (), 1e-3, 20_000, point_of(models, controls))
    assert near.bound <= whole.value * (1.0 + 1e-9)
    assert then.bound <= whole.value * (1.0 + 1e-9)
    # And little is lost: nothing that was left out is in the way.
    assert then.bound == pytest.approx(whole.bound, rel=3e-3)


def test_a_search_in_another_process_goes_on_where_it_was_left() -> None:
    scenario = paper(3, 1)
    controls = controls_of(scenario)
    members = (0, 1, 2)
    incumbent = FleetIncumbent(controls, 1e3, (members,))
    part = Part.of(Fleet.of(scenario, 1e-3, Limits()), incumbent, members, tails_for(scenario))
    order = PartOrder(PRICE, 16, 1e-3, 3, 0.0, float("inf"), is_whole=False)
    here, there = PartTask(part, {}, order), PartTask(part, {}, order)
    for nodes in (3, 20, 100):
        asked = replace(order, nodes=nodes)
        kept = search_part(replace(here, order=asked), Limits())
        sent = pickle.dumps(replace(there, order=asked).to_be_sent())
        answer = search_part_elsewhere(pickle.loads(sent), Limits())
        assert all(found.built is None for found in answer.sets.values())
        assert len(pickle.dumps(answer)) < 0.2 * len(pickle.dumps(kept))
        assert answer.nodes == kept.nodes
        for blocks, found in answer.sets.items():
            assert found.bound == pytest.approx(kept.sets[blocks].bound, rel=1e-9)
            assert len(found.frontier) == len(kept.sets[blocks].frontier)
        here, there = replace(here, proven=kept.sets), replace(there, proven=answer.sets)


def test_a_search_of_another_program_begins_anew() -> None:
    scenario = paper(2, 3)
    models = condensed_models(scenario)
    hint = point_of(models, controls_of(scenario))
    whole = RelaxedSet.of(scenario, models, 1.0, tails_for(scenario), 16)
    found = whole.searched(Limits(), PRICE, (), 1e-6, 4, hint)
    sent = found.to_be_sent()
    assert sent.to_be_sent() is sent
    assert sent.built_anew(whole).frontier == found.frontier
    other = RelaxedSet.of(scenario, models, 1.0, tails_for(scenario), 8)
    assert sent.built_anew(other).frontier == ((-float("inf"), ()),)


def test_only_vehicles_among_many_obstacles_of_their_own_have_their_reach_narrowed() -> None:
    scenario = fleet(64, 0)
    assert len(scenario.obstacles) >= 12
    found = Fleet.of(scenario, 1e-3, Limits())
    controls = tuple(np.zeros((scenario.horizon, 2)) for _ in scenario.vehicles)
    incumbent = FleetIncumbent(controls, 1e3, tuple((i,) for i in range(64)))
    for i in range(6):
        part = Part.of(found, incumbent, (i,), tails_for(scenario))
        assert part.is_narrowed == (len(part.scenario.obstacles) >= 12)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("seed", range(3))
def test_two_vehicles_that_a_relaxation_keeps_apart_are_near_each_other(
    seed: int, avoidance: str
) -> None:
    scenario = replace(paper(6, seed), avoidance=avoidance)
    paths = paths_of(scenario, controls_of(scenario))
    models = condensed_models(scenario)
    largest = [np.trace(m.position_covariances, axis1=1, axis2=2).max() for m in models]
    radii = np.array([vehicle.radius for vehicle in scenario.vehicles])
    near = near_each_other(paths, radii, np.sqrt(largest), intervals=avoidance == "intervals")
    names = [vehicle.name for vehicle in scenario.vehicles]
    kept = relaxed(scenario, paths).program.avoidances
    pairs = {(names.index(p.vehicle), names.index(p.other)) for p in kept if p.cause == "pair"}
    assert pairs
    assert all(near[i, j] and near[j, i] for i, j in pairs)
    assert near.diagonal().all()
    far = paths + 100.0 * np.arange(len(names))[:, None, None]
    apart = near_each_other(far, radii, np.sqrt(largest), intervals=avoidance == "intervals")
    assert (apart == np.eye(len(names), dtype=bool)).all()


def test_sets_of_vehicles_that_keep_apart_are_searched_only_once_all_hazards_count() -> None:
    """Of three two drive side by side; the third does so a hundred meters away."""
    base, lanes = past(), (0.0, 1.5, 100.0)
    vehicles = tuple(
        replace(
            base.vehicles[0],
            name=f"v{lane}",
            start=np.array([0.0, lane, 0.0, 0.0]),
            goal=Goal(np.array([9.9, lane - 0.1]), np.array([10.1, lane + 0.1]), np.full(2, 0.05)),
        )
        for lane in lanes
    )
    scenario = replace(base, vehicles=vehicles)
    controls = controls_of(scenario)
    part = Part.of(
        Fleet.of(scenario, 1e-3, Limits()),
        FleetIncumbent(controls, 1e3, ((0, 1, 2),)),
        (0, 1, 2),
        tails_for(scenario),
    )
    part = replace(part, base=(0.0, 0.0, 0.0))  # Then each promises something.
    order = PartOrder(PRICE, 16, 1e-3, 50, 0.0, float("inf"), is_whole=False)
    first = search_part(PartTask(part, {}, order), Limits()).sets
    assert set(first) == {(0,), (1,), (2,), (0, 1), (0, 1, 2)}
    whole = search_part(PartTask(part, {}, replace(order, is_whole=True)), Limits()).sets
    assert set(whole) == {(0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2)}
