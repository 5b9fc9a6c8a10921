from __future__ import annotations

import pytest

from radmpc import Goal, Obstacle, Scenario, ScenarioError, Vehicle, double_integrator
from radmpc.io.native.mapping import from_dict, to_dict
from radmpc.model.relations.concerns import all_but, concerned, is_for, met_by, only_for


def vehicle(name: str, y: float) -> Vehicle:
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=[0.0, y],
        goal=Goal.at([10.0, y], 0.5),
        radius=0.3,
        control_limit=2.0,
        initial_covariance=0.0,
        disturbance_covariance=0.0,
    )


REEF = Obstacle.box("reef", [4.0, -1.0], [5.0, 9.0])


def fleet(*obstacles: Obstacle) -> Scenario:
    vehicles = [vehicle(name, 3.0 * i) for i, name in enumerate("abc")]
    return Scenario("draught", 1.0, 8, 0.01, vehicles, obstacles)


def test_obstacles_concern_everybody_those_named_or_all_others() -> None:
    net, shoal = only_for(REEF, ["a", "c"]), all_but(REEF, ["c"])
    assert [is_for(REEF, name) for name in "abc"] == [True, True, True]
    assert [is_for(net, name) for name in "abc"] == [True, False, True]
    assert [is_for(shoal, name) for name in "abc"] == [True, True, False]
    table = concerned([net, shoal], ["a", "b"])
    assert table is not None
    assert table.tolist() == [[True, True], [False, True]]
    assert concerned([REEF], ["a"]) is None


def test_a_part_of_a_fleet_may_be_given_the_obstacles_that_it_can_meet() -> None:
    other = Obstacle.box("rock", [6.0, -1.0], [7.0, 0.0])
    whole = fleet(all_but(REEF, ["c"]), other)
    some = whole.with_vehicles(whole.vehicles[1:], whole.obstacles[:1])
    assert [one.name for one in some.obstacles] == ["reef"]
    assert [one.name for one in some.vehicles] == ["b", "c"]
    assert not is_for(some.obstacles[0], "c")
    everything = whole.with_vehicles(whole.vehicles[1:])
    assert [one.name for one in everything.obstacles] == ["reef", "rock"]


@pytest.mark.parametrize(
    ("obstacle", "key"), [(only_for(REEF, "ac"), "for"), (all_but(REEF, "c"), "except")]
)
def test_whom_obstacles_concern_is_read_back_as_it_was_written(
    obstacle: Obstacle, key: str
) -> None:
    data = to_dict(fleet(obstacle))
    written = data["obstacles"]
    assert isinstance(written, list)
    assert key in written[0]
    read = from_dict(data)
    assert isinstance(read, Scenario)
    assert read.obstacles[0].concerns == obstacle.concerns


def test_a_part_of_a_fleet_meets_what_concerns_it() -> None:
    part = fleet(only_for(REEF, "ac")).subset([1, 2], 0.01)
    assert met_by(part.obstacles, "b") == ()
    assert met_by(part.obstacles, "c") == part.obstacles
    nobody = fleet(only_for(REEF, "a")).subset([1, 2], 0.01)
    assert met_by(nobody.obstacles, "b") == met_by(nobody.obstacles, "c") == ()


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"for": ["d"]}, r"^obstacles\[0\]\.for\[0\]: must name vehicles .* got 'd'"),
        ({"except": ["a", "d"]}, r"^obstacles\[0\]\.except\[1\]: must name vehicles .* got 'd'"),
        ({"for": ["a"], "except": ["b"]}, r"^obstacles\[0\]\.except: must be left out beside for"),
        ({"for": []}, r"^obstacles\[0\]\.for: "),
        ({"for": ["a", "a"]}, r"^obstacles\[0\]\.for: must name vehicles, each once"),
        ({"excep": ["a"]}, r"^obstacles\[0\]\.excep: unknown key, did you mean 'except'"),
        ({"only": ["a"]}, r"^obstacles\[0\]\.only: unknown key"),
    ],
)
def test_wrong_names_are_refused_with_their_place(keys: dict[str, object], message: str) -> None:
    data = to_dict(fleet(REEF))
    written = data["obstacles"]
    assert isinstance(written, list)
    with pytest.raises(ScenarioError, match=message):
        from_dict({**data, "obstacles": [{**written[0], **keys}]})
