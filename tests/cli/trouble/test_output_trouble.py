"""Places that cannot be written: one line, the old file as it was, and no other left behind."""

from __future__ import annotations

import contextlib
import errno
import os
import resource
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import pytest

from cli.conftest import CROSSING, Run, assert_one_line
from radmpc.console.files import demo_text

FOREIGN = Path(__file__).parents[3] / "instances" / "db-CBS" / "swap2_double_integrator.yaml"

WRITERS = {
    "plan": ("plan", "a.yaml", "-o", "{}/out.json"),
    "figure": ("plan", "a.yaml", "--figure", "{}/out.png"),
    "ledger": ("plan", "a.yaml", "--ledger", "{}/out.svg"),
    "import": ("import", FOREIGN, "-o", "{}/out.yaml"),
    "csv": ("export", "a.json", "--to", "csv", "-o", "{}/out.csv"),
    "kml": ("export", "a.json", "--to", "kml", "--origin", "54,12", "-o", "{}/out.kml"),
    "compare": ("compare", "a.yaml", "--planners", "certified", "--figure", "{}/out.png"),
    "demo": ("demo", "--out", "{}"),
    "reproduce": ("reproduce", "--out", "{}", "--seeds", 1, "--method", "certified"),
}
ALL = pytest.mark.parametrize("words", WRITERS.values(), ids=list(WRITERS))
FILES = pytest.mark.parametrize(
    "words", [words for words in WRITERS.values() if "-o" in words or "--figure" in words]
)


@pytest.fixture
def ready(run: Run, tmp_path: Path, crossing_plan: bytes) -> Run:
    """A scenario and its plan stand beside."""
    (tmp_path / "a.yaml").write_text(CROSSING, encoding="utf-8")
    (tmp_path / "a.json").write_bytes(crossing_plan)
    return run


def in_folder(words: tuple[object, ...], folder: Path) -> list[str]:
    return [str(word).replace("{}", str(folder)) for word in words]


def target(words: tuple[object, ...], folder: Path) -> Path:
    """The first file that a command writes."""
    first = {"demo": "harbor.yaml", "reproduce": "rows.jsonl"}
    last = first.get(str(words[0])) or Path(str(words[-1])).name
    return folder / last


@contextmanager
def mounted(folder: Path, options: str) -> Iterator[Path]:
    """Provide a file system of its own."""
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", options, "none", str(folder)]
    if shutil.which("mount") is None or subprocess.call(command, stderr=subprocess.DEVNULL):
        pytest.skip("mounting is not allowed here")
    try:
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def fill(file: IO[bytes]) -> None:
    """Write until the disk is full."""
    with contextlib.suppress(OSError):
        while True:
            file.write(b"x" * 4096)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.sampled(2)
@pytest.mark.slow
@ALL
def test_a_full_disk_leaves_the_old_file_and_no_other(
    ready: Run, tmp_path: Path, words: tuple[object, ...]
) -> None:
    with mounted(tmp_path / "disk", "size=16k") as disk:
        target(words, disk).write_bytes(b"")
        filler = disk / "filler"
        with open(filler, "wb", 0) as file:
            fill(file)
        before = contents(disk)
        result = ready(*in_folder(words, disk))
        assert result.exit_code == 2
        assert "No space left on device" in assert_one_line(result.stderr)
        assert contents(disk) == before


@pytest.mark.slow
@ALL
def test_a_read_only_folder_is_refused_in_one_line(
    ready: Run, tmp_path: Path, words: tuple[object, ...]
) -> None:
    with mounted(tmp_path / "disk", "ro") as disk:
        result = ready(*in_folder(words, disk))
        assert result.exit_code == 2
        line = assert_one_line(result.stderr)
        assert str(disk) in line
        assert "Permission denied" in line or "Read-only file system" in line
        assert contents(disk) == {}


@pytest.mark.slow
@pytest.mark.sampled(2)
@FILES
def test_a_file_that_may_not_grow_is_as_if_never_written(
    ready: Run, tmp_path: Path, words: tuple[object, ...]
) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    target(words, disk).write_bytes(b"old")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (64, limits[1]))
    try:
        result = ready(*in_folder(words, disk))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert result.exit_code == 2
    line = assert_one_line(result.stderr)
    assert os.strerror(errno.EFBIG) in line
    assert target(words, disk).name in line
    assert contents(disk) == {target(words, disk).name: b"old"}


@pytest.mark.slow
@pytest.mark.sampled(4)
@FILES
def test_a_missing_folder_or_a_folder_of_that_name_is_refused_in_one_line(
    ready: Run, tmp_path: Path, words: tuple[object, ...]
) -> None:
    result = ready(*in_folder(words, tmp_path / "nowhere"))
    assert result.exit_code == 2
    assert "No such file or directory" in assert_one_line(result.stderr)
    assert not (tmp_path / "nowhere").exists()
    disk = tmp_path / "disk"
    target(words, disk).mkdir(parents=True)
    result = ready(*in_folder(words, disk))
    assert result.exit_code == 2
    assert "Is a directory" in assert_one_line(result.stderr)


@pytest.mark.parametrize("words", [WRITERS["demo"], WRITERS["reproduce"]])
def test_a_file_where_a_folder_is_wanted_is_refused_in_one_line(
    ready: Run, tmp_path: Path, words: tuple[object, ...]
) -> None:
    (tmp_path / "file").write_bytes(b"old")
    result = ready(*in_folder(words, tmp_path / "file"))
    assert result.exit_code == 2
    assert "cannot write" in assert_one_line(result.stderr)
    assert (tmp_path / "file").read_bytes() == b"old"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no such device here")
@pytest.mark.parametrize("name", ["plan", "csv", "kml"])
def test_a_full_device_is_one_line(ready: Run, name: str) -> None:
    words = [*WRITERS[name][:-1], "/dev/full"]
    result = ready(*words)
    assert result.exit_code == 2
    line = assert_one_line(result.stderr)
    assert line == "radmpc: cannot write /dev/full: No space left on device"


@pytest.mark.parametrize(
    "words",
    [
        ("plan", "a.yaml", "-o", "-"),
        ("export", "a.json", "--to", "csv", "-o", "-"),
        ("import", FOREIGN, "-o", "-"),
        ("fly", "a.json", "-o", "-"),
        ("sweep", "a.yaml", "--over", "risk_bound=0.1", "-o", "-"),
        ("calibrate", "a.json", "--with", "boat", "-o", "-"),
        ("identify", "log.csv", "-o", "-"),
    ],
    ids=lambda words: str(words[0]),
)
def test_a_dash_is_no_file_name(ready: Run, words: tuple[object, ...]) -> None:
    result = ready(*words)
    assert result.exit_code == 2, result.output
    line = assert_one_line(result.stderr)
    assert line == "radmpc: cannot write -: is no file name here; /dev/stdout stands for stdout"
    assert not Path("-").exists()


@pytest.mark.parametrize(
    "words",
    [
        ("plan", "mine.yaml", "-o", "mine.yaml"),
        ("plan", "mine.yaml", "--figure", "same.png", "--ledger", "same.png"),
        ("import", "mine.yaml", "-o", "./mine.yaml"),
    ],
)
def test_what_is_read_is_not_replaced_nor_one_output_by_another(
    run: Run, words: tuple[str, ...]
) -> None:
    Path("mine.yaml").write_text(demo_text())
    result = run(*words)
    assert result.exit_code == 2
    assert "cannot write" in assert_one_line(result.stderr)
    assert Path("mine.yaml").read_text() == demo_text()
    assert not Path("same.png").exists()


@pytest.mark.parametrize(
    "words",
    [
        ("plan", "loop", "-o", "out.json"),
        ("import", "loop", "-o", "out.yaml"),
        ("identify", "loop", "-o", "out.yaml"),
        ("sweep", "mine.yaml", "--over", "risk_bound=0.1", "-o", "loop"),
        ("serve", "loop"),
    ],
)
def test_a_link_to_itself_is_refused_in_one_line(run: Run, words: tuple[str, ...]) -> None:
    Path("mine.yaml").write_text(demo_text())
    Path("loop").symlink_to("loop")
    result = run(*words)
    assert result.exit_code == 2
    assert "loop" in assert_one_line(result.stderr)
    assert sorted(os.listdir()) == ["loop", "mine.yaml"]


def test_the_demo_does_not_replace_a_scenario_that_was_changed(run: Run) -> None:
    changed = demo_text().replace("risk_bound: 0.05", "risk_bound: 0.01")
    Path("out").mkdir()
    Path("out/harbor.yaml").write_text(changed)
    result = run("demo", "--out", "out")
    assert result.exit_code == 2
    assert "differs from the shipped scenario" in assert_one_line(result.stderr)
    assert Path("out/harbor.yaml").read_text() == changed
