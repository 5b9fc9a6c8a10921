"""Tables that no vehicle wrote: every one is refused in a line that says where it goes wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from radmpc.errors import FileFormatError
from radmpc.importing.logs.reading import read_logs

HEAD = "time,vehicle,x,y,vx,vy\n"


def csv(folder: Path, text: str) -> Path:
    path = folder / "log.csv"
    path.write_text(text, encoding="utf-8", newline="")
    return path


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"{HEAD}0,a,1_5,2,3,4\n", "line 2: x must be a number, got '1_5'"),
        (
            f"{HEAD}0,a,1,2,3,4\n1,a,1,-1e10,3,4\n",
            "line 3: y must lie between -1000000000 and 1000000000, got '-1e10'",
        ),
        (f"\n{HEAD}0,{'a' * 200_000},1,2,3,4\n", "line 3: cannot be read as CSV: field larger"),
        (f"{HEAD}0,a,1\r1,2,3,4\n", "line 2: has 3 cells, the header 6"),
    ],
)
def test_a_hostile_csv_is_one_line(tmp_path: Path, text: str, message: str) -> None:
    path = csv(tmp_path, text)
    with pytest.raises(FileFormatError) as caught:
        read_logs([path])
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert str(caught.value).isprintable()


def test_every_vehicle_of_many_keeps_its_own_rows(tmp_path: Path) -> None:
    rows = [f"{k},v{i},{i},{k}\n" for k in range(3) for i in range(500)]
    found = read_logs([csv(tmp_path, f"time,vehicle,x,y\n{''.join(rows)}")])
    assert [track.name for track in found.tracks] == [f"v{i}" for i in range(500)]
    for i, track in enumerate(found.tracks):
        assert track.positions.tolist() == [[i, k] for k in range(3)]
