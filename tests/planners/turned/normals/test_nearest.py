"""Paths between corners turn about them, where half-spaces that both ends keep hold them."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.normals.encounter import Encounter
from radmpc.planners.certified.turned.normals.nearest import nearest_shares
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits


def _past(corners: np.ndarray, start: np.ndarray, end: np.ndarray) -> Encounter:
    """A straight way past a convex body, in noise that is the same all along."""
    count, dimension = start.shape
    covariances = np.broadcast_to(0.01 * np.eye(dimension), (count, dimension, dimension))

    def supports(directions):
        reach = (directions @ corners.T).max(axis=2) + 0.5
        return reach, reach

    ends = (start, end)
    return Encounter(ends, ((covariances,), (covariances,)), np.zeros_like(start), supports)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_way_past_a_point_is_nearest_where_geometry_says(dimension):
    rng = np.random.default_rng(dimension)
    start, end = rng.normal(0.0, 2.0, (2, 200, dimension))
    chord = end - start
    share = -(start * chord).sum(axis=1) / (chord**2).sum(axis=1)
    nearest = start + np.clip(share, 0.0, 1.0)[:, None] * chord
    normals = nearest / np.linalg.norm(nearest, axis=1, keepdims=True)
    found = nearest_shares(_past(np.zeros((1, dimension)), start, end), normals)
    is_past = (share > 2e-3) & (share < 1.0 - 2e-3)
    assert is_past.sum() > 50
    assert found[is_past] == pytest.approx(share[is_past], abs=1e-3)
    is_before = (share < 0.0) | (share > 1.0)
    assert is_before.sum() > 20
    assert np.isnan(found[is_before]).all()


def test_past_a_corner_it_is_where_the_corner_is_and_past_a_face_both_ends_are_kept():
    box = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    start = np.array([[-1.0, 2.0], [-1.0, 3.0], [3.0, 3.0]])
    end = np.array([[2.0, 5.0], [3.0, 3.0], [4.0, 3.0]])
    normals = np.array([[-np.sqrt(0.5), np.sqrt(0.5)], [0.0, 1.0], [np.sqrt(0.5), np.sqrt(0.5)]])
    found = nearest_shares(_past(box, start, end), normals)
    # Of the first way, (-1, 2) to (2, 5), the corner (0, 2) is beside (-0.5, 2.5).
    assert found[0] == pytest.approx(1.0 / 6.0, abs=1e-3)
    assert np.isnan(found[1:]).all()


def _lane() -> tuple[Hazards, SuccessiveLp]:
    """A vehicle cuts through a bend of a lane as wide as two of it, between two corners."""
    covariance = np.diag([1.1e-3, 1.1e-3, 5e-5, 5e-5])
    vehicle = Vehicle(
        name="a",
        system=double_integrator(1.5, 2),
        start=[12.47, 8.4, 0.0, 0.9],
        goal=Goal([14.0, 12.0], [18.0, 17.0], None),
        radius=0.25,
        control_limit=2.0,
        initial_covariance=2.0 * covariance,
        disturbance_covariance=covariance,
    )
    cells = (
        Obstacle.box("left", [12.0, 12.0], [13.0, 13.0]),
        Obstacle.box("ahead", [13.0, 13.0], [14.0, 14.0]),
        Obstacle.box("right", [14.0, 10.0], [15.0, 12.0]),
    )
    scenario = Scenario(
        name="lane",
        dt=1.5,
        horizon=7,
        risk_bound=0.05,
        vehicles=(vehicle,),
        obstacles=cells,
        avoidance="intervals",
    )
    hazards = Hazards.of(scenario, condensed_models(scenario))
    successive = SuccessiveLp(hazards, Limits())
    cut = [[12.47, 8.4], [12.52, 9.8], [12.95, 11.2], [13.76, 12.27]]
    cut += [[14.56, 13.01], [15.37, 13.86], [16.27, 14.81], [17.28, 15.77]]
    successive.refer(0, np.array(cut))
    return hazards, successive


def _least_risk(asks_nearest: bool) -> float:
    """What half-spaces turned to the path risk once it moves no more, at a price far above all."""
    hazards, successive = _lane()
    least = np.inf
    for _ in range(12):
        successive.asks_nearest = asks_nearest
        successive.share_risk((0,), 1e4, 0.25)
        near = Near(8.0, 1.0, is_refined=True)
        spaces = half_spaces(hazards, successive.paths, (0,), near)
        least = min(least, float(hazards.tail.probability(spaces.clearances).sum()))
    return least


def test_a_path_between_two_corners_turns_about_them():
    held, turned = _least_risk(asks_nearest=False), _least_risk(asks_nearest=True)
    assert turned < 0.1 * held
