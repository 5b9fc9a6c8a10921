"""The relaxation underestimates what any certified plan risks, wherever its vehicles are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from cones_drawn import (
    Array,
    chains,
    clearances_of,
    directions,
    normals_of,
    probability_within,
)
from scipy.stats import ncx2, norm

from radmpc import certify
from radmpc.experiments.families import circle, paper
from radmpc.model.dynamics import double_integrator, lqr_gain, rollout
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planning import plan
from radmpc.program.build import condensed_models
from radmpc.program.builder import ProgramBuilder
from radmpc.program.relaxed.arcs import face_arcs
from radmpc.program.relaxed.build import build_relaxation
from radmpc.program.relaxed.cones import cones_around
from radmpc.program.relaxed.instants import Instants
from radmpc.program.relaxed.level_curves import Outline
from radmpc.program.relaxed.tails import DiscTails, disc_probability, tails_of
from radmpc.solvers.priced.rating import Rater


@pytest.mark.parametrize("radius", [0.1, 0.4, 1.0, 3.0, 30.0])
def test_what_a_disc_collects_is_that_of_the_noncentral_chi_square(radius: float) -> None:
    distances = np.linspace(-0.5 * radius, 6.0, 15)
    found = disc_probability(np.full(15, radius))(distances)
    expected = ncx2.cdf(radius**2, 2, (distances + radius) ** 2)
    assert np.allclose(found, expected, rtol=1e-9, atol=1e-14)


@pytest.mark.parametrize("risk_bound", [1e-4, 0.02, 0.2])
def test_shifted_tails_are_never_above_those_of_discs(risk_bound: float) -> None:
    tails = DiscTails.of(risk_bound)
    for radius in np.geomspace(0.3, 200.0, 12):
        least, shift = (float(v) for v in tails.at(np.array(radius)))
        if np.isnan(least):
            assert ncx2.cdf(0.9 * radius**2, 2, radius**2) <= risk_bound
            continue
        distances = np.linspace(least, 6.5, 40)
        truth = ncx2.cdf(radius**2, 2, (distances + radius) ** 2)
        assert np.all(norm.sf(distances + shift) <= truth * (1.0 + 1e-7))
        assert ncx2.cdf(radius**2, 2, (least - 0.05 + radius) ** 2) > risk_bound


@pytest.mark.slow
@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("count", [5, 8, 16])
@pytest.mark.parametrize("noise", [1.0, 8.0])
def test_no_mean_outside_risks_less_than_its_best_cone(seed: int, count: int, noise: float) -> None:
    """Nor one that is inside by a little: every point with a probability of at most Δ."""
    rng = np.random.default_rng([seed, count])
    risk_bound, radius = 0.1, float(rng.choice([0.3, 0.8, 2.0]))
    root = rng.normal(size=(2, 2)) * radius * rng.uniform(0.05, 0.2) * noise
    covariance = root @ root.T + 0.01 * radius**2 * np.eye(2)
    corners = 1.5 * rng.normal(size=(rng.integers(1, 6), 2))
    body = shapely.MultiPoint(corners).convex_hull
    faces = np.zeros((1, 0, 2))
    if body.geom_type == "Polygon":
        corners = np.array(shapely.geometry.polygon.orient(body).exterior.coords)[:-1]
        faces = normals_of(corners)[None]
    outline = Outline(corners[None], faces, radius)
    tails = DiscTails.of(risk_bound)
    cones = cones_around(outline, covariance[None], tails, directions(count))
    if cones.is_void[0]:
        pytest.skip("too much noise around too small a hazard")
    grown = body.buffer(radius, quad_segs=200)
    tried = 0
    for away in rng.uniform(0.0, 4.0, 40) * np.sqrt(np.linalg.eigvalsh(covariance)[-1]):
        mean = np.array(
            grown.buffer(away).exterior.interpolate(rng.random(), normalized=True).coords[0]
        )
        truth = probability_within(mean, covariance, grown)
        if not 1e-9 < truth <= risk_bound:
            continue
        tried += 1
        clearances = clearances_of(cones, mean)
        enough = norm.sf(clearances) <= truth * (1.0 + 1e-4)
        assert any(all(enough[chain]) for chain in chains(cones))
    assert tried > 3


def test_cones_around_a_box_are_exact_along_its_faces() -> None:
    corners = np.array([[-1.0, -2.0], [1.0, -2.0], [1.0, 2.0], [-1.0, 2.0]])
    outline = Outline(corners[None], normals_of(corners)[None], 30.0)
    cones = cones_around(outline, 0.04 * np.eye(2)[None], DiscTails.of(0.01), directions(8))
    mean = np.array([31.0 + 3.0 * 0.2, 0.0])
    best = max(clearances_of(cones, mean)[chain[0]] for chain in chains(cones))
    # Three deviations, and what half-planes collect more than a disc of 150 deviations.
    assert 3.0 <= best <= 3.01


@pytest.mark.parametrize(
    ("faces", "beside"), [(3, 2), (4, 1), (5, 1), (6, 1), (7, 0), (8, 0), (20, 0)]
)
def test_wide_arcs_are_made_of_the_narrow_ones_within_them(faces: int, beside: int) -> None:
    count = faces * (4 * beside + 4)
    arcs = face_arcs(count, beside)
    held = [
        {k % count for k in range(first, last if last > first else last + count)}
        for first, last in zip(arcs.firsts.tolist(), arcs.lasts.tolist(), strict=True)
    ]
    assert held[:count] == [{k} for k in range(count)]
    for arc, parent in enumerate(arcs.parents.tolist()):
        assert parent == -1 or (parent > arc and held[arc] <= held[parent])
    widest = [held[arc] for arc in np.flatnonzero(arcs.parents < 0)]
    assert sum(map(len, widest)) == count
    assert set.union(*widest) == set(range(count))
    for wide in np.unique(arcs.parents[arcs.parents >= 0]):
        parts = [held[arc] for arc in np.flatnonzero(arcs.parents == wide)]
        assert set.union(*parts) == held[wide]


def test_without_noise_a_cone_begins_at_the_outline() -> None:
    wall = np.array([[0.0, 0.0], [2.0, 0.0]])
    faces = np.array([[[0.0, 1.0], [0.0, -1.0], [1.0, 0.0], [-1.0, 0.0]]])
    cones = cones_around(
        Outline(wall[None], faces, 0.0), np.zeros((1, 2, 2)), DiscTails.of(0.01), directions(8)
    )
    is_there = np.isfinite(cones.offsets[0])
    assert np.all(cones.deviations[0][is_there] == 0.0)
    slack = np.where(is_there, cones.offsets[0], np.inf)
    for mean in ([1.0, 0.01], [1.0, -0.01], [2.01, 0.0], [-0.01, 0.0], [2.1, 0.1], [-0.1, 0.1]):
        holds = cones.normals[0] @ mean >= slack
        assert any(all(holds[chain]) for chain in chains(cones))
    holds = cones.normals[0] @ [1.0, 0.0] >= slack + 1e-3
    assert not any(holds[chain[0]] for chain in chains(cones))


def two_vehicles(avoidance: str, *, has_feedback: bool) -> Scenario:
    """Two vehicles, a box and an obstacle that moves and turns."""
    system = double_integrator(1.0, 2)
    gain = lqr_gain(system, np.eye(4), 0.5 * np.eye(2)) if has_feedback else None
    noise = np.diag([0.02, 0.01, 0.004, 0.002])

    def vehicle(name: str, start: list[float], goal: list[float]) -> Vehicle:
        return Vehicle(
            name,
            system,
            start,
            Goal(np.array(goal) - 3.0, np.array(goal) + 3.0, None),
            radius=0.6,
            control_limit=3.0,
            initial_covariance=noise,
            disturbance_covariance=noise,
            gain=gain,
        )

    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    turns = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in np.arange(7) / 4]
    outlines = [square @ turn.T + [3.0, 6.0 - k] for k, turn in enumerate(turns)]
    return Scenario(
        name="two",
        dt=1.0,
        horizon=6,
        risk_bound=0.3,
        vehicles=(
            vehicle("a", [0.0, 0.0, 1.0, 0.2], [7.0, 2.0]),
            vehicle("b", [8.0, 4.0, -1.0, 0.0], [1.0, 4.0]),
        ),
        obstacles=(
            Obstacle.box("box", [2.5, -2.5], [4.5, -0.9]),
            Obstacle.moving("tug", outlines),
        ),
        avoidance=avoidance,
    )


def flown(scenario: Scenario, controls: list[Array]) -> Plan:
    """A plan of given controls."""
    return Plan(
        scenario=scenario,
        planner="none",
        seed=0,
        status=Status.FEASIBLE,
        cost=None,
        lower_bound=None,
        risk=Risk(scenario.risk_bound),
        sets=tuple((v.name,) for v in scenario.vehicles),
        trajectories=tuple(
            Trajectory(
                v.name, u, rollout(v.system, v.start, u), v.covariances(scenario.horizon), v.gain
            )
            for v, u in zip(scenario.vehicles, controls, strict=True)
        ),
    )


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("has_feedback", [False, True])
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_no_plan_is_certified_at_less_than_its_relaxation_risks(
    avoidance: str, has_feedback: bool
) -> None:
    scenario = two_vehicles(avoidance, has_feedback=has_feedback)
    models = condensed_models(scenario)
    tails = tails_of(scenario.risk_bound, are_integrated=avoidance == "steps")
    program = build_relaxation(scenario, models, tails, 8).program
    rater = Rater(program, scenario.risk_bound)
    rng = np.random.default_rng(0)
    compared = 0
    for scale in np.repeat([0.0, 0.02, 0.05, 0.1, 0.2], 6):
        controls = [scale * rng.normal(size=(scenario.horizon, 2)) for _ in scenario.vehicles]
        certified = certify(flown(scenario, controls)).certified
        if certified > scenario.risk_bound:
            continue
        halves = [(np.maximum(u, 0.0).ravel(), np.maximum(-u, 0.0).ravel()) for u in controls]
        z = np.concatenate([half for pair in halves for half in pair])
        compared += 1
        assert rater.rate(z).risk <= certified * (1.0 + 1e-9) + 1e-6
    assert compared > 8


@pytest.mark.parametrize("share", [0.3, 0.5, 1.0])
def test_covariances_between_steps_are_those_of_the_path_flown(share: float) -> None:
    scenario = two_vehicles("intervals", has_feedback=True)
    model = condensed_models(scenario)[0]
    part = ProgramBuilder(scenario, (model,), 0).parts[0]
    found = Instants.of(model, part, (share,)).covariances
    system, vehicle, rng = model.vehicle.system, model.vehicle, np.random.default_rng(1)
    assert vehicle.gain is not None
    samples = 100_000
    state = rng.multivariate_normal(np.zeros(4), vehicle.initial_covariance, samples)
    for k in range(3):
        push = state @ vehicle.gain.T
        noise = rng.multivariate_normal(np.zeros(4), vehicle.disturbance_covariance, samples)
        place, speed = state[:, list(system.position)], state[:, list(system.velocity or ())]
        flown = place + share * speed + 0.5 * share**2 * push
        flown = flown + share * noise[:, list(system.position)]
        expected = np.cov(flown.T)
        assert np.allclose(found[k], expected, rtol=0.04, atol=5e-4)
        state = state @ system.A.T + push @ system.B.T + noise


def test_the_bound_on_any_certified_plan_is_close_at_steps() -> None:
    result = plan(paper(2, 0), time_limit=30.0)
    assert result.certified_lower_bound is not None
    assert result.record.certified_gap is not None
    assert 0.0 <= result.record.certified_gap <= 0.01
    assert "could be certified costs 0." in result.record.status_sentence


@pytest.mark.slow
def test_the_bound_on_any_certified_plan_is_no_more_than_the_cost_along_intervals() -> None:
    result = plan(replace(circle(3), avoidance="intervals"), time_limit=20.0)
    alone = plan(replace(circle(3), vehicles=circle(3).vehicles[:1]), time_limit=20.0)
    assert result.cost is not None
    assert alone.cost is not None
    assert result.certified_lower_bound is not None
    assert 3.0 * alone.cost * 1.001 < result.certified_lower_bound <= result.cost
