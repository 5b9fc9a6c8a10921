"""Spoiled files of every format: an answer or a line per error, never a traceback."""

from __future__ import annotations

import os
import random
import time
from pathlib import Path

import pytest
from typer.testing import Result

from cli.conftest import Run

from .spoiling import spoiled
from .whole_files import ROOM, whole_files

WHOLE = whole_files()
# A sample; all of them with RADMPC_THOROUGH=1, as `make nightly` does.
IS_THOROUGH = bool(os.environ.get("RADMPC_THOROUGH"))
SHARES = 2
CASES = 570 if IS_THOROUGH else 40  # of each file
SLOW = 150 if IS_THOROUGH else 20  # the same where one takes long
EXPORTS = ("qgc", "waypoints", "geojson", "kml", "csv")


@pytest.mark.slow
@pytest.mark.sampled(4)
@pytest.mark.parametrize("share", range(SHARES))
@pytest.mark.parametrize("name", list(WHOLE))
def test_a_spoiled_file_is_read_or_refused_in_lines(
    run: Run, tmp_path: Path, name: str, share: int
) -> None:
    rng = random.Random(f"{name} {share}")
    num_refused = 0
    num_cases = (SLOW if name.endswith((".yaml", ".plan.json")) else CASES) // SHARES
    for _ in range(num_cases):
        (tmp_path / "room.map").write_bytes(ROOM)
        (tmp_path / "room.scen").write_bytes(WHOLE["room.scen"])
        content = spoiled(WHOLE[name], Path(name).suffix, rng)
        (tmp_path / name).write_bytes(content)
        begun = time.process_time()
        for words in commands(name, rng):
            result = run(*words)
            assert_answer_or_line(result, name, content)
            num_refused += result.exit_code == 2
        assert time.process_time() - begun < 20.0, content[:2000]
    assert num_refused > num_cases // 2


def commands(name: str, rng: random.Random) -> list[list[object]]:
    """Return what a user would do with a file."""
    if ".plan." in name:
        export = ["export", name, "--to", rng.choice(EXPORTS), "-o", "exported"]
        export += ["--origin", "54.1,12.1"] if "csv" not in export else []
        return [["verify", name, "--samples", 200], export]
    if name in {"crossing.yaml", "crossing.json", "space.json"}:
        return [["check", name]]
    return [["import", name.replace(".map", ".scen"), "-o", "imported.yaml"]]


def assert_answer_or_line(result: Result, name: str, content: bytes) -> None:
    """Check one command; a wrong answer shows what was read."""
    shown = f"{result.output[:2000]}\n{content[:4000]!r}"
    assert result.exit_code in {0, 1, 2}, shown
    assert "Traceback" not in result.output, shown
    if result.exit_code == 2:
        lines = result.stderr.splitlines()
        # One line per error, and at most eleven.
        assert 1 <= len(lines) <= 11, shown
        for line in lines:
            assert line.startswith("radmpc: "), shown
            assert line.isprintable(), shown
            assert name in line or "room." in line, shown
