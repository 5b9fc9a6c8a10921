"""Noise of imported vehicles that start or end next to each other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from radmpc import ImportOptions, certify, import_scenario
from radmpc.planners.presolve import sure_reasons
from radmpc.program.build import condensed_models
from running import first_plan

RADIUS = 0.4


def spheres(
    path: Path, starts: list[tuple[float, float]], goals: list[tuple[float, float]]
) -> Path:
    """A problem of spheres in a plane without obstacles."""
    lines = ["environment:", "  min: [0, 0]", "  max: [10, 10]", "  obstacles: []", "robots:"]
    for start, goal in zip(starts, goals, strict=True):
        lines += [
            "  - type: unicycle_first_order_0_sphere",
            f"    start: [{start[0]}, {start[1]}, 0]",
            f"    goal: [{goal[0]}, {goal[1]}, 0]",
        ]
    file = path / "spheres.yaml"
    file.write_text("\n".join(lines))
    return file


def deviations(file: Path, options: ImportOptions | None = None) -> list[float]:
    """Standard deviations of the position at the start, by vehicle [m]."""
    scenario = import_scenario(file, options).scenario
    return [float(np.sqrt(v.initial_covariance[0, 0])) for v in scenario.vehicles]


@pytest.mark.parametrize("gap", [0.01, 0.02])
def test_two_that_start_side_by_side_get_noise_that_fits_between_them(
    gap: float, tmp_path: Path
) -> None:
    starts = [(2.0, 2.0), (2.0, 2.0 + 2.0 * RADIUS + gap), (8.0, 8.0)]
    file = spheres(tmp_path, starts, [(8.0, 1.0), (8.0, 5.0), (2.0, 8.0)])
    one, two, other = deviations(file)
    assert 3.9 * np.hypot(one, two) <= gap <= 4.1 * np.hypot(one, two)
    assert other > one
    imported = import_scenario(file)
    assert "less for 'robot0', 'robot1'" in imported.choices["noise"]
    result = first_plan(imported.scenario, time_limit=60.0)
    assert result.plan is not None
    assert certify(result.plan).holds


def test_two_that_end_side_by_side_get_noise_that_fits_between_their_goals(tmp_path: Path) -> None:
    goals = [(8.0, 2.0), (8.0, 2.0 + 1.7 * RADIUS)]
    file = spheres(tmp_path, [(2.0, 2.0), (2.0, 6.0)], goals)
    imported = import_scenario(file)
    assert "less for 'robot0', 'robot1'" in imported.choices["noise"]
    far = spheres(tmp_path, [(2.0, 2.0), (2.0, 6.0)], [(8.0, 2.0), (8.0, 6.0)])
    assert "less for" not in import_scenario(far).choices["noise"]


def test_many_that_start_near_each_other_get_noise_that_rules_out_no_plan(tmp_path: Path) -> None:
    # Each two next to each other are 2.6 deviations apart at first, a risk of 0.0045.
    apart = 2.0 * RADIUS + 0.042
    starts = [(1.0 + apart * i, 1.0) for i in range(8)] + [
        (1.0 + apart * i, 1.0 + apart) for i in range(8)
    ]
    goals = [(1.0 + 1.2 * i, 6.0) for i in range(8)] + [(1.0 + 1.2 * i, 9.0) for i in range(8)]
    file = spheres(tmp_path, starts, goals)
    imported = import_scenario(file)
    scenario = imported.scenario
    assert not sure_reasons(scenario, condensed_models(scenario))
    assert "less for 16 vehicles" in imported.choices["noise"]
    few = spheres(tmp_path, starts[:2], goals[:2])
    assert "less for" not in import_scenario(few).choices["noise"]


def test_noise_that_is_asked_for_is_not_made_to_fit_between_two(tmp_path: Path) -> None:
    file = spheres(tmp_path, [(2.0, 2.0), (2.0, 2.82)], [(8.0, 1.0), (8.0, 5.0)])
    assert deviations(file, ImportOptions(noise=0.05)) == pytest.approx([0.05, 0.05])
