"""What commands load before they begin, in modules: seconds depend on the machine."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from .conftest import CROSSING

# A quarter of a second and more each.
NEVER = {"scipy.optimize", "scipy.stats", "scipy.ndimage", "matplotlib", "pandas", "PIL"}
CORNERS = "  - {name: reef, vertices: [[4.5, 7], [5.5, 7], [5.5, 8]]}"
ASKS = """
import sys
from radmpc.cli import app
try:
    app(sys.argv[1:])
finally:
    print(*sys.modules, file=sys.stderr)
"""


def loaded(*words: object) -> set[str]:
    """Return the modules that a command has loaded by its end."""
    command = [sys.executable, "-c", ASKS, *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    return set(done.stderr.split())


def test_a_file_of_boxes_is_checked_without_scipy_and_solvers(crossing: Path) -> None:
    modules = loaded("check", crossing)
    assert "radmpc.io.native.scenario_file" in modules
    assert modules & (NEVER | {"scipy", "highspy", "radmpc.planning"}) == set()


@pytest.mark.slow
@pytest.mark.parametrize("command", ["check", "plan"])
def test_of_scipy_only_what_small_scenarios_need_is_loaded(command: str, tmp_path: Path) -> None:
    path = tmp_path / "reef.yaml"
    rock = next(line for line in CROSSING.splitlines() if "rock" in line)
    path.write_text(CROSSING.replace(rock, CORNERS), encoding="utf-8")
    modules = loaded(command, path)
    assert "scipy.spatial" in modules
    assert modules & NEVER == set()
