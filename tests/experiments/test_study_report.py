"""What a study's rows add up to."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from studies import small

from radmpc.experiments.study import (
    Journal,
    full_study,
    quick_study,
    read_rows,
    run_task,
)
from radmpc.experiments.study.pictures import curves
from radmpc.experiments.study.report import report_text, write_report
from radmpc.experiments.study.summary import speedup, summarize
from radmpc.planners import Couplings, Ira, Planner, Uniform
from radmpc.plotting import plot_chart
from radmpc.solvers.branch.branch import Branch


@pytest.mark.slow
def test_summaries_count_what_the_rows_say(rows):
    found = {(s.method, s.vehicles): s for s in summarize(rows, 0.05)}
    for (method, n), summary in found.items():
        mine = [r for r in rows if (r.method, r.vehicles) == (method, n)]
        assert summary.problems == summary.plans == len(mine) == 2
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
    assert ratio.capped == ratio.problems == 2
    fast = [r.seconds for r in rows if (r.method, r.vehicles) == ("certified", 3)]
    assert ratio.mean == pytest.approx(np.mean([20.0 / s for s in fast]))
    summary = next(s for s in summarize(slow, 0.05) if (s.method, s.vehicles) == ("ira", 3))
    assert summary.is_censored
    assert summary.seconds.median == 20.0
    assert "| >20 (20), 2 of 2 capped |" in report_text(small(), slow, summarize(slow, 0.05))
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
    assert "12 of 12 runs" in text


@pytest.mark.slow
def test_rows_of_a_method_count_where_its_package_is_not_installed(rows, tmp_path, monkeypatch):
    monkeypatch.setattr("radmpc.experiments.study.report.save_panels", lambda panels, path: None)
    elsewhere = tuple(replace(m, package="no_such_package") for m in small().methods)
    study = replace(small(), methods=elsewhere, shown={})
    text = write_report(study, rows, tmp_path)[0].read_text(encoding="utf-8")
    assert "12 of 12 runs" in text
    assert "| `certified` |" in text


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
