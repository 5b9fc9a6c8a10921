from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from radmpc.errors import FileFormatError
from radmpc.importing.formats import ImportOptions, import_scenario

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


def written(folder: Path, text: str) -> Path:
    path = folder / "problem.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def typed(kind: str) -> str:
    """Two robots of a type."""
    return TWO.replace("double_integrator_0", kind)


def corners(center: tuple[float, float], angle: float, size: tuple[float, float]) -> np.ndarray:
    """Of a box, turned."""
    c, s = math.cos(angle), math.sin(angle)
    half = 0.5 * np.array(size) * np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]])
    return np.array(center) + half @ np.array([[c, s], [-s, c]])


@pytest.mark.parametrize(
    "kind",
    [
        "unicycle_first_order",
        "unicycle_first_order_0",
        "unicycle_second_order_0",
        "unicycle1_v2",
        "unicycle2_v0",
        "car_first_order_0",
        "car_first_order_with_1_trailers_0",
        "car1_v0",
    ],
)
def test_the_radius_that_is_told_covers_the_published_hull_at_any_angle(
    tmp_path: Path, kind: str
) -> None:
    imported = import_scenario(written(tmp_path, typed(kind)))
    assert imported.scenario.vehicles[0].radius == 0.1
    told = re.search(
        r"discs of 0.1 m radius, which do not cover .*--radius ([\d.]+) does", imported.warnings[1]
    )
    assert told is not None
    radius = float(told[1])
    reach = np.linalg.norm(corners((0.0, 0.0), 0.3, (0.5, 0.25)), axis=1).max()
    if "trailers" in kind or kind == "car1_v0":
        for angle in np.linspace(0.0, 6.0, 50):
            behind = (-0.5 * math.cos(angle), -0.5 * math.sin(angle))
            trailer = np.linalg.norm(corners(behind, angle, (0.3, 0.25)), axis=1).max()
            reach = max(reach, trailer)
    assert reach <= radius <= reach + 1e-3
    assert imported.choices["radius"] == (
        "0.1 m, that of double integrators, in place of other hulls"
    )


@pytest.mark.parametrize("kind", ["single_integrator_0", "integrator1_2d_v0"])
def test_a_published_disc_is_replaced_by_none(tmp_path: Path, kind: str) -> None:
    imported = import_scenario(written(tmp_path, typed(kind)))
    assert imported.warnings == (f"flown as double integrators from their positions: {kind}",)
    assert imported.scenario.vehicles[0].radius == 0.1


@pytest.mark.parametrize("kind", ["double_integrator_0", "integrator2_2d_v0", "Integrator2_2d_v0"])
def test_a_double_integrator_keeps_its_velocities_whatever_it_is_called(
    tmp_path: Path, kind: str
) -> None:
    text = typed(kind).replace("start: [1, 1, 0, 0]", "start: [1, 1, 0.4, -0.1]")
    imported = import_scenario(written(tmp_path, text))
    assert imported.warnings == ()
    assert imported.scenario.vehicles[0].start.tolist() == [1, 1, 0.4, -0.1]
    assert imported.scenario.vehicles[0].radius == 0.1


def test_a_radius_that_does_not_cover_the_published_hull_is_warned_of(tmp_path: Path) -> None:
    problem = written(tmp_path, typed("unicycle_first_order_0"))
    imported = import_scenario(problem, ImportOptions(radius=0.1))
    assert imported.choices["radius"] == "0.1 m, as asked"
    assert imported.warnings[1] == (
        "shapes replaced by discs of 0.1 m radius, as asked, which do not cover their boxes of "
        "0.5 x 0.25 m (--radius 0.2796 does): plans may let the published hulls collide: "
        "unicycle_first_order_0"
    )
    assert len(import_scenario(problem, ImportOptions(radius=0.3)).warnings) == 1


def test_a_hull_that_is_not_known_is_called_a_guess(tmp_path: Path) -> None:
    imported = import_scenario(written(tmp_path, typed("hovercraft")))
    assert imported.warnings[1] == (
        "shapes replaced by discs of 0.1 m radius, a guess, their models are not known here "
        "(--radius states theirs): hovercraft"
    )
    assert imported.choices["radius"] == (
        "0.1 m, that of double integrators, in place of other hulls"
    )


def test_a_velocity_at_a_goal_is_a_limit_of_speed_and_says_so(tmp_path: Path) -> None:
    text = TWO.replace("goal: [4, 1, 0, 0]", "goal: [4, 1, 0.3, -0.2]")
    imported = import_scenario(written(tmp_path, text))
    speed = imported.scenario.vehicles[0].goal.speed
    assert speed is not None
    assert speed.tolist() == [0.3, 0.2]
    assert imported.warnings == (
        "velocities at the goals of 'robot0' became limits of speed per axis, without their "
        "signs: plans may end slower, or the other way",
    )


def test_an_octomap_is_refused_in_one_line_that_names_its_type(tmp_path: Path) -> None:
    box = "{type: box, center: [2, 2], size: [1, 0.5]}"
    text = TWO.replace(box, "{type: octomap, octomap_file: a.bt}")
    with pytest.raises(
        FileFormatError, match=r":5: .*\.type: must be 'box', got 'octomap'$"
    ) as told:
        import_scenario(written(tmp_path, text))
    assert not getattr(told.value, "__notes__", [])


def test_robots_of_several_types_get_one_warning_of_how_they_are_flown(tmp_path: Path) -> None:
    text = TWO.replace("double_integrator_0", "car_first_order_0", 1)
    text = text.replace("double_integrator_0", "unicycle_first_order_0", 1)
    assert import_scenario(written(tmp_path, text)).warnings == (
        "flown as double integrators from their positions: car_first_order_0, "
        "unicycle_first_order_0",
        "shapes replaced by discs of 0.1 m radius, which do not cover their boxes of 0.5 x 0.25 m "
        "(--radius 0.2796 does): plans may let the published hulls collide: "
        "car_first_order_0, unicycle_first_order_0",
    )
