from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from comparing import differences
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.importing.dynobench import import_dynobench
from radmpc.importing.formats import ImportOptions, import_scenario
from radmpc.importing.problem import ForeignVehicle
from radmpc.io.native.scenario_file import load_scenario, save_scenario
from radmpc.model.plan import Status
from radmpc.planning import plan

FOLDER = Path(__file__).parent.parent.parent / "instances" / "db-CBS"
PUBLISHED = sorted(FOLDER.glob("*.yaml"))

TWO = """\
environment:
  min: [0, 0]
  max: [5, 5]
  obstacles:
    - {type: box, center: [2, 2], size: [1, 0.5]}
robots:
  - {type: double_integrator_0, start: [1, 1, 0, 0], goal: [4, 1, 0, 0]}
  - {type: double_integrator_0, start: [4, 4, 0, 0], goal: [1, 4, 0, 0]}
"""


@pytest.fixture
def problem(tmp_path: Path) -> Path:
    return written(tmp_path, TWO)


def written(folder: Path, text: str) -> Path:
    path = folder / "problem.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def flight(distance: float, before: float = 0.0, after: float = 0.0) -> float:
    """Least time of a vehicle with |v| <= 0.5, |a| <= 2 along one axis."""
    return ForeignVehicle(
        "v",
        np.array([0.0, 0.0]),
        np.array([distance, 0.0]),
        np.array([before, 0.0]),
        np.array([after, 0.0]),
        0.1,
        0.5,
        2.0,
    ).minimum_time()


@pytest.mark.parametrize("path", PUBLISHED, ids=lambda path: path.stem)
def test_every_published_problem_gets_steps_and_noise_as_documented(path: Path) -> None:
    imported = import_scenario(path)
    scenario = imported.scenario
    assert scenario.name == path.stem
    assert 10 <= scenario.horizon <= 30
    assert (scenario.risk_bound, scenario.avoidance) == (0.05, "intervals")
    for vehicle in scenario.vehicles:
        assert np.linalg.eigvalsh(vehicle.disturbance_covariance).min() > 0.0
        final = math.sqrt(vehicle.covariances(scenario.horizon)[-1, 0, 0])
        assert 0.2 * vehicle.radius <= final <= 0.21 * vehicle.radius
        assert vehicle.control_bounds(vehicle.covariances(scenario.horizon)).min() >= 1.5
        assert scenario.horizon * scenario.dt >= 1.5 * max(
            flight(d) for d in vehicle.goal.center - vehicle.start_position
        )


@pytest.mark.sampled(3)
@pytest.mark.parametrize("path", PUBLISHED, ids=lambda path: path.stem)
def test_an_imported_scenario_survives_a_file_with_its_choices(path: Path, tmp_path: Path) -> None:
    imported = import_scenario(path)
    save_scenario(imported.scenario, tmp_path / "scenario.yaml")
    loaded = load_scenario(tmp_path / "scenario.yaml")
    assert differences(loaded, imported.scenario) == []
    assert loaded.source == {
        "format": "dynobench",
        "file": path.name,
        "choices": imported.choices,
        "warnings": list(imported.warnings),
    }


def test_boxes_bounds_and_states_are_carried_over(problem: Path) -> None:
    scenario = import_scenario(problem).scenario
    (box,) = scenario.obstacles
    assert box.at(0)[0].vertices.min(axis=0).tolist() == [1.5, 1.75]
    assert box.at(0)[0].vertices.max(axis=0).tolist() == [2.5, 2.25]
    assert scenario.workspace is not None
    assert scenario.workspace.upper.tolist() == [5.0, 5.0]
    first, second = scenario.vehicles
    assert first.start.tolist() == [1.0, 1.0, 0.0, 0.0]
    np.testing.assert_allclose(second.goal.center, [1.0, 4.0])
    assert first.speed_limit is not None
    assert (first.speed_limit.tolist(), first.control_limit.tolist()) == ([0.5, 0.5], [2.0, 2.0])


def test_the_radius_chosen_is_stated_with_its_reason(problem: Path) -> None:
    imported = import_scenario(problem)
    assert {vehicle.radius for vehicle in imported.scenario.vehicles} == {0.1}
    assert "0.1 m, from dynobench's models" in imported.choices["radius"]
    assert "0.15 m" in imported.choices["radius"]


def test_other_robots_are_flown_as_double_integrators_with_a_warning() -> None:
    imported = import_scenario(FOLDER / "gen_p10_n4_1_hetero.yaml")
    trailer = "car_first_order_with_1_trailers_0"
    assert imported.warnings == (
        f"flown as double integrators from their positions: {trailer}",
        "shapes replaced by discs of 0.1 m radius, which do not cover their boxes of 0.5 x 0.25 m "
        "and the trailers behind them at any angle (--radius 0.662 does): plans may let the "
        f"published hulls collide: {trailer}",
    )
    radii = [vehicle.radius for vehicle in imported.scenario.vehicles]
    assert radii == [0.1] * 4
    assert imported.scenario.vehicles[2].start.tolist() == [
        0.8592869189015326,
        1.7798579353275303,
        0.0,
        0.0,
    ]


def test_a_disc_keeps_its_own_radius() -> None:
    scenario = import_scenario(FOLDER / "makespan_vs_soc_0.yaml").scenario
    assert [vehicle.radius for vehicle in scenario.vehicles] == [0.4, 0.4]


@pytest.mark.parametrize(
    ("distance", "before", "after", "seconds"),
    [
        (3.0, 0.0, 0.0, 6.25),
        (-3.0, 0.0, 0.0, 6.25),
        (0.02, 0.0, 0.0, 0.2),
        (1.0, 0.5, 0.5, 2.0),
        (0.0625, 0.5, 0.0, 0.25),
        (0.0, 0.5, 0.0, 0.25 + 2.0 * math.sqrt(0.0625 / 2.0)),
        (0.0, 0.0, 0.0, 0.0),
    ],
)
def test_the_minimum_time_is_that_of_accelerating_coasting_and_braking(
    distance: float, before: float, after: float, seconds: float
) -> None:
    assert flight(distance, before, after) == pytest.approx(seconds)


def test_options_win_over_choices(problem: Path) -> None:
    options = ImportOptions(
        dt=1.0, horizon=12, noise=0.01, risk_bound=0.1, radius=0.2, avoidance="steps"
    )
    imported = import_scenario(problem, options)
    scenario = imported.scenario
    assert (scenario.dt, scenario.horizon, scenario.risk_bound) == (1.0, 12, 0.1)
    assert scenario.avoidance == "steps"
    for vehicle in scenario.vehicles:
        assert vehicle.radius == 0.2
        np.testing.assert_allclose(
            np.diag(vehicle.disturbance_covariance), [1e-4, 1e-4, 1e-5, 1e-5]
        )
    for name in ("dt", "horizon", "noise", "risk bound", "radius"):
        assert "as asked" in imported.choices[name]


def test_a_given_dt_leads_to_as_many_steps_as_the_time_needs(problem: Path) -> None:
    scenario = import_scenario(problem, ImportOptions(dt=0.25)).scenario
    assert scenario.horizon == math.ceil(1.5 * 6.25 / 0.25)


def test_a_given_horizon_leads_to_the_dt_that_fills_the_time(problem: Path) -> None:
    scenario = import_scenario(problem, ImportOptions(horizon=10)).scenario
    assert scenario.dt == 0.94
    assert all(vehicle.gain is None for vehicle in scenario.vehicles)


def test_a_time_too_short_is_a_warning(problem: Path) -> None:
    imported = import_scenario(problem, ImportOptions(dt=0.5, horizon=10))
    assert imported.warnings == ("5 s are too short: a vehicle needs at least 6.25 s",)


def test_feedback_is_left_out_where_it_would_eat_the_control_limit(problem: Path) -> None:
    imported = import_scenario(problem, ImportOptions(noise=1.0, horizon=24))
    assert all(vehicle.gain is None for vehicle in imported.scenario.vehicles)
    assert imported.choices["feedback"].startswith("none: it would need more")


def test_starts_at_the_border_move_the_workspace_out(tmp_path: Path) -> None:
    imported = import_scenario(written(tmp_path, TWO.replace("[0, 0]\n", "[0.98, 0]\n")))
    scenario = imported.scenario
    assert scenario.workspace is not None
    sigma = math.sqrt(scenario.vehicles[0].covariances(scenario.horizon)[-1, 0, 0])
    np.testing.assert_allclose(scenario.workspace.lower, [1.0 - 4.0 * sigma, 0.0])
    (warning,) = imported.warnings
    assert "the workspace was moved out by up to" in warning


def test_vehicles_that_are_there_already_still_get_steps(tmp_path: Path) -> None:
    text = TWO.replace("goal: [4, 1,", "goal: [1, 1,").replace("goal: [1, 4,", "goal: [4, 4,")
    scenario = import_scenario(written(tmp_path, text)).scenario
    assert (scenario.horizon, scenario.dt) == (10, 0.8)


def test_a_problem_in_space_is_read(tmp_path: Path) -> None:
    text = (
        "environment: {min: [0, 0, 0], max: [5, 5, 5]}\n"
        "robots:\n  - {type: quad3d, start: [1, 1, 1, 7, 8], goal: [4, 4, 4, 9]}\n"
    )
    scenario = import_scenario(written(tmp_path, text)).scenario
    assert scenario.vehicles[0].start.tolist() == [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]
    assert scenario.obstacles == ()


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("type: box", "type: octomap", r":5: environment.obstacles\[0\].type: must be 'box'"),
        ("type: box,", "type: box, yaw: 1,", r":5: environment.obstacles\[0\].yaw: unknown key"),
        ("size: [1, 0.5]", "size: [1]", r":5: environment.obstacles\[0\].size: must have 2 num"),
        ("size: [1, 0.5]", "size: [1, 0]", r":5: environment.obstacles\[0\].size: must be > 0 m"),
        ("min: [0, 0]", "min: [9, 9]", r":1: environment: min must be below max"),
        ("min: [0, 0]", "min: [0]", r":2: environment.min: must have 2 or 3 coordinates, got 1"),
        ("start: [1, 1, 0, 0]", "start: [1, 1]", r":7: robots\[0\].start: must have at least 4"),
        ("start: [1, 1, 0, 0]", "start: [1, x]", r":7: robots\[0\].start\[1\]: must be a number"),
        ("{type: double_integrator_0, start: [1", "{start: [1", r":7: robots\[0\].type: is requ"),
    ],
)
def test_a_problem_that_cannot_be_read_is_one_line(
    tmp_path: Path, old: str, new: str, line: str
) -> None:
    path = written(tmp_path, TWO.replace(old, new, 1))
    with pytest.raises(FileFormatError, match=line):
        import_scenario(path)
    with pytest.raises(FileFormatError, match=line):
        import_dynobench(path)


def test_a_problem_without_robots_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, "environment: {min: [0, 0], max: [1, 1]}\nrobots: []\n")
    with pytest.raises(FileFormatError, match=r":2: robots: needs at least one robot, got none"):
        import_scenario(path)


def test_an_unknown_format_is_refused_with_the_known_ones(tmp_path: Path) -> None:
    known = r"is of no format known here \(dynobench, LSC, s2m2, libMultiRobot.*, GeoJSON, KML\)$"
    with pytest.raises(FileFormatError, match=known):
        import_scenario(written(tmp_path, "map: {}\nagents: []\n"))
    with pytest.raises(FileFormatError, match=r"problem.yaml:1: must be a mapping, got 7$"):
        import_dynobench(written(tmp_path, "7"))


def test_a_scenario_of_our_own_needs_no_import(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"is a scenario already"):
        import_scenario(written(tmp_path, "format: radmpc/scenario/1\n"))


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ({"dt": 0.0}, r"dt: must be > 0 s, got 0.0"),
        ({"noise": 0.0}, r"noise: must be > 0 m, got 0.0"),
        ({"radius": float("nan")}, r"radius: must be > 0 m, got nan"),
        ({"horizon": 0}, r"horizon: must be 1 to 1000 steps, got 0"),
        ({"risk_bound": 0.5}, r"risk_bound: must lie between 0 and 0.5"),
        ({"avoidance": "never"}, r"avoidance: must be 'steps' or 'intervals', got 'never'"),
    ],
)
def test_options_that_no_scenario_can_have_are_refused(
    options: dict[str, object], line: str
) -> None:
    with pytest.raises(ScenarioError, match=line):
        ImportOptions(**options)


@pytest.mark.slow
def test_two_that_swap_places_get_a_certified_plan() -> None:
    result = plan(import_scenario(FOLDER / "swap2_double_integrator.yaml").scenario)
    assert result.certificate is not None
    assert result.certificate.certified <= 0.05


def test_two_with_one_goal_are_imported_and_found_infeasible() -> None:
    result = plan(import_scenario(FOLDER / "infeasible_0.yaml").scenario)
    assert result.status is Status.INFEASIBLE
    assert result.explanation is not None
    assert "robot0" in result.explanation
    assert "robot1" in result.explanation
