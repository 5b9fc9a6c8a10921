from __future__ import annotations

import errno
import io
import os
import signal
import sys
import threading
from pathlib import Path

import pytest
from rich.console import Console

from radmpc.console.files import check_output, demo_text
from radmpc.console.interrupt import stop_on_interrupt
from radmpc.console.output import note, show, show_json
from radmpc.console.progress import progress_line, progress_text
from radmpc.console.report import ledger_table, plan_report, vehicle_table, verdict
from radmpc.console.workers import workers
from radmpc.errors import SolverError
from radmpc.experiments.families import circle
from radmpc.model.plan import LedgerRow, Plan, Risk, Status

from .conftest import Run, assert_one_line


def make_plan(**changes: object) -> Plan:
    """A plan of nothing, to report on."""
    fields: dict[str, object] = {
        "scenario": circle(3),
        "planner": "ira",
        "seed": 0,
        "status": Status.OPTIMAL,
        "cost": 10.0,
        "lower_bound": 9.9,
        "risk": Risk(0.05, 0.01),
        "sets": (("v1",), ("v2", "v3")),
        "seconds": {"radmpc": 0.5, "total": 1.0},
        "trajectories": ("any",),
    }
    return Plan(**(fields | changes))  # type: ignore[arg-type]


def shown(capsys: pytest.CaptureFixture[str], plan: Plan) -> str:
    """The report as plain text."""
    show(*plan_report(plan))
    return capsys.readouterr().out


def test_a_gap_is_reported_where_there_is_a_bound(capsys: pytest.CaptureFixture[str]) -> None:
    assert "10 (lower bound 9.9, gap 1 %)" in shown(capsys, make_plan())
    assert "10 (no lower bound)" in shown(capsys, make_plan(lower_bound=None))


def test_a_plan_that_costs_nothing_has_no_gap(capsys: pytest.CaptureFixture[str]) -> None:
    assert "gap 0 %" in shown(capsys, make_plan(cost=0.0, lower_bound=0.0))


def test_the_largest_sets_come_first_and_many_are_counted(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert "{v2, v3}, {v1}" in shown(capsys, make_plan())
    many = tuple((f"v{i}",) for i in range(15))
    assert "and 3 more sets" in shown(capsys, make_plan(sets=many))


def test_stages_are_timed(capsys: pytest.CaptureFixture[str]) -> None:
    assert "1.00 (radmpc 0.50)" in shown(capsys, make_plan())
    assert "seconds           1.00\n" in shown(capsys, make_plan(seconds={"total": 1.0}))


def test_the_verdict_is_plain() -> None:
    assert verdict(0.01, 0.05).plain == "risk at most 0.01, within the bound 0.05"
    assert "EXCEEDS the bound 0.05" in verdict(0.0500001, 0.05).plain
    assert verdict(None, 0.05).plain == "none"


def test_the_ledger_shows_its_top_the_rest_and_what_is_left(
    capsys: pytest.CaptureFixture[str],
) -> None:
    rows = tuple(LedgerRow("pair", "v1", "v2", k, 0.001 * k) for k in range(1, 7)) * 2
    show(ledger_table(make_plan(risk=Risk(0.05, 0.042, rows))))
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].split() == ["pair", "v1", "v2", "6", "6.00e-03", "12.0", "%"]
    assert lines[-2].split()[:2] == ["4", "more"]
    assert lines[-1].split() == ["left", "over", "8.00e-03", "16.0", "%"]


def test_nothing_is_left_of_a_spent_bound(capsys: pytest.CaptureFixture[str]) -> None:
    rows = (LedgerRow("workspace", "v1", None, 1, 0.06),)
    show(ledger_table(make_plan(risk=Risk(0.05, 0.06, rows))))
    assert "left over" not in capsys.readouterr().out


def test_a_sum_above_one_is_not_called_a_probability() -> None:
    text = verdict(4.0, 0.05).plain
    assert text.startswith("risk at most 1 (the bounds sum to 4), which EXCEEDS the bound 0.05")


def test_vehicles_bear_half_of_their_pairs_the_largest_first(
    capsys: pytest.CaptureFixture[str],
) -> None:
    rows = (
        LedgerRow("pair", "v1", "v3", 2, 0.01),
        LedgerRow("pair", "v1", "v3", 3, 0.01),
        LedgerRow("obstacle", "v3", "reef", 3, 0.005),
    )
    show(vehicle_table(make_plan(risk=Risk(0.05, 0.025, rows))))
    lines = [line.split() for line in capsys.readouterr().out.splitlines()[1:]]
    assert lines == [
        ["v3", "1.00e-02", "5.00e-03", "0.00e+00", "1.50e-02", "30.0", "%"],
        ["v1", "1.00e-02", "0.00e+00", "0.00e+00", "1.00e-02", "20.0", "%"],
        ["v2", "0.00e+00", "0.00e+00", "0.00e+00", "0.00e+00", "0.0", "%"],
    ]


def test_many_vehicles_are_summed_at_the_end(capsys: pytest.CaptureFixture[str]) -> None:
    rows = tuple(LedgerRow("workspace", f"v{i}", None, 0, 0.001) for i in range(1, 11))
    show(vehicle_table(make_plan(scenario=circle(10), risk=Risk(0.05, 0.01, rows))))
    assert capsys.readouterr().out.splitlines()[-1].split() == ["2", "more", "2.00e-03", "4.0", "%"]


def test_a_note_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    note("one\n  two")
    assert capsys.readouterr().err == "radmpc: one two\n"


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


def test_progress_of_unknown_length_is_a_count() -> None:
    assert progress_text("nodes", 12, None) == "nodes 12"


def test_the_first_interrupt_asks_and_the_second_stops() -> None:
    with stop_on_interrupt() as is_stopped:
        assert not is_stopped()
        signal.raise_signal(signal.SIGINT)
        assert is_stopped()
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


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


def test_workers_ignore_interrupts() -> None:
    with workers(2) as executor:
        assert executor is not None
        assert executor.submit(signal.getsignal, signal.SIGINT).result() is signal.SIG_IGN


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
    with pytest.raises(PermissionError) as caught:
        check_output(tmp_path / "a.json")
    assert caught.value.errno == errno.EACCES


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(NotADirectoryError):
        check_output(tmp_path / "file" / "a.json")


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
    def fail(path: Path) -> None:
        raise error

    monkeypatch.setattr("radmpc.cli.load_scenario", fail)
    result = run("check", crossing)
    assert result.exit_code == code
    assert words in assert_one_line(result.stderr)
