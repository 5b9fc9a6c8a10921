"""What the relaxation knows of hazards in space."""

from __future__ import annotations

import numpy as np
import pytest
from cones_drawn import Array, chains, clearances_of, directions

from radmpc.geometry import Polytope, box, hull
from radmpc.model.dynamics import double_integrator
from radmpc.model.goal import Goal
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planning import plan
from radmpc.program.relaxed.cones import cones_around
from radmpc.program.relaxed.cones_in_space import cones_in_space
from radmpc.program.relaxed.level_curves import Outline
from radmpc.program.relaxed.patches import around_point
from radmpc.program.relaxed.polytope_patches import around_polytope
from radmpc.program.relaxed.tails import HalfSpaceTails


def best_in_space(mean: Array, covariance: Array, corners: Array, radius: float) -> float:
    """Clearance of the best half-space, by a fine sample of directions and a local search."""
    rng = np.random.default_rng(0)
    tried = rng.normal(size=(4000, 3))
    best = -np.inf
    for spread in (1.0, 0.2, 0.05, 0.01):
        tried /= np.linalg.norm(tried, axis=1)[:, None]
        slack = tried @ mean - (tried @ corners.T).max(axis=1) - radius
        found = slack / np.sqrt(np.einsum("ka,ab,kb->k", tried, covariance, tried))
        best = max(best, float(found.max()))
        tried = tried[found.argmax()] + spread * 0.3 * rng.normal(size=(2000, 3))
    return best


@pytest.mark.sampled(10)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("shape", ["pair", "box", "body", "plate", "wedge"])
def test_in_space_no_mean_is_clearer_than_its_best_cone_says(shape: str, seed: int) -> None:
    rng = np.random.default_rng([seed, len(shape)])
    root = 0.2 * np.eye(3) + 0.05 * rng.normal(size=(3, 3))
    covariance, radius = root @ root.T, 0.6
    if shape == "pair":
        corners, patches = np.zeros((1, 3)), around_point(2)
    else:
        made = box([-1.0, -2.0, 0.0], [1.5, 0.5, 1.0])
        if shape == "body":
            made = hull(rng.normal(size=(9, 3)))
        elif shape == "plate":
            turned = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            made = hull(np.column_stack([rng.normal(size=(6, 2)), np.zeros(6)]) @ turned)
        elif shape == "wedge":
            made = hull(rng.normal(size=(4, 3)) * [2.0, 1.0, 0.2])
        corners, whole = made.vertices, around_polytope(made)
        assert whole is not None
        patches = whole
    cones = cones_in_space(patches, radius, covariance[None], HalfSpaceTails.of(0.1))
    assert not cones.is_void[0]
    for _ in range(25):
        away = rng.normal(size=3)
        mean = corners.mean(axis=0) + away * rng.uniform(1.0, 4.0) / np.linalg.norm(away)
        truth = best_in_space(mean, covariance, corners, radius)
        if truth < 0.0:
            continue
        clearances = clearances_of(cones, mean)
        enough = clearances >= truth - 1e-6
        assert any(all(enough[chain]) for chain in chains(cones))


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "body",
    [
        box([0.0, 0.0, 0.0], [1.0, 2.0, 0.5]),
        box([0.0, 0.0, 0.0], [1.0, 1.0, 0.0]),
        hull(np.random.default_rng(3).normal(size=(12, 3))),
        hull(np.array([[0.0, 0.0, 0.0], [3.0, 0.1, 0.0], [0.0, 0.2, 0.1], [0.1, 0.0, 0.3]])),
    ],
    ids=["box", "plate", "body", "needle"],
)
def test_every_direction_is_in_a_narrow_patch_that_is_supported_where_the_body_is(
    body: Polytope,
) -> None:
    found = around_polytope(body)
    assert found is not None
    is_narrow = ~np.isin(np.arange(len(found.parents)), found.parents)
    corners = found.directions[found.corners]
    rng = np.random.default_rng(0)
    for direction in rng.normal(size=(300, 3)):
        at = direction / np.linalg.norm(direction)
        # Within a spherical triangle whose corners it is a positive sum of.
        weights = np.array(
            [np.linalg.lstsq(patch[:3].T, at, rcond=None)[0] for patch in corners[is_narrow]]
        )
        sums = np.einsum("pc,pca->pa", weights, corners[is_narrow][:, :3])
        is_in = (weights >= -1e-9).all(axis=1) & (np.abs(sums - at).max(axis=1) < 1e-9)
        supported = found.supports[is_narrow][is_in] @ at
        assert is_in.any()
        assert np.allclose(supported, (body.vertices @ at).max(), atol=1e-9)


def test_a_wide_patch_per_face_is_made_of_narrow_ones_that_the_face_supports() -> None:
    body = hull(np.random.default_rng(1).normal(size=(10, 3)))
    found = around_polytope(body)
    assert found is not None
    assert found.axes is not None
    wide = np.flatnonzero(found.parents < 0)
    normals = found.directions[found.axes[wide]]
    assert np.allclose(np.sort(normals, axis=0), np.sort(body.normals, axis=0))
    outer = np.arange(len(found.parents))
    while (found.parents[outer] >= 0).any():
        outer = np.where(found.parents[outer] >= 0, found.parents[outer], outer)
    for patch, face in enumerate(outer):
        normal = found.directions[found.axes[face]]
        assert normal @ found.supports[patch] == pytest.approx((body.vertices @ normal).max())
        cosines = [(found.directions[found.corners[k]] @ normal).min() for k in (patch, face)]
        assert cosines[0] >= cosines[1] - 1e-12


def test_cones_move_with_the_body() -> None:
    noise, tails, move = np.eye(3)[None] * 0.02, HalfSpaceTails.of(0.05), np.array([0.3, -1.0, 2.0])
    here, there = box([0.0, 0.0, 0.0], [1.0, 2.0, 3.0]), box(move, move + np.array([1.0, 2.0, 3.0]))
    patches, others = around_polytope(here), around_polytope(there)
    assert patches is not None
    assert others is not None
    moved = cones_in_space(patches, 0.4, noise, tails, move[None])
    expected = cones_in_space(others, 0.4, noise, tails)
    assert np.allclose(moved.offsets, expected.offsets)
    assert np.array_equal(moved.normals, expected.normals)


def test_what_has_no_face_in_space_is_left_out() -> None:
    assert around_polytope(box([0.0, 0.0, 0.0], [1.0, 0.0, 0.0])) is None
    assert around_polytope(box([0.0, 0.0, 0.0], [0.0, 0.0, 0.0])) is None


def crossing(*obstacles: Obstacle) -> Scenario:
    """Return a vehicle in space on its way through obstacles."""
    vehicle = Vehicle(
        name="v",
        system=double_integrator(1.0, 3),
        start=[0.0, 0.0, 0.0],
        goal=Goal.at([6.0, 0.0, 0.0], half_width=0.3),
        radius=0.3,
        control_limit=2.0,
        initial_covariance=0.0,
        disturbance_covariance=0.001,
    )
    return Scenario(
        name="s",
        dt=1.0,
        horizon=8,
        risk_bound=0.05,
        avoidance="steps",
        vehicles=[vehicle],
        obstacles=obstacles,
    )


CORNERS = np.array([[x, y, z] for x in (2.0, 3.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


@pytest.mark.parametrize(
    "obstacle",
    [
        Obstacle.box("stands", [2.0, -1.0, -1.0], [3.0, 1.0, 1.0]),
        Obstacle.box("plate", [2.5, -1.0, -1.0], [2.5, 1.0, 1.0]),
        Obstacle.tracked("moves", CORNERS, [0.0, 0.3, 0.0, 0.0, -0.1, 0.0], [0.0] * 6),
        Obstacle.tracked(
            "spreads", CORNERS, [0.0, 0.3, 0.0, 0.0, -0.1, 0.0], [0.01] * 3 + [1e-4] * 3
        ),
    ],
    ids=lambda obstacle: obstacle.name,
)
def test_plans_past_a_body_in_space_are_proven_to_a_percent_of_any_other(
    obstacle: Obstacle,
) -> None:
    result, alone = plan(crossing(obstacle), "certified"), plan(crossing(), "certified")
    assert result.cost is not None
    assert result.certified_lower_bound is not None
    assert alone.cost is not None
    assert result.cost > 1.2 * alone.cost
    assert 0.99 * result.cost <= result.certified_lower_bound <= result.cost


@pytest.mark.parametrize("turn", np.linspace(0.0, np.pi, 9))
def test_nothing_is_asked_where_all_the_noise_is_along_one_line(turn: float) -> None:
    along = np.array([np.cos(turn), np.sin(turn)])
    line = 0.04 * np.outer(along, along)
    tails = HalfSpaceTails.of(0.05)
    point = Outline(np.zeros((1, 1, 2)), np.zeros((1, 0, 2)), 0.5)
    both = np.stack([line, line + 0.01 * np.eye(2)])
    cones = cones_around(point, both, tails, np.repeat(directions(16), 2, axis=0))
    assert cones.is_void.tolist() == [True, False]
