"""What benchmarks say of themselves, and of what they cannot run."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "benchmarks"
SCRIPTS = sorted(path.name for path in FOLDER.glob("*.py"))


def run(*words: str) -> subprocess.CompletedProcess[str]:
    """Run a script of the folder."""
    command = [sys.executable, str(FOLDER / words[0]), *words[1:]]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.slow
@pytest.mark.sampled(4)
@pytest.mark.parametrize("script", SCRIPTS)
def test_every_benchmark_says_what_it_measures_and_how_it_is_asked(script):
    told = run(script, "--help")
    assert (told.returncode, told.stderr) == (0, "")
    assert told.stdout.startswith(f"usage: {script}")
    said = (FOLDER / script).read_text(encoding="utf-8").removeprefix('"""').split('"""')[0]
    assert " ".join(said.split()) in " ".join(told.stdout.split())


@pytest.mark.slow
@pytest.mark.parametrize("script", ["dense.py", "assumptions.py", "noise_speed.py"])
def test_a_part_of_a_name_that_nothing_has_is_one_line(script):
    told = run(script, "--only", "zebra")
    assert told.returncode == 2
    assert "'zebra' in its name" in told.stderr
    assert told.stdout == ""
