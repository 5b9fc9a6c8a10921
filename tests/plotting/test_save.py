from __future__ import annotations

from pathlib import Path

import pytest

from radmpc.errors import FileFormatError
from radmpc.model.plan import Plan
from radmpc.plotting import check_figure_path, save_figure

SIGNATURES = {".png": b"\x89PNG", ".pdf": b"%PDF", ".svg": b"<?xml"}


@pytest.mark.slow
@pytest.mark.parametrize("suffix", SIGNATURES)
def test_the_suffix_decides_the_format(flat_plan: Plan, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"plan{suffix}"
    save_figure(flat_plan, path)
    assert path.read_bytes().startswith(SIGNATURES[suffix])
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


@pytest.mark.slow
def test_the_same_plan_gives_the_same_file(flat_plan: Plan, tmp_path: Path) -> None:
    for name in ("a.svg", "b.svg"):
        save_figure(flat_plan, tmp_path / name)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


@pytest.mark.slow
def test_a_picture_in_space_can_be_saved(space_plan: Plan, tmp_path: Path) -> None:
    save_figure(space_plan, str(tmp_path / "sky.PNG"))
    assert (tmp_path / "sky.PNG").stat().st_size > 10_000


def test_an_unknown_suffix_is_refused_with_the_known_ones() -> None:
    with pytest.raises(FileFormatError, match=r"plan\.bmp: .*\.png, \.pdf, \.svg"):
        check_figure_path(Path("plan.bmp"))


def test_a_failed_write_leaves_the_old_file_and_no_rubbish(
    flat_plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "plan.png"
    path.write_bytes(b"old")

    def fail(*args: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("radmpc.plotting.save.os.replace", fail)
    with pytest.raises(OSError, match="No space"):
        save_figure(flat_plan, path)
    assert path.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["plan.png"]
