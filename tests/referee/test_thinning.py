"""Plans of fewer steps: how far off they are, and that what is certified covers that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radmpc
from radmpc.errors import ArgumentError, ArgumentTypeError, NoPlanError, ScenarioError
from radmpc.model.plan import Plan
from radmpc.model.visits import steps_visited
from running import first_plan

SYSTEM = radmpc.double_integrator(1.0, 2)


def boat(name: str, start: list[float], goal: list[float], **more: object) -> radmpc.Vehicle:
    return radmpc.Vehicle(
        name=name, system=SYSTEM, start=start, goal=radmpc.Goal.at(goal, 0.5), radius=0.4,
        control_limit=1.0, initial_covariance=1e-2, disturbance_covariance=1e-2,
        gain=radmpc.lqr_gain(SYSTEM, np.eye(4), np.eye(2)), **more,
    )  # fmt: skip


@pytest.fixture(scope="module")
def plan() -> Plan:
    """Two that cross beside a rock, one of them by way of a buoy."""
    buoy = radmpc.Visit.at([10.0, -3.0], 0.4)
    boats = [boat("a", [0, 0], [20, 0], via=[buoy]), boat("b", [20, 3], [0, 3])]
    rock = radmpc.Obstacle.box("rock", [8, 0.5], [11, 1.5])
    scenario = radmpc.Scenario(
        "bay", 1.0, 14, 0.05, boats, [rock], workspace=radmpc.Workspace([-5, -8], [25, 8])
    )
    return first_plan(scenario, time_limit=60.0).require()


def path(plan: Plan, i: int, times: np.ndarray) -> np.ndarray:
    """Mean positions at any times, from controls held over steps."""
    states = plan.trajectories[i].means
    k = np.minimum(times.astype(int), plan.scenario.horizon - 1)
    s = (times - k)[:, None]
    pushes = plan.trajectories[i].controls[k]
    return states[k, :2] + s * states[k, 2:] + 0.5 * s**2 * pushes


def legs(plan: Plan, i: int, kept: tuple[int, ...], times: np.ndarray) -> np.ndarray:
    """Positions on straight legs at even speeds."""
    corners = plan.trajectories[i].means[list(kept), :2]
    return np.column_stack([np.interp(times, kept, column) for column in corners.T])


@pytest.mark.parametrize("tolerance", [0.02, 0.1, 0.3, 1.0])
def test_straight_legs_are_as_near_to_the_plan_as_is_said(plan: Plan, tolerance: float) -> None:
    thinned = radmpc.thin(plan, tolerance)
    times = np.linspace(0.0, plan.scenario.horizon, 4001)
    for i, vehicle in enumerate(plan.scenario.vehicles):
        kept = thinned.steps[vehicle.name]
        away = np.linalg.norm(legs(plan, i, kept, times) - path(plan, i, times), axis=1)
        assert away.max() <= thinned.deviations[vehicle.name] + 1e-9
        # It is no more than a bound of the differences at steps and the bend between.
        assert thinned.deviations[vehicle.name] <= max(away.max() + 0.13, 1e-9)
    assert thinned.certificate.holds
    assert thinned.tolerance <= tolerance


def test_a_larger_tolerance_leaves_fewer_steps(plan: Plan) -> None:
    counts = [
        sum(map(len, radmpc.thin(plan, tolerance).steps.values())) for tolerance in (1e-6, 0.2, 0.5)
    ]
    assert counts[0] >= counts[1] >= counts[2]
    assert counts[0] > counts[2]


def test_what_is_certified_is_the_plan_with_hulls_larger_by_the_deviation(plan: Plan) -> None:
    thinned = radmpc.thin(plan, 0.2, rounding=0.01)
    scenario = plan.scenario
    vehicles = [replace(v, radius=v.radius + thinned.deviations[v.name]) for v in scenario.vehicles]
    most = max(thinned.deviations.values())
    smaller = radmpc.Workspace(np.array([-5, -8]) + most, np.array([25, 8]) - most)
    grown = replace(scenario, vehicles=tuple(vehicles), workspace=smaller)
    judged = radmpc.certify(replace(plan, scenario=grown, risk=replace(plan.risk, certified=None)))
    assert thinned.certificate.certified == judged.certified
    assert judged.certified > radmpc.certify(plan).certified
    assert judged.certified <= scenario.risk_bound


def test_a_tolerance_that_would_exceed_the_bound_is_reduced(plan: Plan) -> None:
    wide, narrow = radmpc.thin(plan, 8.0), radmpc.thin(plan, 0.05)
    assert wide.certificate.holds
    assert wide.tolerance < 8.0
    assert narrow.tolerance == 0.05


def test_a_plan_made_for_less_leaves_room_for_deviations(plan: Plan) -> None:
    usual, roomy = radmpc.thin(plan, 2.0), radmpc.thin(plan, 2.0, risk_bound=0.49)
    assert roomy.certificate.bound == 0.49
    assert roomy.certificate.certified <= 0.49
    assert usual.tolerance <= roomy.tolerance


def test_steps_of_visits_and_both_ends_stay(plan: Plan) -> None:
    means = plan.trajectories[0].means
    (visit,) = steps_visited(plan.scenario.vehicles[0].via, means[:, :2], means[:, 2:])
    for tolerance in (0.1, 5.0):
        kept = radmpc.thin(plan, tolerance).steps["a"]
        assert {0, visit, plan.scenario.horizon} <= set(kept)


def test_flown_along_its_legs_it_collides_no_more_than_is_certified(plan: Plan) -> None:
    thinned = radmpc.thin(plan, 0.5)
    rng, horizon = np.random.default_rng(0), plan.scenario.horizon
    times, flights = np.linspace(0.0, horizon, 57), 4000
    k = np.minimum(times.astype(int), horizon - 1)
    s = times - k
    tracks = []
    for i, vehicle in enumerate(plan.scenario.vehicles):
        assert vehicle.gain is not None
        loop = SYSTEM.A + SYSTEM.B @ vehicle.gain
        off = [rng.multivariate_normal(np.zeros(4), vehicle.initial_covariance, flights)]
        for _ in range(horizon):
            noise = rng.multivariate_normal(np.zeros(4), vehicle.disturbance_covariance, flights)
            off.append(off[-1] @ loop.T + noise)
        now = np.array(off)[k]
        pushes = 0.5 * s[:, None, None] ** 2 * (now @ vehicle.gain.T)
        drift = now[..., :2] + s[:, None, None] * now[..., 2:] + pushes
        tracks.append(legs(plan, i, thinned.steps[vehicle.name], times)[:, None] + drift)
    hit = (np.linalg.norm(tracks[0] - tracks[1], axis=2) < 0.8).any(axis=0)
    for track in tracks:
        nearest = np.clip(track, [8, 0.5], [11, 1.5])
        hit |= (np.linalg.norm(track - nearest, axis=2) < 0.4).any(axis=0)
        hit |= ((track < [-5, -8]) | (track > [25, 8])).any(axis=(0, 2))
    assert hit.mean() <= thinned.certificate.certified


def test_a_plan_that_does_not_hold_keeps_all_its_steps(plan: Plan) -> None:
    bad = replace(plan, scenario=replace(plan.scenario, risk_bound=1e-12))
    thinned = radmpc.thin(bad, 0.5)
    assert not thinned.certificate.holds
    assert all(len(steps) == 15 for steps in thinned.steps.values())
    assert "NOT certified" in thinned.note


def test_legs_of_a_plan_that_does_not_hold_are_as_near_as_is_said(plan: Plan) -> None:
    half = 0.5 * radmpc.certify(plan).certified
    thinned = radmpc.thin(plan, 0.2, risk_bound=half)
    assert not thinned.certificate.holds
    times = np.linspace(0.0, plan.scenario.horizon, 20 * plan.scenario.horizon + 1)
    for i, vehicle in enumerate(plan.scenario.vehicles):
        kept = thinned.steps[vehicle.name]
        away = np.linalg.norm(legs(plan, i, kept, times) - path(plan, i, times), axis=1)
        assert away.max() <= thinned.deviations[vehicle.name] + 1e-9
    assert max(thinned.deviations.values()) > 1e-3


def test_what_cannot_be_thinned_is_refused(plan: Plan) -> None:
    for tolerance in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(ArgumentError, match="tolerance must be a number > 0 m"):
            radmpc.thin(plan, tolerance)
    for wrong in ({"tolerance": "0.1"}, {"tolerance": 0.1, "rounding": None}):
        with pytest.raises(ArgumentTypeError, match="must be a number"):
            radmpc.thin(plan, **wrong)
    with pytest.raises(ScenarioError, match="risk_bound"):
        radmpc.thin(plan, 0.1, risk_bound=0.7)
    with pytest.raises(ArgumentError, match="rounding must be"):
        radmpc.thin(plan, 0.1, rounding=-1.0)
    with pytest.raises(NoPlanError, match="nothing to thin"):
        radmpc.thin(replace(plan, trajectories=()), 0.1)
