"""Half-spaces of any direction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from radmpc.experiments.families import circle, clutter
from radmpc.model.dynamics import double_integrator, rollout
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.program.build import build_program, condensed_models
from radmpc.program.turned import Turned

HORIZON = 4


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


def scene(dimension: int, avoidance: str, rng: np.random.Generator) -> tuple[Scenario, Turned]:
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
    models = condensed_models(scenario)
    controls = [rng.uniform(-1.0, 1.0, (HORIZON, dimension)) for _ in range(2)]
    means = np.array(
        [
            rollout(v.system, v.start, u)[:, :dimension]
            for v, u in zip(scenario.vehicles, controls, strict=True)
        ]
    )
    return scenario, Turned(models, means, controls, avoidance == "intervals")


def random_normals(count: int, dimension: int, rng: np.random.Generator) -> np.ndarray:
    normals = rng.normal(size=(count, dimension))
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_no_random_direction_separates_two_vehicles_better(dimension: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    _, turned = scene(dimension, "steps", rng)
    normals = -turned.between(0, 1).normals[:, 0]
    covariances = sum(s.position_covariances for s in turned.models)
    for k in range(HORIZON):
        relative = turned.means[0, k + 1] - turned.means[1, k + 1]
        tried = np.vstack([normals[k], random_normals(20_000, dimension, rng)])
        deviations = np.sqrt(np.einsum("ca,ab,cb->c", tried, covariances[k + 1], tried))
        clearances = (tried @ relative - 1.0) / deviations
        assert clearances[0] >= clearances.max() - 1e-2 * abs(clearances.max())


@pytest.mark.parametrize("dimension", [2, 3])
def test_half_spaces_hold_what_they_are_turned_around(dimension: int) -> None:
    rng = np.random.default_rng(7)
    scenario, turned = scene(dimension, "intervals", rng)
    program = build_program(scenario, turned.models, risk_bound=scenario.risk_bound, turned=turned)
    z = np.concatenate(
        [half.ravel() for u in turned.controls for half in (np.maximum(u, 0), np.maximum(-u, 0))]
    )
    slacks = program.slacks(z)
    tau = np.linspace(0.0, 1.0, 40)[:, None]
    vertices = scenario.obstacles[0].at(0)[0].vertices
    checked = 0
    for avoidance, label in enumerate(program.avoidances):
        if label.cause == "workspace":
            continue
        k, i = label.step, 0 if label.vehicle == "a" else 1
        curves = [
            means[k] * (1 - tau) + means[k + 1] * tau - 0.5 * tau * (1 - tau) * u[k]
            for means, u in zip(turned.means, turned.controls, strict=True)
        ]
        for alternative in program.alternatives_of(avoidance):
            rows = program.rows_of(alternative)
            places = program.rows.normals[rows[:1]].toarray()[0, : program.num_positions]
            normal = -places.reshape(2, -1, dimension)[i].sum(axis=0)
            assert np.linalg.norm(normal) == pytest.approx(1.0)
            if label.cause == "pair":
                gap = (curves[0] - curves[1]) @ normal - 1.0
            else:
                gap = curves[i] @ normal - (vertices @ normal).max() - 0.5
            assert slacks[rows].min() <= gap.min() + 1e-9
            checked += 1
    assert checked >= 6


def test_a_turned_program_has_at_most_one_side_for_every_danger() -> None:
    scenario = replace(clutter(2, 10, 0), avoidance="intervals")
    models = condensed_models(scenario)
    controls = [np.zeros((scenario.horizon, 2)) for _ in models]
    means = np.array([s.drift_position for s in models])
    turned = Turned(models, means, controls, intervals=True)
    program = build_program(scenario, models, risk_bound=0.05, turned=turned)
    sides = np.diff(program.avoidance_starts)
    within = np.array([e.step for e in program.avoidances])
    # Starts and goals may share the reserve for the sagitta in several ways; a path through the
    # middle of a box has no side.
    inside = sides[(within > 0) & (within < scenario.horizon - 1)]
    assert inside.max() == 1
    assert inside.mean() > 0.5


@pytest.mark.parametrize("seed", range(5))
def test_no_other_share_of_the_reserve_keeps_both_ends_clearer(seed: int) -> None:
    rng = np.random.default_rng(seed)
    _, turned = scene(2, "intervals", rng)
    windows = turned.between(0, 1)
    covariances = sum(s.position_covariances for s in turned.models)
    for k in range(HORIZON):
        normal = -windows.normals[k, 0]
        at = [normal @ (turned.means[0, j] - turned.means[1, j]) - 1.0 for j in (k, k + 1)]
        deviations = [np.sqrt(normal @ covariances[j] @ normal) for j in (k, k + 1)]
        # A double integrator's path leaves its chord by at most u/8 over one second.
        sagitta = max(normal @ (turned.controls[0][k] - turned.controls[1][k]), 0.0) / 8.0
        shares = np.append(windows.shares[k, 0], np.linspace(0.0, 1.0, 1001))
        near = (at[0] - 4.0 * sagitta * shares**2) / deviations[0]
        far = (at[1] - 4.0 * sagitta * (1.0 - shares) ** 2) / deviations[1]
        least = np.minimum(near, far)
        assert least[0] >= least[1:].max() - 1e-9


def test_a_diagonal_pair_is_safer_by_a_turned_half_space_than_by_faces() -> None:
    scenario = circle(2)
    models = condensed_models(scenario)
    apart = np.array([1.0, 1.0]) * 1.2
    means = np.array(
        [np.tile(apart, (scenario.horizon + 1, 1)), np.zeros((scenario.horizon + 1, 2))]
    )
    controls = [np.zeros((scenario.horizon, 2)) for _ in models]
    normals = -Turned(models, means, controls, intervals=False).between(0, 1).normals[:, 0]
    assert normals == pytest.approx(np.tile(np.sqrt(0.5), normals.shape), abs=2e-3)
    radii = sum(v.radius for v in scenario.vehicles)
    deviation = np.sqrt(sum(s.position_covariances[1][0, 0] for s in models))
    assert norm.sf((normals[0] @ apart - radii) / deviation) < norm.sf((1.2 - radii) / deviation)
