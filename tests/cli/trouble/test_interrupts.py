"""Ctrl-C, SIGTERM and readers who go, at any time: a line at most, and no half-written file."""

from __future__ import annotations

import ctypes
import json
import math
import os
import signal
import subprocess
import sys
import time
import weakref
from collections.abc import Callable
from pathlib import Path

import pytest

from cli.conftest import CROSSING, Run, assert_one_line
from radmpc.console import loading
from radmpc.console.running import guard
from radmpc.console.running.interrupt import repeat_swallowed_interrupts
from radmpc.experiments.study import read_rows
from radmpc.io.native.plan_file import load_plan

FOREIGN = Path(__file__).parents[3] / "instances" / "db-CBS" / "swap2_double_integrator.yaml"
# [s] of a processor after the interpreter's own start, wherever the machine is busy with other
# things; more of them with RADMPC_THOROUGH=1, as in `make nightly`.
MORE_MOMENTS = (0.05, 0.3, 1.0, 1.5, 2.2) if os.environ.get("RADMPC_THOROUGH") else ()
MOMENTS = sorted((0.6, *MORE_MOMENTS))

# Only from here on is it the program that answers.
BEGUN = "import radmpc.__main__ as m; print('begun', flush=True); m.main()"

COMMANDS = {
    "plan": ("plan", "a.yaml", "-o", "out.json", "--figure", "out.png"),
    "verify": ("verify", "a.json", "--samples", "2000000"),
    "import": ("import", str(FOREIGN), "-o", "out.yaml"),
    "export": ("export", "a.json", "--to", "csv", "-o", "out.csv"),
    "compare": ("compare", "a.yaml", "--samples", "1000000", "--figure", "out.svg"),
    "reproduce": ("reproduce", "--quick", "--out", "study", "--method", "certified"),
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, crossing_plan: bytes) -> Path:
    """A scenario and its plan, where commands run."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.yaml").write_text(CROSSING, encoding="utf-8")
    (tmp_path / "a.json").write_bytes(crossing_plan)
    return tmp_path


def begin(*words: str) -> subprocess.Popen[str]:
    """Start a command and wait until it is the program that runs."""
    process = subprocess.Popen(
        [sys.executable, "-c", BEGUN, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    return process


def used(process: subprocess.Popen[str]) -> float:
    """Return the seconds of a processor that a process has had; no end of them once it is over."""
    if process.poll() is not None:
        return math.inf
    if not Path("/proc/self/stat").exists():
        pytest.skip("the system does not tell")
    # After the name, which may hold anything: state, ten numbers, the seconds of user and system.
    fields = Path(f"/proc/{process.pid}/stat").read_text(encoding="utf-8").rpartition(")")[2]
    return sum(map(int, fields.split()[11:13])) / os.sysconf("SC_CLK_TCK")


def wait_until(is_so: Callable[[], bool]) -> None:
    """Wait for something that takes no time of its own."""
    deadline = time.monotonic() + 60.0
    while not is_so():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def assert_clean(folder: Path, process: subprocess.Popen[str], most_lines: int) -> None:
    """Check how a command ended, and what it left behind."""
    _, err = process.communicate(timeout=60)
    assert process.returncode in {0, 1}, err
    lines = err.splitlines()
    assert len(lines) <= most_lines, err
    assert all(line.startswith("radmpc: ") for line in lines), err
    assert process.returncode == 0 or lines
    hidden = [path.name for path in folder.rglob("*") if path.name.startswith(".")]
    assert hidden == []


def assert_whole(folder: Path) -> None:
    """Check that every file written is a whole one."""
    ends = {"out.png": b"IEND\xaeB`\x82", "out.svg": b"</svg>\n", "out.csv": b"\n"}
    for name, end in ends.items():
        if (folder / name).exists():
            assert (folder / name).read_bytes().endswith(end), name
    if (folder / "out.json").exists():
        load_plan(folder / "out.json")
    read_rows(folder / "study" / "rows.jsonl")


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("words", COMMANDS.values(), ids=list(COMMANDS))
def test_ctrl_c_at_any_time_leaves_lines_and_whole_files(
    folder: Path, words: tuple[str, ...]
) -> None:
    # Planning says first that it finishes, and in the end what came of that.
    most_lines = 2 if words[0] in {"plan", "compare", "reproduce"} else 1
    report = folder / "study" / "report.md"
    for moment in MOMENTS:
        process = begin(*words)
        end = used(process) + moment
        wait_until(lambda process=process, end=end: used(process) >= end)
        is_over = process.poll() is not None
        process.send_signal(signal.SIGINT)
        if words[0] == "reproduce":
            # After the first it writes its report, with many pictures.
            wait_until(lambda process=process: process.poll() is not None or report.exists())
            process.send_signal(signal.SIGINT)
        assert_clean(folder, process, most_lines)
        assert_whole(folder)
        if is_over:
            break


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("moment", [0.8, 1.6])
def test_termination_is_an_interrupt_and_takes_the_workers_along(
    folder: Path, moment: float
) -> None:
    process = begin(*COMMANDS["reproduce"], "--jobs", "2")
    time.sleep(moment)
    workers = children(process.pid)
    process.send_signal(signal.SIGTERM)
    assert_clean(folder, process, 1)
    assert process.returncode == 1
    wait_until(lambda: not any(Path(f"/proc/{worker}").exists() for worker in workers))


def children(pid: int) -> list[int]:
    """The processes that a process has started."""
    path = Path(f"/proc/{pid}/task/{pid}/children")
    if not path.exists():
        pytest.skip("the system does not tell")
    return [int(word) for word in path.read_text(encoding="ascii").split()]


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "words",
    [
        ("planners",),
        ("plan", "a.yaml"),
        ("verify", "a.json", "--json", "--samples", "1000"),
        COMMANDS["import"],
        COMMANDS["export"],
    ],
    ids=lambda words: words[0],
)
def test_a_reader_who_has_gone_changes_nothing(folder: Path, words: tuple[str, ...]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    try:
        result = subprocess.run(
            [sys.executable, "-m", "radmpc", *words],
            stdout=writer,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
            check=False,
        )
    finally:
        os.close(writer)
    assert (result.returncode, result.stderr) == (0, "")


@pytest.mark.slow
def test_json_to_a_reader_of_one_line_is_no_error(folder: Path) -> None:
    command = f"{sys.executable} -m radmpc plan a.yaml --json | head -n 1"
    result = subprocess.run(
        command, shell=True, capture_output=True, text=True, timeout=60, check=False
    )
    assert (result.stdout, result.stderr) == ("{\n", "")
    assert json.loads(result.stdout + "}") == {}


def test_ctrl_c_while_a_class_is_made_is_no_defect() -> None:
    """Python 3.11 hides it in an error of its own, as compiled modules do while they begin."""

    class Interrupted:
        def __set_name__(self, owner: type, name: str) -> None:
            raise KeyboardInterrupt

    def imported() -> None:
        try:
            type("Made", (), {"field": Interrupted()})
        except KeyboardInterrupt as interrupt:
            # From Python 3.12 on it comes as it is.
            raise RuntimeError("Error calling __set_name__") from interrupt

    assert guard._guarded(imported, is_debug=False) == 1
    assert guard._guarded(lambda: int("x"), is_debug=False) == 3


class Finalized:
    """Interrupted while Python finalizes it."""

    def __del__(self) -> None:
        signal.raise_signal(signal.SIGINT)


class Holder:
    """Something that is finalized within its own finalizer."""

    def __del__(self) -> None:
        Finalized()
        sys.stdout.write("the finalizer went on\n")


def from_compiled_code() -> None:
    ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(signal.SIGINT))()


def as_a_reference_dies() -> None:
    dying = type("Dying", (), {})()
    reference = weakref.ref(dying, lambda _: signal.raise_signal(signal.SIGINT))
    del dying
    assert reference() is None


@pytest.mark.parametrize(
    "interrupted", [Finalized, Holder, from_compiled_code, as_a_reference_dies]
)
def test_ctrl_c_where_no_exception_gets_out_ends_a_command_all_the_same(
    crossing: Path, run: Run, monkeypatch: pytest.MonkeyPatch, interrupted: Callable[[], object]
) -> None:
    hook, profiler = sys.unraisablehook, sys.getprofile()
    read, usual = loading.read_scenario, signal.getsignal(signal.SIGINT)
    # Shells let what they start in the background ignore it.
    signal.signal(signal.SIGINT, signal.default_int_handler)

    def reading(*given: object) -> object:
        interrupted()
        sys.stdout.write("the command went on\n")
        return read(*given)  # type: ignore[arg-type] # as given

    monkeypatch.setattr(loading, "read_scenario", reading)
    try:
        result = run("check", crossing)
    finally:
        signal.signal(signal.SIGINT, usual)
    assert (result.exit_code, result.stdout) == (1, "")
    assert assert_one_line(result.stderr) == "radmpc: interrupted"
    assert (sys.unraisablehook, sys.getprofile()) == (hook, profiler)


def test_other_errors_where_no_exception_gets_out_are_told_as_usual(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told = []
    monkeypatch.setattr(sys, "unraisablehook", lambda swallowed: told.append(swallowed.exc_type))
    with repeat_swallowed_interrupts():
        ctypes.CFUNCTYPE(None)(lambda: int("x"))()
    assert told == [ValueError]
