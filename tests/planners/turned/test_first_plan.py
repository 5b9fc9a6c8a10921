"""A first plan of crowded fleets, before anything is searched."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from radmpc import Goal, Scenario, Vehicle, certify, double_integrator, import_scenario, plan
from radmpc.experiments.families import circle, paper
from radmpc.model.obstacle import Obstacle
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned import attempts as making
from radmpc.planners.certified.turned.detours import detours
from radmpc.planners.certified.turned.first_plan import _seconds as first_seconds
from radmpc.planners.certified.turned.narrow.prioritized import prioritized_ticks
from radmpc.planners.certified.turned.paths import timed
from radmpc.planners.certified.turned.price_control import PriceControl
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.verdict import Verdict
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits
from running import first_plan

INSTANCES = Path(__file__).parents[3] / "instances"


def separation(controls: list[np.ndarray], hazards: Hazards) -> float:
    """Least distance of any two hulls, by dense sampling of the flown parabolas."""
    tau = np.linspace(0.0, 1.0, 21)[:, None]
    curves = []
    for model, u in zip(hazards.models, controls, strict=True):
        means = model.drift_position + model.position @ u.ravel()
        sagitta = u @ model.vehicle.system.sagitta.T
        curves.append(
            np.concatenate(
                [
                    means[k] * (1 - tau) + means[k + 1] * tau - 4 * tau * (1 - tau) * sagitta[k]
                    for k in range(hazards.horizon)
                ]
            )
        )
    least = np.inf
    for i, one in enumerate(curves):
        for j in range(i):
            apart = np.linalg.norm(one - curves[j], axis=1).min()
            least = min(least, apart - hazards.radii[i] - hazards.radii[j])
    return least


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["lsc_planner/empty_20agents_3.json", "s2m2/mit.yaml"])
def test_dense_fleets_of_others_get_a_certified_plan_before_any_search(name: str) -> None:
    scenario = import_scenario(INSTANCES / name).scenario
    result = first_plan(scenario, time_limit=60.0)
    assert result.plan is not None
    assert certify(result.plan).holds


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("name", "cost"),
    [
        ("lsc_planner/empty_20agents_3.json", 36.0),
        ("lsc_planner/empty_40agents_3.json", 77.0),
        ("lsc_planner/forest_20agents_3.json", 61.0),
    ],
)
def test_what_a_script_of_successive_programs_finds_is_found(name: str, cost: float) -> None:
    scenario = import_scenario(INSTANCES / name).scenario
    result = first_plan(scenario, time_limit=60.0)
    assert result.plan is not None
    # A first plan is within 4 % of these; the search and the turning at the end lower it further.
    assert result.cost <= 1.04 * cost


@pytest.mark.parametrize(
    ("name", "best"),
    [
        ("db-CBS/forest.yaml", 4.352),
        ("libMultiRobotPlanning/map_8by8_obst12_agents4_ex1.yaml", 6.240),
    ],
)
def test_the_very_first_plan_among_boxes_takes_no_wide_bends(name: str, best: float) -> None:
    costs: list[float] = []
    scenario = import_scenario(INSTANCES / name).scenario
    plan(scenario, found=lambda cost, _: costs.append(cost), stop=lambda: bool(costs))
    assert costs[0] <= 1.25 * best


def test_one_vehicle_after_the_other_keeps_everyone_apart_between_the_steps() -> None:
    scenario = replace(circle(6), avoidance="intervals")
    hazards = Hazards.of(scenario, condensed_models(scenario))
    successive = SuccessiveLp(hazards, Limits())
    assert successive.begin_alone()
    assert separation(successive.paths.controls, hazards) < 0.0
    assert successive.keep_apart(2.0, 40)
    assert separation(successive.paths.controls, hazards) > 0.0


def test_where_nobody_fits_through_it_is_said_that_nothing_helps() -> None:
    scenario = paper(1, 0)
    wall = Obstacle.box("wall", np.array([-100.0, -100.0]), np.array([100.0, 100.0]))
    blocked = replace(scenario, obstacles=(wall,), workspace=None)
    hazards = Hazards.of(blocked, condensed_models(blocked))
    successive = SuccessiveLp(hazards, Limits())
    assert successive.begin_alone()
    assert not successive.keep_apart(2.0, 40)
    assert successive.missed[0] > 1.0


def test_a_detour_leads_around_a_wall_and_is_timed_from_start_to_goal() -> None:
    scenario = paper(1, 0)
    vehicle = scenario.vehicles[0]
    start = vehicle.start[:2]
    goal = 0.5 * (vehicle.goal.lower + vehicle.goal.upper)
    middle, along = 0.5 * (start + goal), (goal - start) / np.linalg.norm(goal - start)
    across = np.array([-along[1], along[0]])
    sides = ((-0.5, -0.1), (2.5, -0.1), (2.5, 0.1), (-0.5, 0.1))
    corners = [middle + a * across + b * along for a, b in sides]
    wall = Obstacle.polygon("wall", np.array(corners))
    walled = replace(scenario, obstacles=(wall,))
    hazards = Hazards.of(walled, condensed_models(walled))
    route = detours(hazards, [0])[0]
    faces = wall.at(0)[0]
    outside = (route @ faces.normals.T - faces.offsets).max(axis=1)
    assert outside.min() >= vehicle.radius - 1e-9 - 0.1
    # The short route: past the end half a meter off the line, not past the one at 2.5 m.
    assert ((route - middle) @ across).min() < -0.5
    steps = timed(route, 10, 0.2, 0.7)
    assert steps[:3] == pytest.approx(np.tile(start, (3, 1)))
    assert steps[7:] == pytest.approx(np.tile(goal, (4, 1)))
    # The spacing is even between.
    assert (
        np.linalg.norm(np.diff(steps[2:8], axis=0), axis=1).max()
        <= np.linalg.norm(np.diff(route, axis=0), axis=1).sum() / 5.0 + 1e-9
    )


def test_a_price_that_led_too_far_is_raised_from_the_last_certified_paths() -> None:
    control = PriceControl(1.0, 0.1, 1e-3)
    control.begin(0.05, 10.0, "certified")  # type: ignore[arg-type] # any token will do
    assert control.follow(0.09, 9.0, "better") is None  # type: ignore[arg-type] # any token
    before = control.price
    assert control.follow(5.0, 7.0, "lost") == "better"  # type: ignore[arg-type] # any token
    assert control.price > before


def test_a_price_that_certificates_hardly_answer_is_found_in_a_few_rounds() -> None:
    risk_bound, reply, cost = 0.1, 0.3, 10.0
    control, rounds = PriceControl(2.0, risk_bound, 1e-3), 0
    control.begin(risk_bound, cost, "begun")  # type: ignore[arg-type] # any token will do
    certified = 0.0
    while abs(certified / (0.985 * risk_bound) - 1.0) > 0.01:
        certified, rounds = risk_bound * control.price**-reply, rounds + 1
        cost -= 0.1
        assert control.follow(certified, cost, "more") is None  # type: ignore[arg-type] # as above
    # By the ratio to the power of 0.8 each round leaves three quarters of what is missing: 12.
    assert rounds <= 5


@pytest.mark.slow
def test_ways_at_drawn_times_lead_to_the_same_plan_from_the_same_seed() -> None:
    scenario = import_scenario(INSTANCES / "s2m2" / "parking.yaml").scenario
    plans = [first_plan(scenario, time_limit=60.0) for _ in range(2)]
    assert plans[0].cost == plans[1].cost


@pytest.mark.nightly
def test_a_plan_among_turned_half_spaces_costs_no_more_than_by_faces() -> None:
    scenario = replace(circle(4), avoidance="intervals")
    result = plan(scenario, time_limit=20.0)
    assert result.cost is not None
    assert result.cost < 16.66


def test_prioritized_ways_keep_off_each_other_and_off_the_walls_at_every_step() -> None:
    scenario = import_scenario(INSTANCES / "s2m2" / "zigzag.yaml").scenario
    hazards = Hazards.of(scenario, condensed_models(scenario))
    placed, ticks = prioritized_ticks(hazards, lambda: False)
    routes = {i: path[::ticks] for i, path in placed.items()}
    assert sorted(routes) == list(range(hazards.count))
    faces = [piece for obstacle in scenario.obstacles for piece in obstacle.at(0)]
    for i, route in routes.items():
        assert route.shape == (hazards.horizon + 1, 2)
        for j in range(i):
            apart = np.linalg.norm(route - routes[j], axis=1)
            assert apart.min() > hazards.radii[i] + hazards.radii[j]
        for piece in faces:
            outside = (route @ piece.normals.T - piece.offsets).max(axis=1)
            assert outside.min() >= hazards.radii[i]
        # No step is longer than the vehicle can move.
        assert np.abs(np.diff(route, axis=0)).max() <= hazards.reaches[i]


def test_prioritized_planning_says_when_nobody_gets_through() -> None:
    scenario = paper(2, 0)
    wall = Obstacle.box("wall", np.array([-100.0, -100.0]), np.array([100.0, 100.0]))
    blocked = replace(scenario, obstacles=(wall,), workspace=None)
    hazards = Hazards.of(blocked, condensed_models(blocked))
    assert prioritized_ticks(hazards, lambda: False)[0] == {}


def beside_a_post(clearance: float) -> Scenario:
    """Eight lanes; in the first there is a rock on the way, and a post behind the goal.

    The post is as many standard deviations from the goal as given: fewer than a first plan keeps
    from everything, and enough for Δ.
    """
    system = double_integrator(1.0, 2)
    known, noise = np.diag([0.01, 0.01, 0.0, 0.0]), np.diag([0.02, 0.02, 0.0, 0.0])
    vehicles = []
    for lane in range(8):
        start, goal = np.array([0.0, 20.0 * lane, 0.0, 0.0]), np.array([12.0, 20.0 * lane])
        box = Goal(goal - 0.01, goal + 0.01, np.full(2, 0.5))
        rest = (system, start, box, 0.1, np.full(2, 3.0), known, noise)
        vehicles.append(Vehicle(f"v{lane + 1}", *rest))
    spread = np.sqrt(vehicles[0].covariances(8)[-1][0, 0])
    face = 12.11 + clearance * spread
    obstacles = (
        Obstacle.box("rock", [5.0, -1.0], [7.0, 1.5]),
        Obstacle.box("post", [face, -1.0], [face + 0.5, 1.0]),
    )
    return Scenario(
        name="post", dt=1.0, horizon=8, vehicles=vehicles, obstacles=obstacles, risk_bound=0.05,
        avoidance="steps",
    )  # fmt: skip


@pytest.mark.slow
def test_what_no_attempt_keeps_is_not_tried_again_and_again(monkeypatch):
    missed, turned = [], making._turned

    def counted(*args):
        told = turned(*args)
        missed.append(told[0])
        return told

    monkeypatch.setattr(making, "_turned", counted)
    found = first_plan(beside_a_post(1.7), time_limit=20.0)
    assert found.is_certified
    assert 1 < len(missed) <= 3
    assert missed[0] > 0.05  # of the clearance [m]: else there was nothing to give up


def test_who_gives_way_at_once_has_a_certified_plan_before_the_search(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(PriceSearch, "run", lambda *_: pytest.fail("there is a plan already"))
    scenario = replace(circle(3), avoidance="intervals")
    result = first_plan(scenario, time_limit=30.0)
    assert result.plan is not None
    assert certify(result.plan).holds


def test_few_vehicles_have_some_seconds_for_a_first_plan_whatever_the_limit() -> None:
    scenario = circle(4)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    for limit, least in ((200.0, 19.9), (60.0, 9.9), (20.0, 7.9), (1.0, 0.39)):
        limits = Limits().within(limit)
        task = Task(hazards, lambda _: Verdict(1.0, ()), limits, 1e-3, 0.05, lambda _: None)
        assert least < first_seconds(task, is_aside=True, is_maze=False) < 0.41 * limit
