from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from radmpc.errors import FileFormatError
from radmpc.importing.formats import ImportOptions, import_scenario

FOLDER = Path(__file__).parent.parent.parent / "instances" / "s2m2"

TWO = """\
agents:
- {k: [0.5, 0.5, 0.5], size: 1.5, type: car, velocity: 3}
- {k: [0.5, 0.5, 0.5], size: 1, type: unicycle, velocity: 1}
goals:
- [[-1, 0, -30], [1, 0, 34], [0, -1, -10], [0, 1, 14]]
- [[-1, 0, -5], [1, 0, 9], [0, -1, -20], [0, 1, 30]]
limits: [[0, 40], [-1, 35]]
name: two
obstacles:
- [[-1, 1, 5], [1, 1, 20], [0, -1, 0]]
starts: [[2, 20], [36, 25]]
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "problem.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_regions_become_obstacles_goals_and_limits_the_workspace(tmp_path: Path) -> None:
    scenario = import_scenario(written(tmp_path, TWO)).scenario
    assert scenario.name == "two"
    (triangle,) = scenario.obstacles
    corners = np.array(sorted(triangle.at(0)[0].vertices.tolist()))
    np.testing.assert_allclose(corners, [[-5.0, 0.0], [7.5, 12.5], [20.0, 0.0]], atol=1e-9)
    assert scenario.workspace is not None
    assert scenario.workspace.lower.tolist() == [0.0, -1.0]
    assert scenario.workspace.upper.tolist() == [40.0, 35.0]
    first, second = scenario.vehicles
    assert (first.name, second.name) == ("agent1", "agent2")
    assert first.start.tolist() == [2.0, 20.0, 0.0, 0.0]
    np.testing.assert_allclose(first.goal.center, [32.0, 12.0])


def test_size_is_the_radius_and_velocity_the_speed_limit(tmp_path: Path) -> None:
    imported = import_scenario(written(tmp_path, TWO))
    first, second = imported.scenario.vehicles
    assert (first.radius, second.radius) == (1.5, 1.0)
    assert first.speed_limit is not None
    assert first.speed_limit.tolist() == [3.0, 3.0]
    assert first.control_limit.tolist() == [6.0, 6.0]
    assert imported.choices["radius"] == "the agents' size"
    assert "car, unicycle" in imported.warnings[0]


def test_a_vehicle_ends_four_standard_deviations_within_its_region(tmp_path: Path) -> None:
    scenario = import_scenario(written(tmp_path, TWO)).scenario
    second = scenario.vehicles[1]
    sigma = np.sqrt(second.covariances(scenario.horizon)[-1, 0, 0])
    np.testing.assert_allclose(second.goal.lower, np.array([5.0, 20.0]) + 4.0 * sigma)
    np.testing.assert_allclose(second.goal.upper, np.array([9.0, 30.0]) - 4.0 * sigma)


def test_a_region_that_is_no_box_gives_the_largest_square_in_it(tmp_path: Path) -> None:
    diamond = "[[1, 1, 34], [-1, -1, -30], [1, -1, 22], [-1, 1, -18]]"
    text = TWO.replace("[[-1, 0, -30], [1, 0, 34], [0, -1, -10], [0, 1, 14]]", diamond)
    imported = import_scenario(written(tmp_path, text))
    goal, radius = imported.scenario.vehicles[0].goal, 0.5
    np.testing.assert_allclose(goal.center, [26.0, 6.0], atol=1e-6)
    assert np.all(goal.upper - goal.center <= 2.0 * radius)
    assert "largest cube" in imported.choices["goals"]


def test_a_problem_in_space_is_read(tmp_path: Path) -> None:
    text = (
        "agents: [{size: 0.5, type: auv, velocity: 1}]\n"
        "goals: [[[-1, 0, 0, 0], [1, 0, 0, 2], [0, -1, 0, -7], [0, 1, 0, 9], [0, 0, -1, -2], "
        "[0, 0, 1, 4]]]\n"
        "limits: [[-16, 16], [-10, 10], [0.5, 6]]\n"
        "obstacles: []\n"
        "starts: [[-6, -2, 3, 0.1]]\n"
    )
    scenario = import_scenario(written(tmp_path, text)).scenario
    assert scenario.name == "problem"
    assert scenario.vehicles[0].start_position.tolist() == [-6.0, -2.0, 3.0]
    np.testing.assert_allclose(scenario.vehicles[0].goal.center, [1.0, 8.0, 3.0])


def test_zigzag_is_given_time_for_its_detours_and_for_taking_turns() -> None:
    imported = import_scenario(FOLDER / "zigzag.yaml")
    scenario = imported.scenario
    assert (len(scenario.vehicles), len(scenario.obstacles)) == (4, 9)
    # 50 m at 1 m/s, and some 27 m of channel in which none passes two that come toward it.
    assert scenario.dt * scenario.horizon >= 1.5 * 80.0
    assert scenario.horizon == 30
    assert len(imported.warnings) == 1


def test_parking_leaves_no_room_for_noise_and_its_hulls_are_reduced_with_a_warning() -> None:
    imported = import_scenario(FOLDER / "parking.yaml")
    assert {v.radius for v in imported.scenario.vehicles} == {2.0}
    assert imported.warnings[1].startswith("hulls were reduced from 2.5 m to 2 m: some passage is")
    assert imported.choices["radius"].startswith("reduced from 2.5 m to 2 m")


def test_a_radius_that_is_asked_for_is_kept_and_the_import_says_which_one_would_fit() -> None:
    imported = import_scenario(FOLDER / "parking.yaml", ImportOptions(radius=2.5))
    assert {v.radius for v in imported.scenario.vehicles} == {2.5}
    assert imported.warnings[1] == (
        "between start and goal of 'agent1' a hull of 2.5 m finds no path with clearance "
        "for noise, of 2 m it might"
    )


def test_a_narrow_way_is_flown_with_less_noise_and_a_long_one_with_more_time() -> None:
    imported = import_scenario(FOLDER / "parking.yaml", ImportOptions(radius=2.0))
    scenario = imported.scenario
    # 46 m of way to the end of the upper block and back, 42 m through the lower room.
    assert scenario.dt * scenario.horizon >= 1.3 * 130.0
    finals = [np.sqrt(v.covariances(scenario.horizon)[-1, 0, 0]) for v in scenario.vehicles]
    # The passage of 5 m leaves 0.5 m on either side.
    assert 0.08 < max(finals) <= 0.5 / 4.0
    assert "the narrowest way leaves" in imported.choices["noise"]
    assert len(imported.warnings) == 1


def test_noise_that_is_asked_for_is_not_made_to_fit() -> None:
    options = ImportOptions(radius=2.0, noise=0.3)
    scenario = import_scenario(FOLDER / "parking.yaml", options).scenario
    assert scenario.vehicles[0].disturbance_covariance[0, 0] == pytest.approx(0.09)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("size: 1.5", "size: 0", r":2: agents\[0\].size: must be > 0 m, got 0"),
        ("velocity: 1}", "velocity: -1}", r":3: agents\[1\].velocity: must be > 0 m/s, got -1"),
        ("velocity: 1}", "velocity: fast}", r":3: agents\[1\].velocity: must be a number"),
        ("starts: [[2, 20], [36, 25]]", "starts: [[2, 20]]", r":11: starts: must be as many as ag"),
        ("[36, 25]", "[36]", r":11: starts\[1\]: must have at least 2 numbers, got 1"),
        ("limits: [[0, 40], [-1", "limits: [[40, 0], [-1", r":7: limits\[0\]: must be a lower"),
        ("limits: [[0, 40], ", "limits: [", r":7: limits: must be of 2 or 3 axes, got 1"),
        ("limits: [[0, 40]", "limits: [[0]", r":7: limits\[0\]: must have 2 numbers, got 1"),
        ("- [[-1, 1, 5]", "- [[1]", r":10: obstacles\[0\]: must have rows of equal length"),
        (", [1, 1, 20], [0, -1, 0]", "", r":10: obstacles\[0\]: normals and offsets must desc"),
        ("[[-1, 1, 5], [1, 1, 20], [0, -1, 0]]", "[]", r":10: obstacles\[0\]: must have rows of 3"),
        ("[-1, 0, -30], ", "", r":5: goals\[0\]: normals and offsets must describe a bounded set"),
        ("[-1, 0, -30]", "[-1, 0, -35]", r":5: goals\[0\]: normals and offsets describe an empty"),
        ("name: two", "name: 2", r":8: name: must be text, got 2"),
    ],
)
def test_a_problem_that_cannot_be_read_is_one_line(
    tmp_path: Path, old: str, new: str, line: str
) -> None:
    assert old in TWO
    with pytest.raises(FileFormatError, match=line):
        import_scenario(written(tmp_path, TWO.replace(old, new, 1)))


def test_a_problem_without_agents_is_refused(tmp_path: Path) -> None:
    text = "agents: []\nstarts: []\ngoals: []\nlimits: [[0, 1], [0, 1]]\n"
    with pytest.raises(FileFormatError, match=r":1: agents: needs at least one agent, got none"):
        import_scenario(written(tmp_path, text))


def test_where_all_stay_there_are_steps_as_long_as_in_motion(tmp_path: Path) -> None:
    """The middle of a region differs from the start by rounding alone, at 1e-7 m/s."""
    staying = TWO.replace("[[2, 20], [36, 25]]", "[[32.00000000001, 12], [7, 25.00000000001]]")
    scenario = import_scenario(written(tmp_path, staying)).scenario
    assert scenario.dt == pytest.approx(2.0)
    assert scenario.horizon == 10
