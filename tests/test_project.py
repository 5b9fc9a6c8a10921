from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import tomllib
from collections import Counter
from functools import cache
from importlib.metadata import version
from pathlib import Path

import pytest

import radmpc
from radmpc.version import __version__

ROOT = Path(__file__).parent.parent


def tracked_files() -> list[Path]:
    """Files under version control, or all sources where there is no repository."""
    git = shutil.which("git")
    if git is None or not (ROOT / ".git").exists():
        pytest.skip("not in a repository")
    answer = subprocess.run(
        [git, "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True
    )
    return [ROOT / name for name in answer.stdout.split("\0") if name and (ROOT / name).is_file()]


def texts() -> dict[Path, str]:
    """Tracked files that hold text."""
    found = {}
    for path in tracked_files():
        if path != Path(__file__):
            content = path.read_bytes()
            if b"\0" not in content:
                found[path] = content.decode("utf-8")
    return found


def test_the_installed_version_is_that_of_the_source() -> None:
    assert version("radmpc") == __version__


def test_no_tracked_file_names_a_registry() -> None:
    option = re.compile(r"--(extra-)?index-url|--find-links|--trusted-host|^\s*registry\s*=", re.M)
    address = re.compile(r"https?://[^\s)\"'>]*(pypi|/simple\b|artifactory|nexus)", re.I)
    guilty = [
        path.relative_to(ROOT).as_posix()
        for path, text in texts().items()
        if option.search(text) or address.search(text)
    ]
    assert guilty == []


def test_no_tracked_file_names_a_path_of_one_machine() -> None:
    local = re.compile(r"(?<![\w.])/(home|root|Users|work)/")
    guilty = [p.relative_to(ROOT).as_posix() for p, text in texts().items() if local.search(text)]
    assert guilty == []


def test_every_requirement_is_pinned_exactly() -> None:
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pins = [line for line in lines if line and not line.startswith("#")]
    assert all(re.fullmatch(r"[\w.-]+==[\w.]+", pin) for pin in pins)
    names = {pin.split("==")[0].lower() for pin in pins}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = [item for group in project["optional-dependencies"].values() for item in group]
    needed = {
        re.split(r"[<>=\[ ]", item)[0].lower()
        for item in [*project["dependencies"], *extras]
        if not item.startswith("radmpc[")
    }
    assert needed - names == set()


def test_continuous_integration_runs_the_same_check() -> None:
    script = ROOT / ".ci" / "run"
    assert script.stat().st_mode & 0o111
    assert "make check" in script.read_text(encoding="utf-8")


@pytest.mark.skipif(shutil.which("make") is None, reason="needs make")
def test_what_the_check_starts_keeps_its_bytecode() -> None:
    command = ["make", "--eval", "told: ; @env", "told"]
    told = subprocess.run(
        command,
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
    )
    names = {line.partition("=")[0] for line in told.stdout.splitlines()}
    assert "OPENBLAS_NUM_THREADS" in names
    assert "PYTHONDONTWRITEBYTECODE" not in names


SOURCE_FILES = sorted((ROOT / "src" / "radmpc").rglob("*.py"))
ALL_FILES = [
    *SOURCE_FILES,
    *(path for room in ("benchmarks", "tests") for path in sorted((ROOT / room).rglob("*.py"))),
]


def test_no_file_of_the_project_has_more_than_three_hundred_lines() -> None:
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in ALL_FILES}
    assert len(lengths) > 500
    assert [str(path.relative_to(ROOT)) for path, count in lengths.items() if count > 300] == []


def test_no_folder_of_the_project_has_more_than_twenty_files() -> None:
    counts = Counter(path.parent for path in ALL_FILES if path.name != "__init__.py")
    assert [str(path.relative_to(ROOT)) for path, count in counts.items() if count > 20] == []


@cache
def tree_of(path: Path) -> ast.Module:
    """Return what a file says, parsed once for all tests."""
    return ast.parse(path.read_text(encoding="utf-8"))


def test_no_function_of_the_package_has_more_than_forty_lines_beside_its_docstring() -> None:
    long = [
        f"{path.relative_to(ROOT)}: {node.name}"
        for path in SOURCE_FILES
        for node in ast.walk(tree_of(path))
        if isinstance(node, ast.FunctionDef) and num_lines(node) > 40
    ]
    assert long == []


def num_lines(function: ast.FunctionDef) -> int:
    """Lines of a function's body, its docstring left out."""
    first = function.body[0]
    told = first.end_lineno - first.lineno + 1 if ast.get_docstring(function) else 0
    return function.end_lineno - first.lineno + 1 - told


NAMESAKES = {"Track": "planners/certified/turned/narrow/track.py"}
"""Classes of the name of a public one, where they never meet it: places along one path."""


def classes() -> list[tuple[str, str]]:
    """Return the names of all public classes of the package's files, each with its file."""
    found = []
    for path in SOURCE_FILES:
        for node in tree_of(path).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                found.append((node.name, path.relative_to(ROOT / "src" / "radmpc").as_posix()))
    return found


def test_a_name_of_the_public_interface_is_that_of_one_class_alone() -> None:
    public = set(radmpc.__all__)
    others = [(n, path) for n, path in classes() if NAMESAKES.get(n) != path and n in public]
    assert [n for n, count in Counter(n for n, _ in others).items() if count > 1] == []


def test_no_package_has_two_classes_of_one_name() -> None:
    # Each engine has its tuned constants, and reads no others'.
    names = Counter((n, path.split("/")[0]) for n, path in classes() if n != "Tuning")
    assert [who for who, count in names.items() if count > 1] == []
