"""What matplotlib warns of while a command draws is told in a sentence."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

from radmpc.console.picture import drawing

from .conftest import CROSSING, Run

FOREIGN = CROSSING.replace("name: crossing", "name: 港の計画").replace("east", "船")


@pytest.mark.parametrize("target", ["a.png", "a.svg", "a.pdf"])
def test_letters_that_the_font_lacks_are_told_in_one_line(
    run: Run, target: str, tmp_path: Path
) -> None:
    (tmp_path / "foreign.yaml").write_text(FOREIGN, encoding="utf-8")
    result = run("draw", "foreign.yaml", "-o", target)
    assert result.exit_code == 0
    assert result.stderr == (
        f"radmpc: {target}: the font has no sign for の, 港, 画, 船, 計: boxes stand for them\n"
    )


def test_other_warnings_are_told_once_and_without_their_place_in_the_code(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with drawing(Path("a.png")):
        for _ in range(3):
            warnings.warn("the layout\nfailed", UserWarning, stacklevel=1)
    assert capsys.readouterr().err == "radmpc: a.png: the layout failed\n"


def test_nothing_is_told_where_nothing_is_warned_of(capsys: pytest.CaptureFixture[str]) -> None:
    with drawing(Path("a.png")):
        pass
    assert capsys.readouterr().err == ""
