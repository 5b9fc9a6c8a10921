"""The study: rows that survive anything, summaries that add up."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from radmpc.errors import FileFormatError
from radmpc.experiments.study import (
    Journal,
    Method,
    Study,
    full_study,
    quick_study,
    read_rows,
    run_study,
    run_task,
)
from radmpc.experiments.study.pictures import curves
from radmpc.experiments.study.report import report_text, write_report
from radmpc.experiments.study.summary import speedup, summarize
from radmpc.planners import Couplings, Ira, Planner, Uniform
from radmpc.planners.presets import PRESETS
from radmpc.plotting import plot_chart
from radmpc.solvers.branch.branch import Branch


def small(seeds=3, samples=2_000, **changes):
    methods = (
        Method("ira", replace(PRESETS["ira"].planner, solver=Branch()), seeds, role="reference"),
        Method("multi-vehicle", PRESETS["multi-vehicle"].planner, seeds),
        Method("certified", PRESETS["certified"].planner, seeds),
    )
    return Study((2, 3), methods, samples, 20.0, **{"shown": {2: 0}, **changes})


def smallest(seeds=1, **changes):
    """Return the study of one method, for what its rows hold does not matter to."""
    return small(seeds, **changes).only(["certified"])


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "rows.jsonl"
    with Journal.opened(path) as journal:
        run_study(small(), journal)
    return read_rows(path)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """What a run of the smallest study writes."""
    path = tmp_path_factory.mktemp("smallest") / "rows.jsonl"
    with Journal.opened(path) as journal:
        run_study(smallest(), journal)
    return path.read_bytes()


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


@pytest.mark.slow
def test_summaries_count_what_the_rows_say(rows):
    found = {(s.method, s.vehicles): s for s in summarize(rows, 0.05)}
    for (method, n), summary in found.items():
        mine = [r for r in rows if (r.method, r.vehicles) == (method, n)]
        assert summary.problems == summary.plans == len(mine) == 3
        assert summary.successes == sum(r.rate <= 0.05 for r in mine)
        assert summary.surely_over == sum(r.rate_low > 0.05 for r in mine)
        assert summary.over == sum(r.certified > 0.05 for r in mine)
        assert summary.seconds.median == pytest.approx(np.median([r.seconds for r in mine]))
        bounds = {r.seed: r.lower_bound for r in rows if (r.method, r.vehicles) == ("certified", n)}
        excess = [r.cost / bounds[r.seed] - 1.0 for r in mine]
        assert summary.above_bound.median == pytest.approx(np.median(excess))
        assert summary.above_bound.median >= -1e-9
    assert found[("certified", 3)].above_bound.high <= 1e-3


@pytest.mark.slow
def test_capped_runs_count_at_the_cap_and_make_lower_bounds(rows):
    slow = [
        replace(r, is_capped=True, seconds=25.0, cost=None) if r.method == "ira" else r
        for r in rows
    ]
    ratio = speedup(slow, "ira", "certified", 3)
    assert ratio.capped == ratio.problems == 3
    fast = [r.seconds for r in rows if (r.method, r.vehicles) == ("certified", 3)]
    assert ratio.mean == pytest.approx(np.mean([20.0 / s for s in fast]))
    summary = next(s for s in summarize(slow, 0.05) if (s.method, s.vehicles) == ("ira", 3))
    assert summary.is_censored
    assert summary.seconds.median == 20.0
    assert "| >20 (20), 3 of 3 capped |" in report_text(small(), slow, summarize(slow, 0.05))
    assert speedup(rows, "nobody", "certified", 3) is None


def test_missed_couplings_are_pairs_of_different_sets_that_may_collide():
    # Planned one at a time these two seem to miss each other; their final plans do not.
    task = replace(small().tasks()[0], method="alone", vehicles=3, seed=5)
    found = {
        threshold: run_task(replace(task, planner=Planner(Ira(), Branch(), Couplings(threshold))))
        for threshold in (0.3, 1.0)
    }
    assert all(row.sets == (("v1",), ("v2",), ("v3",)) for row in found.values())
    [missed] = found[0.3].missed
    assert (missed.one, missed.other) == ("v2", "v3")
    assert 0.3 < missed.risk <= found[0.3].certified
    # No pair risks more than all.
    assert found[1.0].missed == ()


@pytest.mark.slow
def test_a_report_has_all_tables_and_figures(rows, tmp_path):
    written = write_report(small(), rows, tmp_path)
    assert {path.name for path in written} == {
        "report.md", "runtime.png", "success.png", "within.png", "cost.png", "used.png",
        "couplings.png", "plans-2.png",
    }  # fmt: skip
    text = written[0].read_text(encoding="utf-8")
    for path in written[1:]:
        assert path.stat().st_size > 5_000
        assert f"({path.name})" in text
    assert "18 of 18 runs" in text


@pytest.mark.slow
def test_the_figures_show_the_medians(rows):
    axes = plot_chart(curves(summarize(rows, 0.05), small())["runtime"])
    lines = {line.get_label(): line.get_ydata() for line in axes.get_lines()}
    expected = [s.seconds.median for s in summarize(rows, 0.05) if s.method == "certified"]
    assert lines["certified"] == pytest.approx(expected)
    assert axes.get_yscale() == "log"


@pytest.mark.slow
def test_the_shipped_studies_are_what_the_paper_asks():
    full = full_study()
    assert full.sizes == (2, 3, 4, 5, 6, 7, 8)
    assert full.samples == 100_000
    counts = {m.name: sum(t.method == m.name for t in full.tasks()) for m in full.available}
    assert counts["multi-vehicle"] == counts["ira"] == counts["certified"] == 350
    assert len({task.key for task in full.tasks()}) == len(full.tasks())
    assert len(quick_study().tasks()) < 150
    assert "ira, big-M, HiGHS" in counts


def test_a_planner_without_a_plan_leaves_a_row_that_says_why(tmp_path):
    task = replace(small().tasks()[0], planner=Planner(Uniform(), Branch(), Couplings()), cap=0.0)
    row = run_task(replace(task, cap=1e-6))
    assert not row.has_plan
    assert row.status == "limit"
    assert row.is_capped
    path = tmp_path / "rows.jsonl"
    with Journal.opened(path) as journal:
        journal.append(row)
    assert read_rows(path) == (row,)
    assert json.loads(path.read_text(encoding="utf-8"))["cost"] is None
