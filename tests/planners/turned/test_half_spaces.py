"""Half-spaces turned to paths, and what vehicles do between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from radmpc.experiments.families import circle
from radmpc.model.dynamics import double_integrator, rollout
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear.group_lp import GroupLp
from radmpc.planners.certified.turned.linear.margins import fixed_margins, priced_margins
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.normals import encounter
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.paths import Paths
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards

HORIZON = 4
EVERYTHING = Near(3.0, 1e3, is_refined=True)


def vehicle(name: str, start: list[float], **more: object) -> Vehicle:
    dimension = len(start)
    position = [0.04, 0.0025, 0.01][:dimension]
    covariance = np.diag([*position, *(0.01 for _ in position)])
    return Vehicle(
        name=name,
        system=double_integrator(1.0, dimension),
        start=[*start, *np.zeros(dimension)],
        goal=Goal(np.full(dimension, -50.0), np.full(dimension, 50.0), None),
        radius=0.5,
        control_limit=2.0,
        initial_covariance=covariance,
        disturbance_covariance=0.1 * covariance,
        **more,
    )


def scene(
    dimension: int, avoidance: str, rng: np.random.Generator
) -> tuple[Scenario, Hazards, Paths]:
    """Two vehicles and a box, and random paths past each other."""
    corner = np.array([2.0, -1.0, 0.5][:dimension])
    scenario = Scenario(
        name="s",
        dt=1.0,
        horizon=HORIZON,
        risk_bound=0.1,
        vehicles=(
            vehicle("a", [-3.0, 2.0, 1.0][:dimension]),
            vehicle("b", [3.0, 3.0, -1.0][:dimension]),
        ),
        obstacles=(Obstacle.box("box", corner, corner + 1.0),),
        avoidance=avoidance,
    )
    hazards = Hazards.of(scenario, condensed_models(scenario))
    paths = Paths(hazards)
    for i, each in enumerate(scenario.vehicles):
        controls = rng.uniform(-1.0, 1.0, (HORIZON, dimension))
        paths.fly(i, controls)
        assert paths.means[i] == pytest.approx(
            rollout(each.system, each.start, controls)[:, :dimension]
        )
    return scenario, hazards, paths


def between(spaces: HalfSpaces) -> dict[int, int]:
    """Which half-space lies between the vehicles, by window."""
    return {int(spaces.windows[w]): w for w in np.flatnonzero(spaces.second >= 0)}


def random_normals(count: int, dimension: int, rng: np.random.Generator) -> np.ndarray:
    normals = rng.normal(size=(count, dimension))
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_no_random_direction_separates_two_vehicles_better(dimension: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    _, hazards, paths = scene(dimension, "steps", rng)
    spaces = half_spaces(hazards, paths, (0, 1), EVERYTHING)
    covariances = hazards.covariances.sum(axis=0)
    assert len(between(spaces)) == HORIZON
    for k, w in between(spaces).items():
        relative = paths.means[0, k + 1] - paths.means[1, k + 1]
        tried = np.vstack([spaces.normals[w], random_normals(20_000, dimension, rng)])
        deviations = np.sqrt(np.einsum("ca,ab,cb->c", tried, covariances[k + 1], tried))
        clearances = (tried @ relative - 1.0) / deviations
        assert clearances[0] == pytest.approx(spaces.clearances[w, 1])
        assert clearances[0] >= clearances.max() - 1e-2 * abs(clearances.max())


@pytest.mark.parametrize("dimension", [2, 3])
def test_half_spaces_hold_what_they_are_turned_around(dimension: int) -> None:
    rng = np.random.default_rng(7)
    scenario, hazards, paths = scene(dimension, "intervals", rng)
    spaces = half_spaces(hazards, paths, (0, 1), EVERYTHING)
    tau = np.linspace(0.0, 1.0, 40)[:, None]
    vertices = scenario.obstacles[0].at(0)[0].vertices
    for w, k in enumerate(spaces.windows.tolist()):
        curves = [
            means[k] * (1 - tau) + means[k + 1] * tau - 0.5 * tau * (1 - tau) * u[k]
            for means, u in zip(paths.means, paths.controls, strict=True)
        ]
        i, j, normal = spaces.first[w], spaces.second[w], spaces.normals[w]
        assert np.linalg.norm(normal) == pytest.approx(1.0)
        if j >= 0:
            gap = (curves[i] - curves[j]) @ normal - 1.0
        else:
            gap = curves[i] @ normal - (vertices @ normal).max() - 0.5
        assert (spaces.heights[w] - spaces.offsets[w]).min() <= gap.min() + 1e-9
    assert spaces.count == 3 * HORIZON


@pytest.mark.parametrize("seed", range(5))
def test_no_other_share_of_the_reserve_keeps_both_ends_clearer(seed: int) -> None:
    rng = np.random.default_rng(seed)
    _, hazards, paths = scene(2, "intervals", rng)
    spaces = half_spaces(hazards, paths, (0, 1), EVERYTHING)
    covariances = hazards.covariances.sum(axis=0)
    assert len(between(spaces)) == HORIZON
    for k, w in between(spaces).items():
        normal = spaces.normals[w]
        at = [normal @ (paths.means[0, j] - paths.means[1, j]) - 1.0 for j in (k, k + 1)]
        deviations = [np.sqrt(normal @ covariances[j] @ normal) for j in (k, k + 1)]
        # A double integrator's path leaves its chord by at most u/8 over one second.
        sagitta = max(normal @ (paths.controls[0][k] - paths.controls[1][k]), 0.0) / 8.0
        shares = np.append(spaces.shares[w], np.linspace(0.0, 1.0, 1001))
        near = (at[0] - 4.0 * sagitta * shares**2) / deviations[0]
        far = (at[1] - 4.0 * sagitta * (1.0 - shares) ** 2) / deviations[1]
        least = np.minimum(near, far)
        assert least[0] >= least[1:].max() - 1e-9


def test_a_diagonal_pair_is_safer_by_a_turned_half_space_than_by_faces() -> None:
    scenario = circle(2)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    paths = Paths(hazards)
    apart = np.array([1.0, 1.0]) * 1.2
    paths.refer(0, np.tile(apart, (scenario.horizon + 1, 1)))
    paths.refer(1, np.zeros((scenario.horizon + 1, 2)))
    spaces = half_spaces(hazards, paths, (0, 1), EVERYTHING)
    normals = spaces.normals[spaces.second >= 0]
    assert normals == pytest.approx(np.tile(np.sqrt(0.5), normals.shape), abs=2e-3)
    radii = sum(v.radius for v in scenario.vehicles)
    deviation = np.sqrt(hazards.covariances[:, 1, 0, 0].sum())
    assert norm.sf((normals[0] @ apart - radii) / deviation) < norm.sf((1.2 - radii) / deviation)


def test_paths_through_each_other_get_opposite_sides_from_either_vehicle() -> None:
    scenario = circle(2)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    paths = Paths(hazards)
    line = np.linspace(-1.0, 1.0, scenario.horizon + 1)[:, None] * np.array([1.0, 0.0])
    paths.refer(0, line)
    paths.refer(1, -line)
    near = Near(0.0, 0.0, is_refined=False)
    one = half_spaces(hazards, paths, (0,), near)
    two = half_spaces(hazards, paths, (1,), near)
    middle = scenario.horizon // 2 - 1
    mine = one.normals[(one.windows == middle) & (one.second == 1)]
    other = two.normals[(two.windows == middle) & (two.second == 0)]
    assert abs(mine @ np.array([0.0, 1.0])) == pytest.approx(1.0)
    assert mine == pytest.approx(-other)


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_one_vehicle_alone_and_a_group_keep_what_half_spaces_ask_for(avoidance: str) -> None:
    _, hazards, paths = scene(2, avoidance, np.random.default_rng(3))
    for group in ((0,), (0, 1)):
        spaces = half_spaces(hazards, paths, group, Near(2.0, 1e3, is_refined=True))
        margins = fixed_margins(spaces.deviations, 2.0, 1e3)
        plan = GroupLp(hazards, group).solve(spaces, paths, margins)
        assert plan is not None
        assert plan.shortfall == pytest.approx(0.0, abs=1e-7)
        moved = Paths(hazards)
        for i in range(2):
            moved.fly(i, paths.controls[i])
        for i, controls in zip(group, plan.controls, strict=True):
            moved.fly(i, controls)
        again = half_spaces(hazards, moved, group, Near(2.0, 1e3, is_refined=True))
        # Turned anew they leave no less room than where they stood.
        assert again.clearances[:, 1].min() >= 2.0 - 1e-6


def test_what_a_price_of_risk_gives_up_is_no_less_than_the_risk() -> None:
    scenario = replace(circle(2), avoidance="intervals")
    hazards = Hazards.of(scenario, condensed_models(scenario))
    group, price, paths = (0, 1), 20.0, Paths(hazards)
    for i in group:
        alone = GroupLp(hazards, (i,)).alone()
        assert alone is not None
        paths.fly(i, alone[0])
    spaces = half_spaces(hazards, paths, group, EVERYTHING)
    margins = priced_margins(spaces.deviations, spaces.clearances, (price, 1e4), 0.05)
    lp = GroupLp(hazards, group)
    plan = lp.solve(spaces, paths, margins)
    assert plan is not None
    cost = sum(float(np.abs(u).sum()) for u in plan.controls)
    for i, controls in zip(group, plan.controls, strict=True):
        paths.fly(i, controls)
    risk = 0.0
    for w, k in enumerate(spaces.windows.tolist()):
        i, j, normal = spaces.first[w], spaces.second[w], spaces.normals[w]
        for end in (0, 1):
            if k + end == 0:
                continue
            at = paths.means[i, k + end] - (paths.means[j, k + end] if j >= 0 else 0.0)
            room = normal @ at - spaces.offsets[w, end]
            risk += norm.sf(room / spaces.deviations[w, end])
    assert risk <= plan.risk + 1e-9
    dearer = lp.solve(
        spaces, paths, priced_margins(spaces.deviations, spaces.clearances, (1e3, 1e4), 0.05)
    )
    assert dearer is not None
    assert dearer.risk < plan.risk
    assert sum(float(np.abs(u).sum()) for u in dearer.controls) > cost


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("price", [1e305, float("inf")])
def test_a_price_of_risk_beyond_all_numbers_leaves_costs_that_are_numbers(price) -> None:
    deviations, latest = np.full((1, 2), 1e-6), np.array([[9.0, 3.0]])
    margins = priced_margins(deviations, latest, (price, 1e4), 0.05)
    assert np.isfinite(margins.penalty)
    assert np.all(np.isfinite(margins.prices))
    # What runs more risk per meter still costs more.
    assert np.all(np.diff(margins.prices[0, 0, :15]) >= 0.0)
    assert margins.prices.max() > 1e90


def test_past_an_edge_in_space_no_random_direction_leaves_a_path_more_room() -> None:
    rng = np.random.default_rng(0)
    scenario, _, _ = scene(3, "steps", rng)
    pole = Obstacle.box("pole", np.array([0.0, 0.0, -0.77]), np.array([0.0, 0.0, 0.39]))
    quiet = replace(
        scenario.vehicles[0],
        initial_covariance=np.eye(6) * 1e-8,
        disturbance_covariance=np.eye(6) * 1e-9,
    )
    beside = replace(scenario, obstacles=(pole,), vehicles=(quiet,))
    hazards = Hazards.of(beside, condensed_models(beside))
    paths = Paths(hazards)
    place = np.array([0.356, -0.404, 0.232])
    paths.refer(0, np.tile(place, (HORIZON + 1, 1)))
    corners = pole.at(0)[0].vertices
    tried = random_normals(20_000, 3, rng)
    most = float((tried @ place - (tried @ corners.T).max(axis=1)).max()) - 0.5
    for is_refined in (True, False):
        spaces = half_spaces(hazards, paths, (0,), Near(3.0, 1e3, is_refined=is_refined))
        room = (spaces.heights - spaces.offsets)[:, 1]
        # By a face, or from an end of the pole, the hull would seem to touch it.
        assert most > 0.03
        assert (room > 0.0).all()
        if is_refined:
            assert room == pytest.approx(most, abs=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_supports_and_variances_are_those_of_one_product_of_all(dimension: int) -> None:
    rng = np.random.default_rng(dimension)
    directions = rng.normal(size=(30, 7, dimension))
    corners = rng.normal(size=(30, 5, dimension))
    roots = rng.normal(size=(30, dimension, dimension))
    covariances = roots @ roots.transpose(0, 2, 1)
    along = np.einsum("wcd,wvd->wcv", directions, corners)
    variances = np.einsum("wca,wab,wcb->wc", directions, covariances, directions)

    np.testing.assert_allclose(encounter.furthest(directions, corners), along.max(axis=2))
    np.testing.assert_allclose(encounter._variances(directions, covariances), variances)
