"""The study: rows that survive anything, summaries that add up."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

import pytest
from studies import small, smallest

from radmpc.errors import FileFormatError
from radmpc.experiments.study import (
    Journal,
    Row,
    quick_study,
    read_rows,
    run_study,
    run_task,
)


def answers(rows):
    """Return what does not depend on the clock."""
    return sorted((r.key, r.status, r.cost, r.certified, r.rate, r.sets) for r in rows)


@pytest.mark.slow
def test_every_task_has_one_row_and_they_come_seed_by_seed(rows):
    tasks = small().tasks()
    assert [row.key for row in rows] == [task.key for task in tasks]
    assert [task.seed for task in tasks] == sorted(task.seed for task in tasks)
    for row in rows:
        assert row.has_plan
        assert row.versions["radmpc"]
        assert int(row.machine["processors"]) >= 1
        assert row.rate_low <= row.rate <= row.rate_high
        assert row.seconds > 0.0


@pytest.mark.slow
def test_a_row_says_what_planning_and_flying_alone_say(rows):
    task = small().tasks()[4]
    again = run_task(task)
    assert answers([again]) == answers([row for row in rows if row.key == task.key])


@pytest.mark.slow
def test_a_second_run_does_nothing_and_a_larger_study_only_what_is_new(written, tmp_path):
    path = tmp_path / "rows.jsonl"
    path.write_bytes(written)
    with Journal.opened(path) as journal:
        run_study(smallest(seeds=1), journal)
    assert path.read_bytes() == written
    with Journal.opened(path) as journal:
        run_study(smallest(seeds=2), journal)
    assert path.read_bytes().startswith(written)
    assert len(read_rows(path)) == len(smallest(seeds=2).tasks())


@pytest.mark.slow
def test_other_settings_are_other_tasks(written, tmp_path):
    path = tmp_path / "rows.jsonl"
    path.write_bytes(written)
    with Journal.opened(path) as journal:
        run_study(smallest(seeds=1, samples=500), journal)
    assert len(read_rows(path)) == 2 * len(smallest(seeds=1).tasks())


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("left", [1, 30])
def test_a_line_that_a_kill_cut_off_is_done_again(written, tmp_path, left):
    path = tmp_path / "rows.jsonl"
    study = smallest(seeds=1)
    path.write_bytes(written)
    before = answers(read_rows(path))
    start = written.rstrip(b"\n").rfind(b"\n") + 1
    path.write_bytes(written[: start + left])
    assert len(read_rows(path)) == len(study.tasks()) - 1
    with Journal.opened(path) as journal:
        run_study(study, journal)
    assert answers(read_rows(path)) == before
    assert [row.key for row in read_rows(path)] == [task.key for task in study.tasks()]


def test_a_whole_line_that_is_no_row_is_named(tmp_path):
    path = tmp_path / "rows.jsonl"
    path.write_text('{"method": "ira"}\n', encoding="utf-8")
    with pytest.raises(FileFormatError, match="line 1: not a row"):
        read_rows(path)


def test_two_runs_do_not_write_to_one_journal(tmp_path):
    path = tmp_path / "rows.jsonl"
    with (
        Journal.opened(path),
        pytest.raises(FileFormatError, match="another run"),
        Journal.opened(path),
    ):
        pass


@pytest.mark.nightly
def test_processes_give_the_same_rows(rows, tmp_path):
    path = tmp_path / "rows.jsonl"
    with ProcessPoolExecutor(2) as pool, Journal.opened(path) as journal:
        run_study(small(seeds=1), journal, executor=pool, workers=2)
    assert answers(read_rows(path)) == answers([row for row in rows if row.seed == 0])


@pytest.mark.slow
def test_a_method_ends_with_its_budget(tmp_path):
    path = tmp_path / "rows.jsonl"
    study = small(seeds=2).only(["ira", "certified"])
    costly = replace(study.methods[0], budget=1e-6)
    study = replace(study, methods=(costly, *study.methods[1:]))
    for _ in range(2):
        with Journal.opened(path) as journal:
            run_study(study, journal)
    assert sum(row.method == "ira" for row in read_rows(path)) == 1
    assert sum(row.method == "certified" for row in read_rows(path)) == 4


@pytest.mark.slow
def test_what_is_stopped_leaves_no_row(tmp_path):
    path = tmp_path / "rows.jsonl"
    count = 0

    def told(done, total, task):
        nonlocal count
        count = done

    with Journal.opened(path) as journal:
        run_study(smallest(3), journal, progress=told, stop=lambda: count >= 4)
    assert len(read_rows(path)) == 4 < len(smallest(3).tasks())


SCRIPT = """
import sys
from pathlib import Path
sys.path.insert(0, {folder!r})
from radmpc.experiments.study import Journal, run_study
from test_study import smallest
with Journal.opened(Path(sys.argv[1])) as journal:
    run_study(smallest(4, samples=1000), journal)
"""


@pytest.mark.nightly
def test_killed_again_and_again_it_loses_nothing_and_does_nothing_twice(tmp_path):
    path = tmp_path / "rows.jsonl"
    script = SCRIPT.format(folder=os.path.dirname(__file__))
    command = [sys.executable, "-c", script, str(path)]
    seen = b""
    for _ in range(2):
        process = subprocess.Popen(command)
        want = len(read_rows(path)) + 2
        deadline = time.monotonic() + 60.0
        while len(read_rows(path)) < want and process.poll() is None:
            assert time.monotonic() < deadline
            time.sleep(0.02)
        process.send_signal(signal.SIGKILL)
        process.wait()
        content = path.read_bytes()
        kept = content[: content.rfind(b"\n") + 1]
        assert kept.startswith(seen)
        seen = kept
    assert subprocess.run(command, check=False, timeout=120).returncode == 0
    keys = [row.key for row in read_rows(path)]
    assert keys == [task.key for task in smallest(4, samples=1000).tasks()]


def test_rows_of_journals_that_tell_no_limit_of_nodes_are_still_known():
    (task, *_) = (each for each in quick_study().tasks() if each.method == "ira")
    assert "max_nodes" in str(task.planner)
    # A row's key depends on nothing but these fields.
    told = {name: getattr(task, name) for name in ("method", "vehicles", "seed", "samples", "cap")}
    fields = dict.fromkeys(Row.__annotations__) | told | {"planner": "ira, branch, centralized"}
    assert Row(**fields).key == task.key
