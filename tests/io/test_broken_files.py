"""One broken file per error; ``expected.txt`` holds the line that each must lead to."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from radmpc.errors import FileFormatError
from radmpc.experiments.families import circle
from radmpc.io.native.mapping import to_dict
from radmpc.io.native.scenario_file import load_scenario

FOLDER = Path(__file__).parent.parent / "data" / "broken"
EXPECTED = (FOLDER / "expected.txt").read_text(encoding="utf-8").splitlines()


@pytest.mark.parametrize("line", EXPECTED, ids=lambda line: line.partition(":")[0])
def test_a_broken_file_leads_to_its_line(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(FOLDER)
    with pytest.raises(FileFormatError) as caught:
        load_scenario(line.partition(":")[0])
    assert str(caught.value) == line


def test_every_broken_file_has_an_expected_line() -> None:
    listed = [line.partition(":")[0] for line in EXPECTED]
    assert sorted(listed) == sorted(
        path.name for path in FOLDER.iterdir() if path.name != "expected.txt"
    )
    assert len(listed) == len(set(listed))


@pytest.mark.parametrize("letter", ["\x1b", "\n", "\x00", "\x9b"])
def test_names_that_would_command_a_terminal_are_refused(tmp_path: Path, letter: str) -> None:
    path = tmp_path / "odd.json"
    data = to_dict(circle(3))
    data["vehicles"][0]["name"] = f"tug{letter}[2J"  # type: ignore[index] # of any kind in JSON
    path.write_text(json.dumps(data))
    with pytest.raises(FileFormatError, match=r"vehicles\[0\].name: must not hold control ch"):
        load_scenario(path)
