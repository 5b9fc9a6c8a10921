"""Small scenarios as files, and commands run as a user would."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from radmpc.cli import app

CROSSING = """\
format: radmpc/scenario/1
name: crossing
dt: 1.0
horizon: 6
risk_bound: 0.05
avoidance: steps
obstacles:
  - {name: rock, min: [4.5, 7.0], max: [5.5, 8.0]}
defaults:
  radius: 0.4
  control_limit: 2.0
  speed_limit: 3.0
  initial_covariance: [0.001, 0.001, 0.0001, 0.0001]
  disturbance_covariance: [0.001, 0.001, 0.0001, 0.0001]
vehicles:
  - {name: east, start: [1, 5], goal: {center: [9, 5], half_width: 0.2, speed: 0.05}}
  - {name: west, start: [9, 5.2], goal: {center: [1, 5.2], half_width: 0.2, speed: 0.05}}
"""

Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run a command in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def invoke(*words: object) -> Result:
        return CliRunner().invoke(app, [str(word) for word in words])

    return invoke


@pytest.fixture
def crossing(tmp_path: Path) -> Path:
    """Two vehicles head-on past a rock: planned in a moment."""
    path = tmp_path / "crossing.yaml"
    path.write_text(CROSSING, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def crossing_plan(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """What `plan -o` writes of the crossing."""
    folder = tmp_path_factory.mktemp("crossing")
    scenario, plan = folder / "crossing.yaml", folder / "crossing.plan.json"
    scenario.write_text(CROSSING, encoding="utf-8")
    assert CliRunner().invoke(app, ["plan", str(scenario), "-o", str(plan)]).exit_code == 0
    return plan.read_bytes()


@pytest.fixture
def infeasible(tmp_path: Path) -> Path:
    """The same with too little time to get there."""
    path = tmp_path / "infeasible.yaml"
    path.write_text(CROSSING.replace("horizon: 6", "horizon: 2"), encoding="utf-8")
    return path


def assert_one_line(text: str) -> str:
    """Return the only line of stderr."""
    assert text.endswith("\n")
    lines = text.splitlines()
    assert len(lines) == 1, text
    assert lines[0].startswith("radmpc: ")
    return lines[0]
