from __future__ import annotations

import io
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor
from pathlib import Path

import pytest
from rich.console import Console

from radmpc.console import output
from radmpc.console.files import OutputError, check_output, demo_text, writing
from radmpc.console.output import note, show_json
from radmpc.console.reports.progress import ProgressLine, progress_line, progress_text
from radmpc.console.running.interrupt import stop_on_interrupt
from radmpc.console.running.workers import workers
from radmpc.errors import SolverError

from .conftest import Run, assert_one_line
from .reports.reported import make_plan, shown


def test_a_note_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    note("one\n  two")
    assert capsys.readouterr().err == "radmpc: one two\n"


LINES = ["a [b] c", "ends in spaces  ", "", "tab\there", "schöner Hafen", "bell\a", "two\nlines"]


@pytest.mark.parametrize("text", [*LINES, "word " * 30])
@pytest.mark.parametrize("is_terminal", [True, False])
def test_lines_are_printed_the_same_without_rich(
    text: str,
    is_terminal: bool,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: is_terminal)
    monkeypatch.setenv("COLUMNS", "40")
    output.show(text, "next")
    width = 40 if is_terminal else 5000
    rendered = output._rendered([text, "next"], is_terminal, width)
    assert capsys.readouterr().out == rendered + "\n"


def test_numbers_that_json_lacks_are_refused() -> None:
    with pytest.raises(ValueError, match="JSON"):
        show_json({"rate": float("nan")})


def test_a_terminal_gets_colors_and_a_pipe_none(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "\x1b[" not in shown(capsys, make_plan())
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert "\x1b[" in shown(capsys, make_plan())


def test_progress_is_shown_on_a_terminal_only() -> None:
    terminal, pipe = io.StringIO(), io.StringIO()
    with progress_line(Console(file=terminal, force_terminal=True)) as report:
        report("[sets]", 1, 3)
    with progress_line(Console(file=pipe)) as report:
        report("sets", 1, 3)
    assert "[sets] 1/3" in terminal.getvalue()
    assert pipe.getvalue() == ""


def test_progress_in_a_pipe_is_a_line_now_and_then_for_who_asks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun, lines = time.monotonic(), []
    passed = iter([0.0, 0.0, 9.0, 11.0, 11.0, 12.0, 22.0, 22.0])
    monkeypatch.setattr(time, "monotonic", lambda: begun + next(passed))
    with progress_line(Console(file=io.StringIO()), keeps="all", tell=lines.append) as line:
        for number in range(4):
            line("flying", number, 9)
    # Nobody presses Ctrl-C in a pipe.
    assert lines == ["flying 1/9; 11 s", "flying 3/9; 22 s"]


def test_progress_tells_the_best_plan_the_limit_and_how_to_stop(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = time.monotonic()
    monkeypatch.setattr(time, "monotonic", lambda: now)
    line = ProgressLine(is_planning=True, seconds=60.0)
    line("sets", 2, 2)
    assert line.text() == "sets 2/2; 0 of 60 s; Ctrl-C keeps the best plan so far"
    line.found(13.4933, 13.2)
    assert line.text() == (
        "sets 2/2; best cost 13.4933, gap 2.2 %; 0 of 60 s; Ctrl-C keeps this plan"
    )
    assert len(line.text()) < 78
    line.found(13.4, None)
    assert "best cost 13.4; " in line.text()
    working = ProgressLine()
    working("simulating", 5, 10)
    assert working.text() == "simulating 5/10; 0 s"


def test_progress_on_a_terminal_goes_on_counting_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    line = ProgressLine(is_planning=True, seconds=60.0)
    later = time.monotonic() + 14.0
    monkeypatch.setattr(time, "monotonic", lambda: later)
    terminal = io.StringIO()
    Console(file=terminal, force_terminal=True, width=100).print(line)
    assert "14 of 60 s" in terminal.getvalue()


def test_progress_of_unknown_length_is_a_count() -> None:
    assert progress_text("nodes", 12, None) == "nodes 12"


def test_the_first_interrupt_asks_and_the_second_stops() -> None:
    # A shell's background job is started with interrupts ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with stop_on_interrupt() as is_stopped:
            assert not is_stopped()
            signal.raise_signal(signal.SIGINT)
            assert is_stopped()
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_second_interrupt_that_falls_into_the_first_stops(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    alive = [signal.SIGINT]

    class Interrupted(threading.Event):
        def set(self) -> None:
            if alive:
                signal.raise_signal(alive.pop())
            super().set()

    monkeypatch.setattr(threading, "Event", Interrupted)
    with pytest.raises(KeyboardInterrupt), stop_on_interrupt():
        signal.raise_signal(signal.SIGINT)
    assert capfd.readouterr().err == ""


def test_outside_the_main_thread_interrupts_are_left_alone() -> None:
    before = signal.getsignal(signal.SIGINT)
    answers: list[bool] = []

    def work() -> None:
        with stop_on_interrupt() as is_stopped:
            answers.append(is_stopped())

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert answers == [False]
    assert signal.getsignal(signal.SIGINT) is before


def test_one_job_needs_no_processes() -> None:
    with workers(1) as executor:
        assert executor is None


def test_no_more_processes_start_than_processors_can_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("radmpc.console.running.workers.num_processors", lambda: 1)
    before = set(multiprocessing.active_children())
    with workers(5) as executor:
        assert executor is not None
        assert executor.submit(abs, -1).result() == 1
        assert len(set(multiprocessing.active_children()) - before) == 2


def test_workers_are_beyond_interrupts() -> None:
    with workers(2) as executor:
        assert executor is not None
        for _ in range(4):
            os.kill(executor.submit(os.getpid).result(), signal.SIGINT)
        assert executor.submit(abs, -1).result() == 1


def test_an_interrupt_while_workers_start_is_answered(monkeypatch: pytest.MonkeyPatch) -> None:
    right = ProcessPoolExecutor.submit

    def submit(pool: ProcessPoolExecutor, task: Callable[[], object]) -> Future[object]:
        monkeypatch.undo()
        os.kill(os.getpid(), signal.SIGINT)
        return right(pool, task)

    monkeypatch.setattr(ProcessPoolExecutor, "submit", submit)
    with stop_on_interrupt() as is_stopped, workers(2) as executor:
        assert is_stopped()
        assert executor is not None
        assert executor.submit(abs, -1).result() == 1


def test_workers_may_start_outside_the_main_thread() -> None:
    answers: list[int] = []

    def work() -> None:
        with workers(2) as executor:
            assert executor is not None
            answers.append(executor.submit(abs, -1).result())

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert answers == [1]


def test_workers_end_with_an_error_outside() -> None:
    def fail_outside() -> None:
        with workers(2) as executor:
            assert executor is not None
            executor.submit(abs, -1).result()
            raise KeyError

    with pytest.raises(KeyError):
        fail_outside()


def test_a_folder_without_permission_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Root may write anywhere, so the answer of the system is put in its mouth.
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(OutputError, match="Permission denied"):
        check_output(tmp_path / "a.json")


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(OutputError, match="Not a directory"):
        check_output(tmp_path / "file" / "a.json")


def test_a_failed_write_names_its_target_not_a_temporary_file() -> None:
    def fail(place: str) -> None:
        with writing(Path("out/a.png")):
            raise OSError(28, "No space left on device", place)

    with pytest.raises(OutputError) as beside:
        fail("out/.a.png.x7")
    assert str(beside.value) == "cannot write out/a.png: No space left on device"
    with pytest.raises(OutputError) as above:
        fail("out")
    assert str(above.value) == "cannot write out/a.png: out: No space left on device"


def test_the_shipped_scenario_has_obstacles_convex_and_not() -> None:
    assert "breakwater" in demo_text()


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (SolverError("no basis"), 3, "internal error: SolverError: no basis"),
        (RuntimeError(), 3, "internal error: RuntimeError"),
        (OSError("odd"), 2, "odd"),
        (KeyboardInterrupt(), 1, "interrupted"),
        (MemoryError(), 3, "MemoryError"),
    ],
)
def test_every_failure_has_its_code(
    run: Run,
    crossing: Path,
    monkeypatch: pytest.MonkeyPatch,
    error: BaseException,
    code: int,
    words: str,
) -> None:
    def fail(path: Path, changes: dict[str, object]) -> None:
        raise error

    monkeypatch.setattr("radmpc.console.loading.load_scenario", fail)
    result = run("check", crossing)
    assert result.exit_code == code
    assert words in assert_one_line(result.stderr)
