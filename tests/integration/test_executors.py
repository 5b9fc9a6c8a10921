"""The same plan wherever sets are searched, and whoever dies on the way."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

import distributed
import numpy as np
import pytest

from radmpc.console.running.cluster import cluster
from radmpc.experiments.families import fleet
from radmpc.experiments.study import Journal, quick_study, read_rows, run_study
from radmpc.io.native.plan_file import load_plan
from radmpc.io.native.scenario_file import save_scenario
from radmpc.planners.certified.proof import search
from radmpc.planners.executing import in_order
from radmpc.planning import plan

pytestmark = pytest.mark.slow
SCENARIO = fleet(5, 0)  # three sets, one of them of three vehicles


def controls(result_or_plan):
    return [t.controls for t in result_or_plan.trajectories]


@pytest.fixture(scope="module")
def planned():
    return plan(SCENARIO, "certified")


@pytest.fixture(scope="module")
def here(planned):
    return controls(planned.require())


@pytest.fixture(scope="module")
def scheduler():
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0"
    ) as local:
        yield local


def assert_same(found, expected):
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one, other)


def killing(pid):
    """Return a progress callback that kills a process when it is first called."""
    alive = [pid]

    def told(stage, done, total):
        del stage, done, total
        if alive:
            os.kill(alive.pop(), signal.SIGKILL)

    return told


def test_a_process_killed_in_mid_run_loses_nothing(planned, here):
    with ProcessPoolExecutor(2) as pool:
        pids = {pool.submit(os.getpid).result() for _ in range(8)}
        result = plan(SCENARIO, "certified", executor=pool, progress=killing(pids.pop()))
    assert_same(controls(result.require()), here)
    assert result.certified_lower_bound == planned.certified_lower_bound


def test_the_proof_says_the_same_wherever_its_parts_are_searched(monkeypatch):
    scenario, searched = fleet(16, 1), []
    expected = plan(scenario, "certified")

    def counted(work, tasks, limits, executor):
        made = list(tasks)
        searched.extend(made)
        return in_order(work, made, limits, executor)

    monkeypatch.setattr(search, "in_order", counted)
    with ProcessPoolExecutor(2) as pool:
        found = plan(scenario, "certified", executor=pool)
    assert len(searched) > 1
    assert found.certified_lower_bound == expected.certified_lower_bound
    assert_same(controls(found.require()), controls(expected.require()))


@pytest.mark.nightly
def test_a_cluster_gives_the_same_plan(scheduler, here):
    with cluster(scheduler.scheduler_address) as executor:
        result = plan(SCENARIO, "certified", executor=executor)
    assert_same(controls(result.require()), here)


def test_a_cluster_gives_the_same_plan_on_the_command_line(scheduler, here, tmp_path):
    save_scenario(SCENARIO, tmp_path / "fleet.yaml")
    command = ["plan", "fleet.yaml", "--dask", scheduler.scheduler_address, "-o", "plan.json"]
    done = subprocess.run(
        [sys.executable, "-m", "radmpc", *command],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert_same(controls(load_plan(tmp_path / "plan.json")), here)


@pytest.mark.nightly
def test_a_study_on_a_cluster_has_the_rows_of_one_here(scheduler, tmp_path):
    study = replace(quick_study().only(["certified", "radmpc"]), sizes=(2,), samples=500)
    with Journal.opened(tmp_path / "here.jsonl") as journal:
        run_study(study, journal)
    with (
        cluster(scheduler.scheduler_address) as executor,
        Journal.opened(tmp_path / "there.jsonl") as journal,
    ):
        run_study(study, journal, executor=executor, workers=2)
    here, there = (
        sorted((row.key, row.cost, row.rate) for row in read_rows(tmp_path / f"{name}.jsonl"))
        for name in ("here", "there")
    )
    assert here == there
    assert len(here) == len(study.tasks()) == 8


@pytest.mark.nightly
def test_a_worker_of_a_cluster_killed_in_mid_run_loses_nothing(scheduler, here):
    pids = [worker.pid for worker in scheduler.workers.values()]
    with cluster(scheduler.scheduler_address) as executor:
        result = plan(SCENARIO, "certified", executor=executor, progress=killing(pids[0]))
    assert_same(controls(result.require()), here)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "more",
    [
        ["--dask", "tcp://127.0.0.1:9", "--jobs", "2"],
        ["--dask", "tcp://127.0.0.1:9"],
        ["--dask", "nowhere"],
    ],
)
def test_a_scheduler_that_is_none_is_one_line(more, tmp_path):
    save_scenario(SCENARIO, tmp_path / "fleet.yaml")
    done = subprocess.run(
        [sys.executable, "-m", "radmpc", "plan", "fleet.yaml", *more],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "--dask" in done.stderr
