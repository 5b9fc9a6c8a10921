from __future__ import annotations

import itertools
import time
from dataclasses import replace

import numpy as np
import pytest
from visiting import vehicle

from radmpc import Goal, Scenario, ScenarioError, Status, certify, plan
from radmpc.io.native.mapping import from_dict, to_dict
from radmpc.model.dynamics import LinearSystem
from radmpc.model.relations.goals import places_of, same_goal
from radmpc.planners import assignment
from radmpc.planners.assignment import least_costs
from radmpc.planners.certified.certified import Certified
from radmpc.planners.draft import Draft
from radmpc.planners.planner import Planner, Run

ENDS = ([8.0, 6.0], [8.0, 0.0], [8.0, 3.0], [2.0, 9.0])

FAR = [{"center": end, "half_width": 0.5, "speed": None} for end in (*ENDS[:3], [90.0, 0.0])]


def sharing(count: int = 3, goals: int = 3, horizon: int = 5) -> Scenario:
    """Return vehicles in a column whose goals, as given, lie crosswise."""
    shared = [Goal.at(end, 0.5) for end in ENDS[:goals]]
    fleet = [
        replace(vehicle(name, [0.0, 3.0 * i], [0.0, 0.0]), goal=shared[i])
        for i, name in enumerate("abcd"[:count])
    ]
    return Scenario("berths", 1.0, horizon, 0.01, fleet, goals=shared)


def given_to(scenario: Scenario, places: tuple[int, ...]) -> Scenario:
    pairs = zip(scenario.vehicles, places, strict=True)
    fleet = tuple(replace(v, goal=scenario.goals[k]) for v, k in pairs)
    return replace(scenario, vehicles=fleet, goals=())


@pytest.mark.parametrize(("count", "goals"), [(3, 3), (2, 4)])
def test_no_assignment_is_cheaper(count: int, goals: int) -> None:
    given = sharing(count, goals)
    found = plan(given, "dlp")
    every = [
        plan(given_to(given, places), "dlp").cost
        for places in itertools.permutations(range(goals), count)
    ]
    least = min(cost for cost in every if cost is not None)
    assert found.cost == pytest.approx(least, rel=1e-3)
    planned = found.require()
    assert certify(planned).problems == ()
    taken = places_of(given.goals, [v.goal for v in planned.scenario.vehicles])
    assert None not in taken
    assert planned.explanation is not None
    assert planned.explanation.startswith("Goals were assigned: a to 2")
    as_given = least_costs(given)[np.arange(count), np.arange(count)].sum()
    assert f"as given, any plan costs {as_given:.4g} at least" in planned.explanation
    assert planned.cost is not None
    assert planned.cost < as_given


def test_costs_in_empty_space_are_those_of_each_alone() -> None:
    given = sharing()
    costs = least_costs(given)
    alone = replace(given.vehicles[1], goal=given.goals[2])
    one = Scenario("one", 1.0, given.horizon, 0.01, [alone])
    assert costs[1, 2] == pytest.approx(plan(one, "dlp").cost, rel=1e-4)


def test_an_assignment_that_took_its_share_of_the_time_limit_is_not_said_to_have_taken_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = Certified.plan

    def slow(self: Certified, scenario: Scenario, planner: Planner, run: Run) -> Draft:
        draft = whole(self, scenario, planner, run)
        time.sleep(run.limits.seconds_left)
        return replace(draft, status=Status.FEASIBLE, stopped_by=run.limits.reason)

    monkeypatch.setattr(Certified, "plan", slow)
    found = plan(sharing(1, 1), time_limit=1.0)
    assert found.record.stopped_by == "the share of the time limit for one assignment was used up"


@pytest.mark.slow
def test_bounds_hold_for_every_assignment() -> None:
    given = sharing(2, 2)
    found = plan(given, "certified(0)")
    others = [plan(given_to(given, places), "certified(0)") for places in ((0, 1), (1, 0))]
    assert found.cost == pytest.approx(min(o.cost for o in others if o.cost), rel=2e-3)
    assert found.cost is not None
    for bound in (found.lower_bound, found.certified_lower_bound):
        assert bound is not None
        assert bound <= found.cost
        assert all(one.cost is not None and bound <= one.cost for one in others)


def test_large_fleets_are_assigned_and_improved_by_swaps(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given = sharing()
    all_looked_at = plan(given, "dlp")
    monkeypatch.setattr(assignment, "_ALL", 1)
    found = plan(given, "dlp")
    assert found.cost == pytest.approx(all_looked_at.cost, rel=1e-3)
    assert found.plan is not None


def test_goals_out_of_reach_are_left_to_others() -> None:
    given = sharing(2, 2)
    far = Goal.at([90.0, 0.0], 0.5)
    near = given.goals[1]
    fleet = [replace(v, goal=g) for v, g in zip(given.vehicles, (far, near), strict=True)]
    third = Goal.at([6.0, 3.0], 0.5)
    planned = plan(replace(given, vehicles=fleet, goals=[far, near, third]), "dlp").require()
    assert not any(same_goal(v.goal, far) for v in planned.scenario.vehicles)
    infeasible = plan(replace(given, vehicles=fleet, goals=[far, near]), "dlp")
    assert infeasible.plan is None
    assert infeasible.status is Status.INFEASIBLE


def test_plans_say_who_got_which_goal_and_are_read_back() -> None:
    planned = plan(sharing(), "dlp").require()
    read = from_dict(to_dict(planned))
    for one, other in zip(read.scenario.vehicles, planned.scenario.vehicles, strict=True):
        assert same_goal(one.goal, other.goal)
    assert len(read.scenario.goals) == 3
    swapped = [v.goal for v in planned.scenario.vehicles][::-1]
    assert not same_goal(swapped[0], planned.scenario.vehicles[0].goal)


def test_files_assign_vehicles_own_goals_or_a_list() -> None:
    data = to_dict(replace(sharing(), goals=()))
    own = from_dict({**data, "assign": True})
    assert [same_goal(a, v.goal) for a, v in zip(own.goals, own.vehicles, strict=True)] == [
        True
    ] * 3
    vehicles = [{k: e for k, e in v.items() if k != "goal"} for v in data["vehicles"]]
    goals = [{"center": end, "half_width": 0.5} for end in ENDS]
    listed = from_dict({**data, "vehicles": vehicles, "assign": True, "goals": goals})
    assert len(listed.goals) == 4
    assert np.array_equal(listed.vehicles[2].goal.lower, [7.5, 2.5])


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"goals": [{"center": [1, 1]}] * 3}, r"^goals: stand beside assign: true alone"),
        ({"assign": True, "goals": [{"center": [1, 1]}]}, r"^goals: must be as many as vehicles"),
        ({"assign": True, "goals": [{"center": [1, 1]}] * 3}, r"^vehicles\[0\]\.goal: must be one"),
        ({"assign": True, "goals": []}, r"^goals: must be as many as vehicles at least, 3, got 0$"),
        ({"assign": True, "goals": [{"center": [1]}]}, r"^goals\[0\]"),
        ({"assign": 1}, r"^assign: "),
        (
            {"assign": True, "workspace": {"min": [0, 0], "max": [9, 7]}, "goals": FAR},
            r"^goals\[3\]: must touch the workspace \[0\.0, 0\.0\] to \[9\.0, 7\.0\], got ",
        ),
    ],
)
def test_wrong_goals_are_refused_with_their_place(keys: dict[str, object], message: str) -> None:
    data = to_dict(replace(sharing(), goals=()))
    with pytest.raises(ScenarioError, match=message):
        from_dict({**data, **keys})


def test_a_goal_with_a_speed_is_for_vehicles_that_have_one() -> None:
    given = sharing(2, 2)
    eye = np.eye(2)
    drifter = replace(
        given.vehicles[0],
        system=LinearSystem(eye, eye, (0, 1), None),
        start=[0.0, 0.0],
        goal=Goal.at(ENDS[0], 0.5, None),
        initial_covariance=0.0,
        disturbance_covariance=0.0,
        gain=None,
    )
    goals = [drifter.goal, given.goals[1]]
    with pytest.raises(
        ScenarioError, match=r"^goals\[1\]\.speed: the dynamics of 'a', which might"
    ):
        replace(given, vehicles=(drifter, given.vehicles[1]), goals=goals)


@pytest.mark.parametrize("is_first", [True, False])
@pytest.mark.parametrize("is_listed", [True, False])
def test_the_default_speed_of_a_file_is_blamed_where_some_vehicle_has_no_velocity(
    is_first: bool, is_listed: bool
) -> None:
    eye = [[1.0, 0.0], [0.0, 1.0]]
    usual: dict[str, object] = {
        "radius": 0.2,
        "initial_covariance": 0.0,
        "disturbance_covariance": 0.001,
    }
    goals: list[dict[str, object]] = [{"center": end, "half_width": 0.5} for end in ENDS[:2]]
    drifter: dict[str, object] = {
        "name": "raft",
        "dynamics": {"A": eye, "B": eye, "position": [0, 1]},
    }
    fleet = [drifter, {"name": "tug"}] if is_first else [{"name": "tug"}, drifter]
    for i, entry in enumerate(fleet):
        entry.update({"start": [0.0, 3.0 * i], "control_limit": 2.0})
        entry.update({} if is_listed else {"goal": goals[i]})
    data: dict[str, object] = {
        "format": "radmpc/scenario/1", "name": "mixed", "dt": 1.0, "horizon": 5,
        "risk_bound": 0.01, "defaults": usual, "vehicles": fleet, "assign": True,
    } | ({"goals": goals} if is_listed else {})  # fmt: skip
    with pytest.raises(ScenarioError) as caught:
        from_dict(data)
    assert caught.value.path[-1] == "speed"
    assert caught.value.message == (
        "the dynamics of 'raft', which might go there, have no velocity: goals that are shared "
        "must all have the speed null, got [0.0, 0.0] (in files the default is 0)"
    )
    for goal in goals:
        goal["speed"] = None
    found = from_dict(data)
    assert isinstance(found, Scenario)
    assert len(found.goals) == 2


@pytest.mark.parametrize("count", [0, 2])
def test_fewer_goals_than_vehicles_without_one_are_counted_at_the_list(count: int) -> None:
    data = to_dict(replace(sharing(), goals=()))
    vehicles = [{k: e for k, e in v.items() if k != "goal"} for v in data["vehicles"]]
    goals = [{"center": end, "half_width": 0.5} for end in ENDS[:count]]
    with pytest.raises(ScenarioError) as caught:
        from_dict({**data, "vehicles": vehicles, "assign": True, "goals": goals})
    assert str(caught.value) == (
        f"goals: must be as many as vehicles at least, 3, got {count}; "
        "without a goal of their own are 3"
    )
    assert caught.value.more == ()


def test_goals_that_nobody_is_there_to_share_leave_the_missing_vehicles_to_be_named() -> None:
    data = to_dict(replace(sharing(), goals=()))
    goals = [{"center": end, "half_width": 0.5} for end in ENDS]
    with pytest.raises(ScenarioError, match=r"^vehicles: needs at least one vehicle"):
        from_dict({**data, "vehicles": [], "assign": True, "goals": goals})
