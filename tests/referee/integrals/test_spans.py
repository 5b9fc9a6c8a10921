"""Of long flights only the intervals are looked at closely that tell."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from conditional_missions import check_martingale, flown
from referee_scenes import make_plan

from radmpc import Goal, Obstacle, Scenario, Vehicle
from radmpc.model.dynamics import double_integrator, lqr_gain
from radmpc.model.plan import Plan
from radmpc.referee import certify
from radmpc.referee.bound import intervals
from radmpc.referee.bound.parts import part_sites
from radmpc.referee.conditional.conditional import conditional, witnesses_of
from radmpc.referee.conditional.scales import Scale
from radmpc.referee.encounters import Encounters
from radmpc.referee.gather import gather_obstacles, gather_pairs
from radmpc.referee.motion import FleetMotion
from radmpc.referee.propagation import propagate

HORIZON = 32


def vehicle(name: str, start: list[float], speed: list[float]) -> Vehicle:
    system = double_integrator(1.0, 2)
    return Vehicle(
        name=name,
        system=system,
        start=[*start, *speed],
        goal=Goal.at([0.0, 0.0], 100.0, speed=None),
        radius=0.4,
        control_limit=3.0,
        initial_covariance=1e-3,
        disturbance_covariance=1e-3,
        gain=lqr_gain(system, np.eye(4), np.eye(2)),
    )


def crossing(seed: int) -> Plan:
    """Return three that cross a square and pass each other and a box now and then."""
    rng = np.random.default_rng(seed)
    fleet = (
        vehicle("a", [0.0, 0.0], [1.0, 0.0]),
        vehicle("b", [16.0, -14.4 + rng.uniform(-0.1, 0.1)], [0.0, 1.0]),
        vehicle("c", [30.0, 1.15], [-1.0, 0.0]),
    )
    box = Obstacle.box("box", [10.0, 0.65], [12.0, 0.7])
    scenario = Scenario("long", 1.0, HORIZON, 0.05, fleet, (box,))
    pushes = [rng.normal(0.0, 0.0005, (HORIZON, 2)) for _ in fleet]
    return make_plan(scenario, pushes)


def batches(plan: Plan) -> tuple[FleetMotion, list[Encounters]]:
    motion = propagate(plan.scenario, [t.controls for t in plan.trajectories])
    gathers = (gather_obstacles, gather_pairs)
    found = [gather(plan.scenario, motion, intervals=True) for gather in gathers]
    return motion, [batch for each in found for batch in each.batches]


@pytest.mark.parametrize("seed", range(6))
def test_intervals_that_tell_cost_no_more_than_the_whole_flight(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion, found = batches(crossing(seed))
    spans = [intervals.interval_risks(batch, motion).sum(axis=1) for batch in found]
    monkeypatch.setattr(intervals, "_SPAN", HORIZON)
    monkeypatch.setattr(intervals, "LARGE", 0.01)
    whole = [intervals.interval_risks(batch, motion).sum(axis=1) for batch in found]
    for one, other in zip(spans, whole, strict=True):
        # Neither search finds the best of all half-spaces.
        assert np.all(one <= 1.05 * other + 1e-12)
        assert np.all(one >= 0.7 * other)
        assert 1e-9 < one.max() < 0.9


def test_a_span_of_a_flight_is_that_flight_in_between() -> None:
    motion, found = batches(crossing(0))
    for batch in found:
        begins = np.arange(len(batch.means)) % 3 + 2
        part = batch.during(begins, 8)
        for i, k in enumerate(begins.tolist()):
            assert np.array_equal(part.means[i], batch.means[i, k : k + 9])
            assert np.array_equal(part.sagittas[i], batch.sagittas[i, k : k + 8])
        parted, crossed = part_sites(part, motion, 4)
        full, links = part_sites(batch, motion, 4)
        both = (parted.covariances, full.covariances), (crossed.bent_with_far, links.bent_with_far)
        for pair in both:
            got, known = (each.reshape(len(begins), -1, *each.shape[1:]) for each in pair)
            for i, k in enumerate(begins.tolist()):
                assert np.allclose(got[i], known[i, 4 * k : 4 * (k + 8)], rtol=1e-12)


def unsure(plan: Plan) -> Plan:
    return replace(plan, scenario=replace(plan.scenario, covariance_samples=30))


@pytest.mark.slow
@pytest.mark.sampled(3)
@pytest.mark.parametrize("change", [lambda plan: plan, unsure])
@pytest.mark.parametrize("seed", range(6))
def test_before_anything_is_measured_a_long_flight_is_worth_its_certificate(
    seed: int, change: Callable[[Plan], Plan]
) -> None:
    plan = change(crossing(seed))
    witnesses = witnesses_of(plan)
    value, certified = conditional(witnesses, 0, None), certify(plan).certified
    assert value.total == pytest.approx(certified, rel=1e-7)
    # 1.6 % of Gaussians, and 0.1 % each way of the sum that stands for Student's t.
    assert value.total / 1.0195 <= value.least <= value.total
    # In spans: parts of all intervals would be many more rows.
    rows, ends = witnesses.halfspaces, 3
    assert len(rows.windows) < 0.6 * len(witnesses.parties.causes) * HORIZON * 4 * ends
    states = [x[-1] for x in witnesses.motion.states]
    scale = Scale(90) if plan.scenario.covariance_samples else None
    assert conditional(witnesses, HORIZON, states, scale).total == 0.0


@pytest.mark.slow
def test_what_is_left_of_a_long_flight_is_a_martingale() -> None:
    witnesses = witnesses_of(crossing(3))
    check_martingale(witnesses, flown(witnesses, 1_000, seed=7), steps=(15, 22))
