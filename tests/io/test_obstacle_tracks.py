"""Tracks of obstacles in files: three descriptions, what is refused, and the way back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ruamel.yaml import YAML

import radmpc
from radmpc.errors import ScenarioError
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario

DECK = [[-40.0, -6.0], [40.0, -6.0], [40.0, 6.0], [-40.0, 6.0]]
REPORT = {"position": [120.0, 300.0], "speed": 5.1, "course": 265.0}


def content(moving: object) -> dict[str, Any]:
    vehicle = {
        "name": "a",
        "start": [0.0, 0.0],
        "goal": {"center": [90.0, 0.0], "half_width": 5.0},
        "radius": 2.0,
        "control_limit": 1.0,
    }
    return {
        "format": "radmpc/scenario/1",
        "name": "strait",
        "dt": 5.0,
        "horizon": 4,
        "risk_bound": 0.05,
        "obstacles": [{"name": "freighter", "moving": moving}],
        "vehicles": [vehicle],
    }


def read(moving: object) -> Scenario:
    found = radmpc.from_dict(content(moving))
    assert isinstance(found, Scenario)
    return found


def refusal(moving: object) -> str:
    with pytest.raises(ScenarioError) as caught:
        read(moving)
    return str(caught.value)


def test_a_start_places_the_outline_and_moves_it_along():
    start, covariance = [100.0, 50.0, -2.0, 1.0], [4.0, 4.0, 0.01, 0.04]
    scenario = read({"outline": DECK, "start": start, "covariance": covariance})
    [freighter] = scenario.obstacles
    for k in range(5):
        corners = np.add(DECK, [100.0 - 10.0 * k, 50.0 + 5.0 * k])
        [piece] = freighter.at(k)
        np.testing.assert_allclose(sorted(piece.vertices.tolist()), sorted(corners.tolist()))
    variances = [np.diag(c) for c in freighter.spread.positions]
    expected = [[4.0 + 0.01 * (5 * k) ** 2, 4.0 + 0.04 * (5 * k) ** 2] for k in range(5)]
    np.testing.assert_allclose(variances, expected)


def test_a_velocity_moves_an_outline_from_where_it_is():
    [freighter] = read({"outline": DECK, "velocity": [1.0, 0.5]}).obstacles
    assert freighter.spread is None
    np.testing.assert_allclose(freighter.at(2)[0].vertices.mean(axis=0), [10.0, 5.0])


def test_a_report_is_what_the_helper_makes_of_it():
    deviations = {"position": [5.0, 3.0], "speed": 0.2, "course": 2.0}
    [freighter] = read({"outline": DECK, **REPORT, "deviations": deviations}).obstacles
    start, covariance = radmpc.track_from_course(
        *REPORT.values(), position_deviation=[5.0, 3.0], speed_deviation=0.2, course_deviation=2.0
    )
    np.testing.assert_array_equal(freighter.shape.start, start)
    np.testing.assert_array_equal(freighter.shape.covariance, covariance)


@pytest.mark.parametrize(
    "moving",
    [
        {"outline": DECK, **REPORT, "deviations": {"course": 1.5}},
        {"outline": DECK, "velocity": [1.0, -0.1]},
        {"outline": DECK[:2], "start": [1.0, 2.0, 0.1, 0.0], "disturbance_covariance": 0.01},
        {"outline": DECK, "start": [1, 2, 0.1, 0], "covariance": np.diag([4, 3, 2, 1]).tolist()},
    ],
)
def test_what_is_written_reads_back_equal(moving, tmp_path: Path):
    scenario = read(moving)
    for name in ("strait.yaml", "strait.json"):
        radmpc.save_scenario(scenario, tmp_path / name)
        again = radmpc.load_scenario(tmp_path / name)
        assert radmpc.to_dict(again) == radmpc.to_dict(scenario)
        one, two = scenario.obstacles[0], again.obstacles[0]
        assert [p.vertices.tolist() for (p,) in one.steps] == [
            p.vertices.tolist() for (p,) in two.steps
        ]
        assert (one.spread is None) == (two.spread is None)
        if one.spread is not None:
            np.testing.assert_array_equal(one.spread.positions, two.spread.positions)


@pytest.mark.parametrize(
    ("moving", "message"),
    [
        (
            {"outline": DECK},
            "moving: needs exactly one of: start, velocity, position and speed and",
        ),
        ({"outline": DECK, "start": [0] * 4, "velocity": [0, 0]}, "got start and velocity"),
        ({"outline": DECK, "position": [0, 0]}, "got position"),
        ({"outline": DECK, "start": [0, 0, 0]}, "moving.start: must have 4 numbers"),
        (
            {"outline": DECK, "velocity": [1]},
            "moving.velocity: must have 2 numbers like the corners of outline, got 1",
        ),
        (
            {"outline": [[0, 0, 0]], **REPORT},
            "moving.position: is in the plane, got an outline whose corners have 3 coordinates",
        ),
        ({"outline": [], "start": [0] * 4}, "moving.outline: "),
        ({"start": [0] * 4}, "moving.outline: is required"),
        ({"outlines": DECK, "start": [0] * 4}, "unknown key, did you mean 'outline'?"),
        (
            {"outline": DECK, "start": [0] * 4, "covariance": -1.0},
            "moving.covariance: must be posi",
        ),
        ({"outline": DECK, "start": "here"}, "moving.start: must be a list"),
        ({"outline": DECK, **REPORT, "covariance": 1.0}, "moving.covariance: needs start"),
        (
            {"outline": DECK, "start": [0] * 4, "deviations": {}},
            "moving.deviations: needs position",
        ),
        ({"outline": DECK, **REPORT, "speed": -1.0}, "moving.speed: must be >= 0 m/s"),
        (
            {"outline": DECK, **REPORT, "course": 465},
            "moving.course: must be from -180 to below 360 degrees, got 465",
        ),
        (
            {"outline": DECK, **REPORT, "position": [0, 0, 0]},
            "moving.position: must have 2 numbers",
        ),
        (
            {"outline": DECK, **REPORT, "deviations": {"course": 25.0}},
            "moving.deviations.course: must be at most 20 degrees",
        ),
        (
            {"outline": DECK, **REPORT, "deviations": {"heading": 2.0}},
            "moving.deviations.heading: unknown key",
        ),
        ({"outline": [[0, 0, 0]], "start": [0] * 6}, "must be 2-D like the vehicles, got 3-D"),
        (7, "moving: must be a list, got 7"),
    ],
)
def test_what_does_not_fit_is_told_in_one_line(moving, message):
    found = refusal(moving)
    assert found.startswith("obstacles[0]")
    assert message in found
    assert "\n" not in found


def test_outlines_step_by_step_stay_what_they_were():
    [ship] = read([np.add(DECK, [k, 0.0]).tolist() for k in range(5)]).obstacles
    assert ship.spread is None
    assert "must have 5 outlines" in refusal([DECK] * 4)


def test_a_track_of_a_plan_survives_its_file(tmp_path: Path):
    track = Obstacle.tracked("f", DECK, [500.0, 400.0, -1.0, 0.0], [9.0, 9.0, 0.01, 0.01])
    base = read({"outline": DECK, "velocity": [0.0, 0.0]})
    scenario = Scenario("s", 5.0, 4, 0.05, base.vehicles, [track])
    plan = radmpc.plan(scenario, "ira", rng=0).record
    radmpc.save_plan(plan, tmp_path / "s.plan.json")
    assert radmpc.to_dict(radmpc.load_plan(tmp_path / "s.plan.json")) == radmpc.to_dict(plan)


def test_the_freighter_of_the_page_is_read():
    page = (Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")
    block = page.split("**Tracks.**")[1].split("```yaml\n")[1].split("```")[0]
    [freighter] = YAML(typ="safe").load(block)["obstacles"]
    found = read(freighter["moving"]).obstacles[0]
    assert found.spread is not None
    # Course 265 degrees: west, a little south; of a course uncertain by 1 degree a little slower.
    mean = 5.1 * np.exp(-0.5 * np.radians(1.0) ** 2)
    assert found.shape.start[2] == pytest.approx(-mean * np.cos(np.radians(5.0)))
    assert found.shape.start[3] == pytest.approx(-mean * np.sin(np.radians(5.0)))
