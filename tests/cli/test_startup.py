"""What commands load before they begin, in modules: seconds depend on the machine."""

from __future__ import annotations

import functools
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from .conftest import CROSSING

# A tenth of a second and more each.
NEVER = {
    "scipy.linalg",
    "scipy.ndimage",
    "scipy.optimize",
    "scipy.sparse.csgraph",
    "scipy.sparse.linalg",
    "scipy.spatial",
    "scipy.stats",
    "matplotlib",
    "pandas",
    "PIL",
}
CORNERS = "  - {name: reef, vertices: [[4.5, 7], [5.5, 7], [5.5, 8]]}"
BENT = "  - {name: reef, vertices: [[4.5, 7], [5.5, 7], [5.5, 8], [5.2, 7.2]]}"
# What the default planner may need, but no small scenario that has a plan.
RARELY = {
    "radmpc.console.running.cluster",
    "radmpc.io.native.plan_schema",
    "radmpc.planners.certified.fallbacks",
    "radmpc.planners.certified.infeasible.explanation",
    "radmpc.planners.certified.initial_plan",
    "radmpc.planners.coarse_search",
    "radmpc.planners.policies.ira",
    "radmpc.referee.simulation",
    "radmpc.solvers.branch.tree",
}
# What vehicles need that meet, and nobody who is alone.
TOGETHER = {
    "numpy.polynomial.polynomial",
    "radmpc.planners.certified.proof.search",
    "radmpc.planners.certified.turned.turning",
    "radmpc.referee.bound.planar",
}
OTHER_PLANNERS = {
    "radmpc.planners.centralized",
    "radmpc.planners.distance",
    "radmpc.planners.paper",
    "radmpc.solvers.milp",
    "radmpc.solvers.rrt",
}
ASKS = """
import sys
from radmpc.__main__ import main
try:
    main()
finally:
    print(*sys.modules, file=sys.stderr)
"""

LOOKS = """
import gc, sys
from radmpc.__main__ import main
looks = []
gc.callbacks.append(lambda phase, found: looks.append(phase))
try:
    main()
finally:
    print(len(looks), gc.get_freeze_count() > len(gc.get_objects()), file=sys.stderr)
"""


def loaded(*words: object) -> set[str]:
    """Return the modules that a command has loaded by its end."""
    command = [sys.executable, "-c", ASKS, *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    return set(done.stderr.split())


def loaded_by(code: str) -> set[str]:
    """Return the modules that a line of Python has loaded."""
    command = [sys.executable, "-c", f"{code}; import sys; print(*sys.modules)"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    return set(done.stdout.split())


@functools.cache
def never() -> frozenset[str]:
    """Return what is never loaded, but for what SciPy loads of itself: by 1.18 linear algebra."""
    return frozenset(NEVER - loaded_by("import scipy.sparse, scipy.special"))


def write_with_rock(folder: Path, rock: str) -> Path:
    """Write the crossing with another rock."""
    path = folder / "reef.yaml"
    old = next(line for line in CROSSING.splitlines() if "rock" in line)
    path.write_text(CROSSING.replace(old, rock), encoding="utf-8")
    return path


@pytest.fixture
def with_rock(tmp_path: Path) -> Callable[[str], Path]:
    """Write the crossing with another rock."""
    return partial(write_with_rock, tmp_path)


@pytest.fixture(scope="module")
def planning(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """The modules that a small scenario is planned with."""
    return loaded("plan", write_with_rock(tmp_path_factory.mktemp("plan"), CORNERS))


def test_the_version_is_told_without_numbers_files_and_styles() -> None:
    assert loaded("--version") & {"numpy", "pydantic", "rich", "ruamel.yaml"} == set()


@pytest.mark.parametrize("rock", ["  - {name: rock, min: [4, 7], max: [5, 8]}", CORNERS])
def test_convex_obstacles_are_checked_with_numpy_alone(
    rock: str, with_rock: Callable[[str], Path]
) -> None:
    modules = loaded("check", with_rock(rock))
    assert "radmpc.io.native.scenario_file" in modules
    assert modules & (NEVER | {"scipy", "shapely", "highspy", "rich", "radmpc.planning"}) == set()


def test_only_an_obstacle_that_is_not_convex_needs_shapely(
    with_rock: Callable[[str], Path],
) -> None:
    modules = loaded("check", with_rock(BENT))
    assert "shapely" in modules
    assert modules & (NEVER | {"scipy", "highspy", "rich", "radmpc.planning"}) == set()


@pytest.mark.slow
def test_a_check_loads_scipy_only_where_something_is_near_a_start_or_a_goal(
    with_rock: Callable[[str], Path],
) -> None:
    modules = loaded("check", with_rock("  - {name: rock, min: [0.2, 5.6], max: [1.4, 6]}"))
    assert {"scipy.special", "radmpc.planners.endpoints.floors"} <= modules
    assert modules & (never() | {"highspy", "shapely", "radmpc.solvers.lp"}) == set()


@pytest.mark.slow
def test_of_scipy_only_what_small_scenarios_need_is_loaded(planning: set[str]) -> None:
    assert {"scipy.sparse", "scipy.special", "highspy"} <= planning
    assert planning & (never() | {"shapely"}) == set()


@pytest.mark.slow
def test_parts_of_numpy_that_only_scipy_names_are_not_loaded(planning: set[str]) -> None:
    assert {"numpy.f2py", "numpy.testing"} <= planning  # their names
    unused = {"numpy.f2py.crackfortran", "numpy.ma.core", "numpy.testing.overrides", "unittest"}
    assert planning & unused == set()


def test_a_part_that_waits_is_loaded_by_whoever_asks() -> None:
    asks = "from radmpc.console.running.deferring import defer; defer('json', 'tool', 'nothing'); "
    waiting = loaded_by(asks + "pass")
    assert {"json", "json.tool"} <= waiting
    assert waiting & {"argparse", "json.nothing"} == set()
    for use in (
        "import json.tool",
        "from json.tool import main",
        "json = __import__('json').tool.main",
    ):
        assert "argparse" in loaded_by(asks + use)


@pytest.mark.slow
def test_a_small_scenario_is_planned_without_other_planners_and_fallbacks(
    planning: set[str],
) -> None:
    assert "radmpc.planners.certified.certified" in planning
    assert planning & (OTHER_PLANNERS | RARELY) == set()


@pytest.mark.slow
def test_a_vehicle_that_is_alone_is_planned_without_what_those_need_that_meet(
    planning: set[str], tmp_path: Path
) -> None:
    path = tmp_path / "alone.yaml"
    alone = [line for line in CROSSING.splitlines() if "name: west" not in line]
    path.write_text("\n".join(alone), encoding="utf-8")
    modules = loaded("plan", path)
    assert planning >= TOGETHER
    assert modules & (never() | OTHER_PLANNERS | RARELY | TOGETHER) == set()


@pytest.mark.slow
def test_what_is_loaded_for_a_small_scenario_is_not_looked_through_for_garbage(
    crossing: Path,
) -> None:
    command = [sys.executable, "-c", LOOKS, "plan", str(crossing)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    # At the end, the interpreter looks through what has come since the freeze.
    assert done.stderr.split() == ["0", "True"]


@pytest.mark.slow
def test_a_preset_loads_what_its_record_is_made_of() -> None:
    asks = "import sys, radmpc.planners.presets as p; before = set(sys.modules); "
    prints = "; print(*('before:' + name for name in before))"
    of_certified = loaded_by(asks + "p.parse_planner('certified')" + prints)
    of_radmpc = loaded_by(asks + "p.parse_planner('radmpc')" + prints)
    assert "before:radmpc.planners.presets" in of_certified & of_radmpc
    assert "before:radmpc.planners.certified" not in of_certified
    assert "before:radmpc.planners.paper" not in of_radmpc
    assert "radmpc.planners.certified" in of_certified
    assert "radmpc.planners.paper" in of_radmpc
    assert OTHER_PLANNERS & of_certified == set()
    assert "radmpc.planners.certified" not in of_radmpc


@pytest.mark.slow
def test_a_plan_is_verified_without_trees_and_solvers(crossing: Path, tmp_path: Path) -> None:
    out = tmp_path / "plan.json"
    loaded("plan", crossing, "-o", out)
    modules = loaded("verify", out, "--samples", 100)
    assert "radmpc.referee" in modules
    assert modules & (never() | {"highspy", "shapely", "radmpc.solvers"}) == set()
