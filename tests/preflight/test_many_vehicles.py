"""A look at a fleet is one at each of its vehicles, and no more."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc import Goal, Obstacle, Scenario, Vehicle, double_integrator
from radmpc.model import consistency
from radmpc.model.relations.concerns import all_but, only_for
from radmpc.model.relations.keep import Keep
from radmpc.preflight.outlook import outlook_of

GAIN = np.array([[-0.2, 0.0, -0.6, 0.0], [0.0, -0.2, 0.0, -0.6]])


def boat(name: str, south: float) -> Vehicle:
    """A boat that goes 20 m east, with arrays of its own."""
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=[0.0, -south],
        goal=Goal.at([20.0, -south], 0.5),
        radius=0.5,
        control_limit=2.0,
        initial_covariance=1e-3,
        disturbance_covariance=1e-4,
        gain=GAIN.copy(),
    )


def boats(count: int, *obstacles: Obstacle) -> Scenario:
    fleet = tuple(boat(f"v{i}", 4.0 * i) for i in range(count))
    return Scenario("boats", 1.0, 16, 0.02, fleet, obstacles)


@pytest.mark.parametrize("count", [3, 20])
def test_a_look_at_more_vehicles_checks_no_scenario_anew(
    count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = boats(count, Obstacle.box("rock", [9.0, -1.0], [10.0, 1.0]))
    checked: list[int] = []
    monkeypatch.setattr(consistency, "check_step", lambda v, dt: checked.append(len(v)))
    assert len(outlook_of(scenario).vehicles) == count
    assert checked == []


def test_a_scenario_made_anew_for_a_vehicle_is_its_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    rock = only_for(Obstacle.box("rock", [9.0, -1.0], [10.0, 1.0]), ["v0"])
    scenario = boats(12, rock)
    checked: list[int] = []
    monkeypatch.setattr(consistency, "check_step", lambda v, dt: checked.append(len(v)))
    outlook_of(scenario)
    assert checked == [1] * 11


def test_dynamics_alike_are_followed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    followed: list[bool] = []
    growth = consistency.growth

    def counting(system: object, gain: np.ndarray | None, horizon: int) -> float:
        followed.append(gain is not None)
        return growth(system, gain, horizon)  # type: ignore[arg-type]

    monkeypatch.setattr(consistency, "growth", counting)
    boats(20)
    assert followed == [False, True]


def test_narrow_places_are_those_of_the_obstacles_that_concern_a_vehicle() -> None:
    walls = (
        only_for(Obstacle.box("south", [9.0, -90.0], [10.0, -0.9]), ["v0"]),
        all_but(Obstacle.box("north", [9.0, 0.9], [10.0, 90.0]), ["v1", "v2"]),
    )
    scenario = boats(3, *walls)
    scenario = replace(scenario, keep=(Keep(["v0", "v1"], 50.0),))
    first, second, third = outlook_of(scenario).vehicles
    bare = tuple(replace(wall, concerns=None) for wall in walls)
    (alone,) = outlook_of(boats(1, *bare)).vehicles
    (free,) = outlook_of(boats(1)).vehicles
    assert first.narrowest == alone.narrowest
    assert second.narrowest == third.narrowest == free.narrowest
