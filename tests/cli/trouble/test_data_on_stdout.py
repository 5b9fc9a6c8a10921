"""Where stdout is what is written to, nothing but data goes there: reports go to stderr."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.fixture
def folder(crossing: Path, crossing_plan: bytes) -> Path:
    """A folder with a scenario and its plan."""
    (crossing.parent / "plan.json").write_bytes(crossing_plan)
    return crossing.parent


def piped(folder: Path, *words: object) -> subprocess.CompletedProcess[bytes]:
    """Run a command whose stdout is a pipe."""
    command = [sys.executable, "-m", "radmpc", *(str(word) for word in words)]
    result = subprocess.run(command, cwd=folder, capture_output=True, check=False)
    assert result.returncode == 0, result.stderr.decode()
    return result


@pytest.mark.sampled(2)
@pytest.mark.parametrize("to", ["csv", "geojson", "kml"])
def test_an_export_on_stdout_is_what_it_is_in_a_file(folder: Path, to: str) -> None:
    words = () if to == "csv" else ("--origin", "54.1,12.1")
    filed = piped(folder, "export", "plan.json", "--to", to, "-o", "file", *words)
    assert filed.stdout == b"plan written to file\n"
    assert filed.stderr == b""
    result = piped(folder, "export", "plan.json", "--to", to, "-o", "/dev/stdout", *words)
    assert result.stdout == (folder / "file").read_bytes()
    assert result.stderr == b"plan written to /dev/stdout\n"


def test_a_picture_on_stdout_is_a_picture(folder: Path) -> None:
    (folder / "picture.svg").symlink_to("/dev/stdout")
    result = piped(folder, "draw", "plan.json", "-o", "picture.svg")
    assert result.stdout.startswith(b"<?xml")
    assert result.stdout.rstrip().endswith(b"</svg>")
    assert result.stderr == b"picture written to picture.svg\n"


def test_a_plan_on_stdout_is_its_file_and_the_report_stands_on_stderr(folder: Path) -> None:
    result = piped(folder, "plan", "crossing.yaml", "-o", "/dev/stdout")
    assert json.loads(result.stdout)["format"] == "radmpc/plan/1"
    assert b"plan written to /dev/stdout" in result.stderr


def test_what_goes_nowhere_or_into_a_file_is_reported_on_stdout(folder: Path) -> None:
    result = piped(folder, "export", "plan.json", "--to", "csv", "-o", "/dev/null")
    assert result.stdout == b"plan written to /dev/null\n"
    with (folder / "kept.csv").open("wb") as file:
        command = [sys.executable, "-m", "radmpc", "export", "plan.json", "--to", "csv"]
        subprocess.run([*command, "-o", "/dev/stdout"], cwd=folder, stdout=file, check=True)
    assert b"written to" not in (folder / "kept.csv").read_bytes()


def test_a_sweep_on_stdout_is_its_table_and_the_report_stands_on_stderr(folder: Path) -> None:
    words = ("sweep", "crossing.yaml", "--over", "risk_bound=0.02,0.05", "--planner", "distance")
    filed = piped(folder, *words, "-o", "table.csv")
    result = piped(folder, *words, "-o", "/dev/stdout")
    [header, *rows] = csv.reader(result.stdout.decode().splitlines())
    [known, *others] = csv.reader((folder / "table.csv").read_text(encoding="utf-8").splitlines())
    assert header == known
    assert len(rows) == 2
    for row, other in zip(rows, others, strict=True):
        timed = header.index("seconds")
        assert [*row[:timed], *row[timed + 1 :]] == [*other[:timed], *other[timed + 1 :]]
    assert b"table written to table.csv" in filed.stdout
    assert b"table written to /dev/stdout" in result.stderr


def test_a_sweep_that_goes_nowhere_is_reported(folder: Path) -> None:
    words = ("sweep", "crossing.yaml", "--over", "risk_bound=0.05", "--planner", "distance")
    result = piped(folder, *words, "-o", "/dev/null")
    assert b"table written to /dev/null" in result.stdout
    assert Path("/dev/null").is_char_device()
