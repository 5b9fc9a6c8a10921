"""Visits that no plan can make within the risk bound are told without a search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radmpc
from radmpc import Goal, Obstacle, Scenario, Vehicle, Visit
from radmpc.model.plan import Status
from radmpc.model.relations.concerns import all_but
from radmpc.planners.endpoints.visiting import risky_visits
from radmpc.planners.presolve import sure_reasons
from radmpc.preflight import concerns_of, outlook_of
from radmpc.program.build import condensed_models
from radmpc.referee import certify

SYSTEM = radmpc.double_integrator(1.0, dimension=2)
REEF = Obstacle.box("reef", [4.0, -1.0], [6.0, 1.0])


def scene(*via: Visit, obstacles: tuple[Obstacle, ...] = (REEF,), **fields: object) -> Scenario:
    """A vehicle from left to right that visits boxes on its way."""
    vehicle = Vehicle(
        "boat", SYSTEM, [0.0, 3.0], Goal.at([10.0, 3.0], 0.3), radius=0.5, control_limit=2.0,
        initial_covariance=[1e-3, 1e-3, 1e-4, 1e-4],
        disturbance_covariance=[1e-3, 1e-3, 1e-4, 1e-4], via=via,
    )  # fmt: skip
    drawn = Scenario("visits", 1.0, 10, 0.05, [vehicle], obstacles)
    return replace(drawn, **fields)


def reasons(scenario: Scenario) -> list[str]:
    """What rules out a plan without a search."""
    return [reason.text for reason in sure_reasons(scenario, condensed_models(scenario))]


def test_a_visit_within_a_grown_obstacle_is_told_at_once() -> None:
    result = radmpc.plan(scene(Visit.at([5.0, 1.2], 0.2, between=[2, 8])), rng=0)
    assert result.status is Status.INFEASIBLE
    assert result.explanation.startswith(
        "The box of via[0] of vehicle 'boat' lies within obstacle 'reef' grown by the vehicle's "
        "radius of 0.5 m (a risk of "
    )
    assert "at any step from 2 to 8, above risk_bound 0.05)" in result.explanation
    assert "faces" not in result.explanation


def test_check_says_of_such_a_visit_what_planning_says() -> None:
    blocked = scene(Visit.at([5.0, 1.2], 0.2, between=[2, 8]))
    for given in (blocked, scene(Visit.at([5.0, 1.55], 0.0, between=[4, 4]))):
        (told,) = [one for one in concerns_of(outlook_of(given)) if one.is_fatal]
        assert (told.kind, told.vehicles, told.text) == ("visit", ("boat",), reasons(given)[0])
    free = outlook_of(scene(Visit.at([5.0, 3.2], 0.2)))
    assert not any(one.is_fatal for one in concerns_of(free))


def test_a_visit_that_is_too_close_in_the_noise_is_told_with_what_it_is_close_to() -> None:
    (text,) = reasons(scene(Visit.at([5.0, 1.55], 0.0, between=[4, 4])))
    assert text.startswith(
        "The box of via[0] of vehicle 'boat' is too close to obstacle 'reef': even its best point "
        "runs a risk of 0."
    )
    assert text.endswith(" at step 4, above risk_bound 0.05.")


def test_a_box_that_sticks_out_of_an_obstacle_is_no_reason() -> None:
    assert reasons(scene(Visit.at([5.0, 1.2], 1.5, between=[2, 8]))) == []


def test_one_step_at_which_a_visit_is_free_is_enough() -> None:
    corners = np.array([[4.0, -1.0], [6.0, -1.0], [6.0, 1.0], [4.0, 1.0]])
    ferry = Obstacle.moving("ferry", [corners + np.array([0.0, 1.5 * k - 3.0]) for k in range(11)])
    whole = scene(Visit.at([5.0, 1.5], 0.1, between=[3, 3]), obstacles=(ferry,))
    assert "obstacle 'ferry'" in reasons(whole)[0]
    assert reasons(scene(Visit.at([5.0, 1.5], 0.1, between=[3, 6]), obstacles=(ferry,))) == []


def test_of_every_vehicle_the_first_such_visit_is_told() -> None:
    blocked = Visit.at([5.0, 0.0], 0.1)
    assert len(reasons(scene(Visit.at([2.0, 3.0], 1.0), blocked, Visit.at([4.6, 0.0], 0.1)))) == 1
    assert "via[1]" in reasons(scene(Visit.at([2.0, 3.0], 1.0), blocked))[0]


def test_an_obstacle_that_is_not_for_the_vehicle_is_no_reason() -> None:
    blocked = Visit.at([5.0, 0.0], 0.1)
    assert len(reasons(scene(blocked))) == 1
    assert reasons(scene(blocked, obstacles=(all_but(REEF, ["boat"]),))) == []


@pytest.mark.parametrize("beyond", [0.56, 0.6])
def test_no_plan_that_makes_a_visit_is_certified_below_what_is_said_of_it(beyond: float) -> None:
    scenario = scene(Visit.at([5.0, 1.0 + beyond], 0.05, between=[3, 7]), risk_bound=0.4)
    (found,) = risky_visits(scenario, condensed_models(scenario), 0.0)
    assert found.within is None
    assert found.risk > 1e-6
    plan = radmpc.plan(scenario, rng=0).require()
    assert certify(plan).certified >= found.risk * (1.0 - 1e-9)
    assert np.isclose(found.steps, (3, 7)).all()


@pytest.mark.parametrize("visits", [([6.0, 7.0], [4.0, 5.0]), ([8.0, 6.0], [4.0, 6.0])])
def test_visits_too_far_apart_for_the_fastest_speed_leave_no_plan(
    visits: tuple[list[float], ...],
) -> None:
    # A plan that missed them was called optimal, at a proven cost.
    given = scene(*(Visit.at(place, 0.3) for place in visits), obstacles=(), horizon=8)
    slow = replace(given.vehicles[0], speed_limit=[1.6, 1.6])
    result = radmpc.plan(replace(given, vehicles=[slow]), rng=0)
    assert result.status is Status.INFEASIBLE
    assert result.explanation.startswith(
        "Vehicle 'boat' cannot make its 2 visits in order and be at its goal by step 8 (8 s)"
    )
