"""What starts and goals risk by themselves, against brute force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.endpoints.floors import floor_of, floors
from radmpc.planners.endpoints.screening import are_surely_harmless
from radmpc.program.build import condensed_models

SAMPLES = 200_000


def vehicle(name, start, goal, *, d=2, half=0.2, covariance=0.04):
    noise = np.diag([covariance] * d + [1e-9] * d)
    return Vehicle(
        name=name,
        system=double_integrator(1.0, d),
        start=np.array(start, dtype=float),
        goal=Goal.at(goal, half, 3.0),
        radius=0.3,
        control_limit=20.0,
        initial_covariance=noise,
        disturbance_covariance=1e-12,
    )


def scenario(*vehicles, **rest):
    settings = {"name": "places", "dt": 1.0, "horizon": 3, "risk_bound": 0.05} | rest
    return Scenario(vehicles=vehicles, **settings)


def found(problem):
    return floors(problem, condensed_models(problem))


def hit_rate(rng, mean, covariance, lower, upper, radius):
    points = rng.multivariate_normal(mean, covariance, SAMPLES)
    gaps = np.maximum(np.maximum(lower - points, points - upper), 0.0)
    return float(np.mean(np.linalg.norm(gaps, axis=1) < radius))


@pytest.mark.parametrize("seed", range(6))
def test_a_start_beside_a_box_risks_what_samples_of_it_do(seed):
    rng = np.random.default_rng(seed)
    start = rng.uniform(0.9, 1.5, 2)
    problem = scenario(
        vehicle("a", start, (9, 9)), obstacles=(Obstacle.box("box", [-1, -1], [1, 1]),)
    )
    danger = found(problem).starts[0]
    rate = hit_rate(rng, start, 0.04 * np.eye(2), -np.ones(2), np.ones(2), 0.3)
    assert danger.risk == pytest.approx(rate, abs=5e-3)
    assert (danger.cause, danger.other, danger.at_goal) == ("obstacle", "box", False)


def test_a_pair_of_starts_risks_what_samples_of_it_do():
    rng = np.random.default_rng(1)
    problem = scenario(vehicle("a", (0, 0), (9, 9)), vehicle("b", (0.5, 0.5), (-9, -9)))
    rate = hit_rate(rng, np.full(2, 0.5), 0.08 * np.eye(2), np.zeros(2), np.zeros(2), 0.6)
    [danger] = found(problem).starts
    assert danger.risk == pytest.approx(rate, abs=5e-3)
    assert danger.distance == pytest.approx(np.sqrt(0.5))


@pytest.mark.parametrize("seed", range(8))
def test_no_point_of_a_goal_risks_less_than_the_least_of_the_goal(seed):
    rng = np.random.default_rng(seed)
    goal = rng.uniform(-0.3, 0.3, 2)
    walls = (
        Obstacle.box("left", [-3, -3], [-0.85, 3]),
        Obstacle.box("right", [0.8, -3], [3, 3]),
        Obstacle.polygon("top", [(-1, 1.3), (1, 1.2), (0, 3)]),
    )
    problem = scenario(
        vehicle("a", (0, -9), goal, half=0.4),
        obstacles=walls,
        workspace=Workspace(np.array([-9.0, -9.5]), np.array([9.0, 9.0])),
    )
    least = found(problem).vehicles[0, 1]
    assert least > 0.0
    sums = []
    for point in goal + rng.uniform(-0.4, 0.4, (12, 2)):
        there = scenario(vehicle("a", point, (8, 8)), obstacles=walls, workspace=problem.workspace)
        sums.append(found(there).vehicles[0, 0])
    assert least <= min(sums) * (1.0 + 1e-4)


def test_a_goal_beside_one_wall_risks_what_its_farthest_corner_does():
    wall = Obstacle.box("wall", [-3, -3], [-1.2, 3])
    problem = scenario(vehicle("a", (0, -9), (-0.9, 0), half=0.3), obstacles=(wall,))
    there = scenario(vehicle("a", (-0.6, 0.3), (8, 8)), obstacles=(wall,))
    assert found(problem).vehicles[0, 1] == pytest.approx(found(there).total, rel=1e-3)


def test_the_least_risk_of_goals_in_space_is_that_of_their_farthest_corners():
    one = vehicle("a", (0, 0, 0), (5, 5, 5), d=3)
    two = vehicle("b", (9, 9, 9), (5.2, 5.2, 5.2), d=3)
    [danger] = found(scenario(one, two)).goals
    assert danger.distance == pytest.approx(np.sqrt(3.0) * 0.6, abs=1e-5)
    far = vehicle("a", (0, 0, 0), (9, 9, 9), d=3), vehicle("b", (0.6, 0.6, 0.6), (0, 9, 9), d=3)
    [apart] = found(scenario(*far)).starts
    assert danger.risk == pytest.approx(apart.risk, rel=1e-3)


@pytest.mark.parametrize("i", range(3))
def test_of_one_vehicle_everything_counts_that_names_it(i):
    wall = Obstacle.box("wall", [-3, -3], [-0.6, 3])
    fleet = (
        vehicle("a", (0, 0), (9, 9)),
        vehicle("b", (0.5, 0.5), (0, 8.6)),
        vehicle("c", (0.9, -0.4), (9.3, 8.8)),
    )
    problem = scenario(*fleet, obstacles=(wall,))
    floor = found(problem)
    named = [h.risk for h in (*floor.starts, *floor.goals) if i in h.members]
    assert len(named) > 1
    risked = floor_of(problem, condensed_models(problem), i)
    assert risked == pytest.approx(sum(named), rel=1e-12)


def test_places_far_from_everything_risk_nothing():
    rock = Obstacle.box("rock", [40, 40], [41, 41])
    problem = scenario(
        vehicle("a", (0, 0), (9, 9)), vehicle("b", (0, 9), (9, 0)), obstacles=(rock,)
    )
    answer = found(problem)
    assert answer.total == 0.0
    assert answer.starts == answer.goals == ()


def test_starts_that_only_just_touch_without_noise_risk_nothing():
    for gap, expected in ((0.6, 0.0), (0.6 - 5e-10, 0.0), (0.599, 1.0)):
        problem = scenario(
            vehicle("a", (0, 0), (9, 9), covariance=0.0),
            vehicle("b", (gap, 0), (9, -9), covariance=0.0),
        )
        assert found(problem).total == expected


@pytest.mark.parametrize("at_goal", [False, True])
def test_beside_an_obstacle_that_strays_both_noises_count(at_goal):
    """At the start what is known of it there, in a goal without width what is by then."""
    place = np.array([1.5, 0.2])
    far = np.array([9.0, 9.0])
    start, goal = (far, place) if at_goal else (place, far)
    box = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    known = np.array([0.02, 0.05, 0.03, 0.0])
    track = Obstacle.tracked("box", box, [0.0] * 4, known)
    problem = scenario(vehicle("a", start, goal, half=0.0), obstacles=(track,))
    hazards = found(problem).goals if at_goal else found(problem).starts
    strays = np.diag(known[:2] + (9.0 * known[2:] if at_goal else 0.0))
    rng = np.random.default_rng(0)
    rate = hit_rate(rng, place, 0.04 * np.eye(2) + strays, -np.ones(2), np.ones(2), 0.3)
    assert hazards[0].other == "box"
    assert hazards[0].risk == pytest.approx(rate, abs=6e-3)


def test_an_obstacle_that_is_nowhere_for_sure_may_lie_over_a_start():
    """Where it is expected it would be hit for certain; but it may well be elsewhere."""
    box = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    track = Obstacle.tracked("box", box, [0.0] * 4, [100.0, 100.0, 0.0, 0.0])
    problem = scenario(vehicle("a", (0, 0), (9, 9)), obstacles=(track,))
    assert 0.0 < found(problem).starts[0].risk < 0.02


def crowded(rng, d):
    """Vehicles among obstacles, near enough for some to be at risk where they start or end."""
    room = 6.0
    places = rng.uniform(1.0, room - 1.0, (2, 4, d))
    everyone = [
        vehicle(f"v{i}", places[0, i], places[1, i], d=d, covariance=float(rng.uniform(0, 0.02)))
        for i in range(int(rng.integers(1, 5)))
    ]
    obstacles = []
    for k in range(int(rng.integers(0, 3))):
        corner = rng.uniform(0.0, room, d)
        hull = np.concatenate([corner + rng.uniform(0.0, 1.0, (d + 3, d)), corner[None]])
        if d == 2 and k == 0:
            obstacles.append(Obstacle.polygon("hull", hull[ConvexHull(hull).vertices]))
        else:
            obstacles.append(Obstacle.box(f"box{k}", corner, corner + rng.uniform(0.2, 1.0, d)))
    walls = Workspace(np.zeros(d), np.full(d, room)) if rng.random() < 0.5 else None
    bound = float(10.0 ** rng.uniform(-6.0, -0.4))
    rest = {"obstacles": tuple(obstacles), "workspace": walls, "risk_bound": bound}
    return scenario(*everyone, **rest)


@pytest.mark.parametrize(("d", "samples"), [(2, None), (3, None), (2, 4), (2, 30)])
def test_what_one_look_calls_harmless_a_closer_one_does_not_rule_out(d, samples):
    rng, harmless = np.random.default_rng(d), 0
    for _ in range(150):
        problem = replace(crowded(rng, d), covariance_samples=samples)
        models = condensed_models(problem)
        if are_surely_harmless(problem, models):
            harmless += 1
            assert floors(problem, models).total <= problem.risk_bound
    assert 20 < harmless < 130


def test_tails_that_fall_slowly_are_harmless_farther_away():
    rock = Obstacle.box("rock", (3.0, 0.0), (4.0, 2.0))
    told = []
    for samples in (None, 30, 3):
        boat = vehicle("a", (1, 1), (9, 9))
        near = scenario(boat, obstacles=(rock,), risk_bound=1e-6, covariance_samples=samples)
        told.append(are_surely_harmless(near, condensed_models(near)))
        far = scenario(vehicle("a", (1, 1), (9, 9)), covariance_samples=samples)
        assert are_surely_harmless(far, condensed_models(far))
    assert told == [True, True, False]
