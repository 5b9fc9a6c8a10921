"""The paper's study from the command line."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import pytest

from radmpc.console.commands import reproducing
from radmpc.experiments.study import (
    Journal,
    Study,
    full_study,
    quick_study,
    read_rows,
    run_task,
)
from radmpc.experiments.study.trial import Task
from radmpc.planners.presets import PRESETS

# The command with a smaller study: what sizes and samples the shipped ones have is tested there;
# and without a report, whose pictures take longer than all its runs.
SCRIPT = """
import sys
sys.path.insert(0, {folder!r})
from test_reproduce import smaller
from radmpc.__main__ import main
from radmpc.console.commands import reproducing
from radmpc.experiments.study import report
report.write_report = lambda study, rows, folder: []
quick = smaller(reproducing.quick_study())
reproducing.quick_study = lambda: quick
main()
"""


def smaller(study: Study) -> Study:
    """The same study of fewer fleets and flights."""
    return replace(study, sizes=(2, 3), samples=1_000, shown={2: 0})


@pytest.mark.nightly
def test_reproduce_writes_rows_report_and_figures_and_then_has_nothing_to_do(
    run, tmp_path, monkeypatch
):
    monkeypatch.setattr(reproducing, "full_study", lambda **words: smaller(full_study(**words)))
    words = ("reproduce", "--out", "study", "--seeds", 1, "--cap", 20, "--method", "certified")
    first = run(*words)
    assert first.exit_code == 0
    assert "2 rows in study/rows.jsonl" in first.stdout
    rows = read_rows(tmp_path / "study/rows.jsonl")
    assert {(row.method, row.seed, row.cap) for row in rows} == {("certified", 0, 20.0)}
    before = (tmp_path / "study/rows.jsonl").read_bytes()
    assert (tmp_path / "study/report.md").read_text(encoding="utf-8").startswith("# The paper's")
    assert (tmp_path / "study/plans-2.png").exists()
    assert run(*words, "--report-only").exit_code == 0
    assert (tmp_path / "study/rows.jsonl").read_bytes() == before


def test_a_report_calls_only_methods_left_out_that_have_no_rows(run, tmp_path, monkeypatch):
    study = smaller(full_study(seeds=1))
    names = {"certified": "no_such_package", "radmpc": "nor_this"}
    methods = tuple(replace(m, package=names.get(m.name)) for m in study.methods)
    monkeypatch.setattr(reproducing, "full_study", lambda **_: replace(study, methods=methods))
    monkeypatch.setattr("radmpc.experiments.study.report.write_report", lambda *_: ())
    row = run_task(Task("certified", PRESETS["certified"].planner, 2, 0, 10, 60.0))
    (tmp_path / "study").mkdir()
    with Journal.opened(tmp_path / "study" / "rows.jsonl") as journal:
        journal.append(row)
    result = run("reproduce", "--out", "study", "--report-only")
    assert result.exit_code == 0
    assert "left out: radmpc (package nor_this is not installed)" in result.stdout
    assert "certified" not in result.stdout


def test_reports_of_no_rows_are_refused_and_make_no_folder(run, tmp_path):
    result = run("reproduce", "--out", "study", "--report-only")
    assert result.exit_code == 2
    assert result.stderr == (
        "radmpc: study/rows.jsonl: No such file or directory; --report-only needs the rows of a "
        "run\n"
    )
    assert not (tmp_path / "study").exists()


def test_a_report_of_another_cap_than_that_of_the_rows_replaces_none(run, tmp_path):
    row = run_task(Task("certified", PRESETS["certified"].planner, 2, 0, 10, 120.0))
    (tmp_path / "study").mkdir()
    with Journal.opened(tmp_path / "study" / "rows.jsonl") as journal:
        journal.append(row)
    (tmp_path / "study" / "report.md").write_text("of hours", encoding="utf-8")
    result = run("reproduce", "--out", "study", "--report-only")
    assert result.exit_code == 2
    assert result.stderr == (
        "radmpc: study/rows.jsonl: must have rows of a cap of 60 s, got those of 120 s: state "
        "that cap\n"
    )
    assert (tmp_path / "study" / "report.md").read_text(encoding="utf-8") == "of hours"


def test_a_study_whose_folder_is_a_file_is_refused_by_that_reason(run, tmp_path):
    (tmp_path / "study").write_text("mine", encoding="utf-8")
    for words in ([], ["--report-only"]):
        result = run("reproduce", "--out", "study", "--quick", *words)
        assert result.exit_code == 2
        assert result.stderr == "radmpc: cannot write study: Not a directory\n"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--method", "nobody"], "--method must be among"),
        (["--quick", "--cap", "5"], "--quick has its own"),
        (["--jobs", "2", "--dask", "here"], "exclude each other"),
    ],
)
def test_reproduce_refuses_what_makes_no_sense_in_one_line(run, words, message):
    result = run("reproduce", "--out", "study", *words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1


@pytest.mark.nightly
@pytest.mark.slow
def test_an_interrupt_ends_it_and_the_same_command_goes_on(tmp_path):
    out = tmp_path / "study"
    script = SCRIPT.format(folder=os.path.dirname(__file__))
    command = [sys.executable, "-c", script, "reproduce", "--out", str(out), "--quick"]
    command += ["--method", "certified"]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ}
    )
    deadline = time.monotonic() + 60.0
    while len(read_rows(out / "rows.jsonl")) < 2:
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=120.0)
    assert process.returncode == 1
    assert "goes on with the other runs" in errors
    assert "Traceback" not in errors
    kept = (out / "rows.jsonl").read_bytes()
    again = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300.0)
    assert again.returncode == 0
    assert (out / "rows.jsonl").read_bytes().startswith(kept)
    tasks = smaller(quick_study()).only(["certified"]).tasks()
    assert len(read_rows(out / "rows.jsonl")) == len(tasks) == 8
