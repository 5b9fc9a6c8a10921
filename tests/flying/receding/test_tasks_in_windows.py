"""Missions of many windows with visits, arrivals and goals to choose from: each is done once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from radmpc.errors import ScenarioError
from radmpc.experiments.families import paper
from radmpc.flying.model import Model
from radmpc.flying.receding.guide import coarse_plan
from radmpc.flying.receding.itinerary import Itinerary, Progress
from radmpc.flying.receding.long_mission import LongMission
from radmpc.flying.remainder import changed
from radmpc.model.goal import Goal
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.visits import Visit

HORIZON, SPACING = 24, 6.0


def tour() -> Scenario:
    """Return two vehicles side by side that visit two boxes each, the second within windows."""
    vehicles = []
    for i, vehicle in enumerate(paper(2, 1).vehicles):
        y = SPACING * i
        windows = [(3, 9), (13, 17)] if i else [None, None]
        pairs = zip([[8.0, y - 1.0], [16.0, y + 1.0]], windows, strict=True)
        via = tuple(Visit.at(place, 0.5, window) for place, window in pairs)
        start, goal = np.array([0.0, y, 0.0, 0.0]), Goal.at([24.0, y], 0.5, 0.5)
        vehicles.append(replace(vehicle, start=start, goal=goal, via=via))
    scenario = replace(paper(2, 1), workspace=None, obstacles=(), horizon=HORIZON)
    return replace(scenario, vehicles=tuple(vehicles))


def flown(mission: LongMission, seed: int = 1) -> list[list[np.ndarray]]:
    """Fly a mission; return where each vehicle's mean was to be at every step, when it came."""
    model = Model(mission.scenario, seed)
    states, contacts = model.reset()
    means: list[list[np.ndarray]] = [[] for _ in mission.scenario.vehicles]
    while not mission.is_over:
        window = mission._mission
        at = len(mission.ticks) - window.began - window.leg.began
        for i, path in enumerate(window.leg.plan.trajectories):
            means[i].append(path.means[at])
        tick = mission.step(states, contacts=contacts)
        if tick.segments:
            states, contacts = model.advance(tick.segments)
    assert not mission.is_stranded
    return means


def are_in(means: list[np.ndarray], box: Visit | Goal) -> list[int]:
    """Return the steps at which means are in a box."""
    places = np.array([mean[:2] for mean in means])
    inside = (places >= box.lower - 1e-5) & (places <= box.upper + 1e-5)
    return [int(step) for step in np.flatnonzero(inside.all(axis=1))]


def test_every_visit_is_made_in_its_window_in_turn() -> None:
    scenario = tour()
    mission = LongMission(scenario, window=9, overlap=4)
    means = flown(mission)
    windows = [e.step for e in mission.account if e.what in {"opened", "window"}]
    assert len(windows) >= 4
    for vehicle, path in zip(scenario.vehicles, means, strict=True):
        last = 0
        for visit in vehicle.via:
            first, end = visit.window(HORIZON)
            made = [step for step in are_in(path, visit) if max(first, last + 1) <= step <= end]
            assert made
            last = made[0]
        # What pushed the vehicle in its last steps, no control could answer any more.
        end, push = path[-1][:2], 3.0 * np.sqrt(vehicle.disturbance_covariance[0, 0])
        assert np.all((end >= vehicle.goal.lower - push) & (end <= vehicle.goal.upper + push))


def forgets(patch: pytest.MonkeyPatch) -> None:
    """What was visited in windows before is to be visited again."""
    patch.setattr(Progress, "less", lambda self, *_: Progress.none(len(self.visits)))


def leaves_out(patch: pytest.MonkeyPatch) -> None:
    """What windows are asked for counts as made when the next one begins."""
    patch.setattr(Progress, "less", lambda self, *_: self)


def counts_from_the_start(patch: pytest.MonkeyPatch) -> None:
    """Windows of visits are not moved to where windows begin."""
    path = "radmpc.flying.receding.itinerary._from"
    patch.setattr(path, lambda window, step, horizon: (window[0], min(window[1], horizon)))


@pytest.mark.parametrize("mutant", [forgets, leaves_out, counts_from_the_start])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_who_loses_count_of_visits_is_found_out(
    mutant: Callable[[pytest.MonkeyPatch], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    mutant(monkeypatch)
    with pytest.raises(AssertionError):
        test_every_visit_is_made_in_its_window_in_turn()


def test_who_arrives_early_stays() -> None:
    scenario = tour()
    vehicles = tuple(
        replace(v, via=(), goal=replace(v.goal, within=(12, 20))) for v in scenario.vehicles
    )
    scenario = replace(scenario, vehicles=vehicles, time_weight=1.0)
    means = flown(LongMission(scenario, window=9, overlap=4))
    for vehicle, path in zip(vehicles, means, strict=True):
        steps = are_in(path, vehicle.goal)
        arrival = next(k for k in steps if all(j in steps for j in range(k, HORIZON + 1)))
        assert 12 <= arrival <= 20


def test_goals_are_assigned_before_the_first_window() -> None:
    scenario = tour()
    goals = tuple(v.goal for v in reversed(scenario.vehicles))
    pairs = zip(scenario.vehicles, goals, strict=True)
    vehicles = tuple(replace(v, via=(), goal=goal) for v, goal in pairs)
    mission = LongMission(replace(scenario, vehicles=vehicles, goals=goals), window=9, overlap=4)
    assert [v.goal for v in mission.scenario.vehicles] == [goals[1], goals[0]]
    assert not mission.scenario.goals
    ends = [path[-1][:2] for path in flown(mission)]
    centers = [v.goal.center for v in mission.scenario.vehicles]
    assert np.abs(np.array(ends) - centers).max() < 1.0


def test_a_goal_that_nobody_needs_may_have_a_short_window() -> None:
    scenario = tour()
    vehicles = tuple(replace(v, via=()) for v in scenario.vehicles)
    spare = Goal.at([24.0, 12.0], 0.5, 0.5, within=(23, 23))
    goals = (*(v.goal for v in vehicles), spare)
    itinerary = Itinerary.planned(replace(scenario, vehicles=vehicles, goals=goals), 9)
    assert [v.goal for v in itinerary.scenario.vehicles] == list(goals[:2])


def test_goals_that_coarse_steps_cannot_tell_apart_are_given_once_each() -> None:
    scenario = tour()
    vehicles = tuple(replace(v, via=()) for v in scenario.vehicles)
    coarse = coarse_plan(replace(scenario, vehicles=vehicles), 9)
    assert coarse.stride > 1
    goal = replace(vehicles[0].goal, within=(coarse.stride, HORIZON))
    planned = tuple(
        replace(v, goal=replace(goal, within=(1, HORIZON // coarse.stride))) for v in vehicles
    )
    plan = replace(coarse.plan, scenario=changed(coarse.plan.scenario, vehicles=planned))
    alike = [goal, replace(goal, within=(coarse.stride - 1, HORIZON))]
    assert replace(coarse, plan=plan).goals(alike) == alike


def test_a_guide_without_room_for_all_noise_is_closer() -> None:
    [vehicle] = tour().vehicles[:1]
    south = Obstacle.box("south", [10.0, -9.0], [11.0, -0.9])
    north = Obstacle.box("north", [10.0, 0.9], [11.0, 9.0])
    vehicle = replace(vehicle, via=(), disturbance_covariance=4.0 * vehicle.disturbance_covariance)
    workspace = Workspace([-2.0, -9.0], [28.0, 9.0])
    scenario = replace(tour(), vehicles=(vehicle,), obstacles=(south, north), workspace=workspace)
    guide = Itinerary.planned(scenario, 20).guide
    assert abs(guide(12)[0].center[1]) < 1.0


def test_by_a_given_guide_visits_are_due_by_the_ends_of_their_windows() -> None:
    scenario = tour()
    timed = replace(scenario, vehicles=scenario.vehicles[1:])
    itinerary = Itinerary.given(timed, lambda step: [v.goal for v in timed.vehicles])
    assert itinerary.visits == ((9, 17),)
    window = itinerary.asked(replace(itinerary.until(12), horizon=8), 4, Progress((0,), (False,)))
    [visit] = window.vehicles[0].via
    assert visit.between == (1, 5)
    made = itinerary.asked(replace(itinerary.until(20), horizon=10), 10, Progress((1,), (False,)))
    assert [v.between for v in made.vehicles[0].via] == [(3, 7)]


def test_what_a_given_guide_cannot_tell_is_refused_in_one_line() -> None:
    scenario = tour()

    def guide(step: int) -> list[Goal]:
        return [v.goal for v in scenario.vehicles]

    with pytest.raises(ScenarioError, match="needs a window of steps") as caught:
        LongMission(scenario, window=9, overlap=4, guide=guide)
    assert caught.value.path == ("vehicles", 0, "via", 0)
    shared = replace(
        scenario,
        vehicles=tuple(replace(v, via=()) for v in scenario.vehicles),
        goals=tuple(v.goal for v in scenario.vehicles),
    )
    with pytest.raises(ScenarioError, match="are to be assigned, which a guide does not") as caught:
        LongMission(shared, window=9, overlap=4, guide=guide)
    assert caught.value.path == ("goals",)
