"""Planners of others, each in its own process: answers, ends, and what is not installed."""

import importlib
import importlib.util
import io
import json
import sys
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from peers import harness
from peers import run as script
from peers.harness import Row, run
from peers.judge import judge
from peers.protocol import Request
from peers.statement import state
from peers.tables import cells_of, more_than, row_table, summary_cells, summary_table
from peers.worker import PEERS, respond
from radmpc.experiments.families import paper
from radmpc.planners.presets import parse_planner
from radmpc.planning import plan
from radmpc.program.allocation import uniform_allocation
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.branch.branch import Branch
from running import need_gurobi

ASKED = Request("paper", 2, 0, cap=20.0, gap=1e-3)

STUB = """
import os
import time

import numpy as np

from peers.protocol import Answer
from peers.statement import NotModeledError
from radmpc.planning import plan

PACKAGES = ("numpy", "no-such-package")


def planned(scenario, seconds, gap, seed):
    print("solvers print")
    os.write(1, b"where they like")
    result = plan(scenario, "certified", rng=seed)
    controls = tuple(t.controls for t in result.plan.trajectories)
    return Answer("feasible", controls, f"{seconds:g} {gap:g}")


def idle(scenario, seconds, gap, seed):
    return Answer("optimal", tuple(np.zeros((scenario.horizon, 2)) for v in scenario.vehicles))


def misshapen(scenario, seconds, gap, seed):
    return Answer("optimal", tuple(np.zeros((3, 2)) for v in scenario.vehicles))


def large(scenario, seconds, gap, seed):
    return Answer("too large", note="3000 columns")


def unable(scenario, seconds, gap, seed):
    raise NotModeledError("avoidance 'intervals'")


def broken(scenario, seconds, gap, seed):
    raise RuntimeError("no license")


def lacking(scenario, seconds, gap, seed):
    import no_such_solver


def dying(scenario, seconds, gap, seed):
    os._exit(3)


def endless(scenario, seconds, gap, seed):
    time.sleep(60)
"""


@pytest.fixture
def stub(tmp_path, monkeypatch):
    """A module with peers, where this process and workers find it."""
    (tmp_path / "stub_peer.py").write_text(STUB)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    yield "stub_peer"
    sys.modules.pop("stub_peer", None)


def row(peer: str, **changes: object) -> Row:
    """A row with a plan."""
    done = Row(
        "paper", 2, 0, 60.0, 1e-3, peer, "feasible", 0.05, cost=8.0, certified=0.04,
        is_within=True, seconds=0.5, versions={"casadi": "3"}, cpus=2,
    )  # fmt: skip
    return replace(done, **changes)


@pytest.mark.nightly
@pytest.mark.slow
def test_a_worker_keeps_its_answer_apart_from_what_solvers_print(stub):
    found = run(f"{stub}:planned", ASKED)
    assert (found.status, found.note) == ("feasible", "20 0.001")
    assert found.is_solved
    assert found.is_within
    assert 0.0 < found.certified <= found.bound == 0.05
    assert 0.0 < found.seconds < 20.0
    assert found.versions == {"numpy": np.__version__}


@pytest.mark.parametrize(
    ("function", "status", "note"),
    [
        ("large", "too large", "3000 columns"),
        ("unable", "not modeled", "avoidance 'intervals'"),
        ("broken", "failed", "RuntimeError: no license"),
        ("lacking", "not installed", "no module 'no_such_solver'"),
    ],
)
def test_every_end_is_a_word_and_a_note(stub, function, status, note):
    found = respond(f"{stub}:{function}", ASKED)
    assert (found["status"], found["note"], found["controls"]) == (status, note, None)


def test_a_peer_whose_package_is_missing_is_not_installed(monkeypatch):
    monkeypatch.setitem(sys.modules, "casadi", None)
    monkeypatch.delitem(sys.modules, "peers.with_ipopt", raising=False)
    found = respond("ipopt", ASKED)
    assert (found["status"], found["note"]) == ("not installed", "no module 'casadi'")
    assert found["seconds"] is None


def test_an_interpreter_that_is_missing_or_lacks_radmpc_is_not_installed(tmp_path):
    assert run("ipopt", ASKED, str(tmp_path / "python")).status == "not installed"
    bare = tmp_path / "bare"
    bare.write_text('#!/bin/sh\necho "ModuleNotFoundError: No module named x" >&2\nexit 1\n')
    bare.chmod(0o755)
    found = run("ipopt", ASKED, str(bare))
    assert (found.status, found.note) == (
        "not installed",
        "ModuleNotFoundError: No module named x",
    )


@pytest.mark.nightly
@pytest.mark.slow
def test_a_worker_that_dies_is_mute_or_does_not_end_is_a_row(stub, monkeypatch):
    assert run(f"{stub}:dying", ASKED).status == "crashed"
    assert run(f"{stub}:idle", ASKED, "/bin/true").note == "no answer"
    monkeypatch.setattr(harness, "_GRACE", 1.0)
    found = run(f"{stub}:endless", replace(ASKED, cap=1.0))
    assert (found.status, found.seconds, found.is_solved) == ("killed", 1.0, False)


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("function", ["idle", "misshapen"])
def test_controls_that_miss_the_goal_or_do_not_fit_are_no_plan(stub, function):
    found = run(f"{stub}:{function}", ASKED)
    assert found.status == "invalid"
    assert found.note.startswith("vehicle 'v1': ")
    assert not found.is_solved
    assert not found.is_within
    assert more_than(found, row("certified")) is None


def test_costs_are_compared_where_both_plans_are_within_the_bound():
    rows = [
        row("certified"),
        row("ipopt", cost=8.8),
        row("certified", seed=1),
        row("ipopt", seed=1, cost=4.0, certified=0.5, is_within=False),
        row("certified", seed=2, cost=None, status="limit", is_within=False),
        row("ipopt", seed=2),
        row("certified", seed=3),
        row("ipopt", seed=3, cost=None, status="failed", is_within=False, seconds=2.5),
    ]
    bests = {("paper", 2, r.seed): r for r in rows if r.peer == "certified" and r.is_within}
    mine = [r for r in rows if r.peer == "ipopt"]
    assert summary_cells(mine, bests) == ["3/4", "2/4", "0.500", "2.500", "1.1000 (1)", *"---"]
    assert cells_of(mine[0], rows[0])[4:8] == ["8.8000", "+10.00", "0.04000", "yes"]
    assert cells_of(mine[1], rows[2])[7] == "NO"


def test_peers_that_did_not_try_are_counted_apart():
    gone = row("gurobi", cost=None, certified=None, is_within=False, seconds=None)
    rows = [replace(gone, status="not installed"), replace(gone, status="too large", seed=1)]
    assert summary_cells(rows, {}) == ["-", "-", "-", "-", "-", "1", "1", "-"]
    printed = io.StringIO()
    Console(width=150, file=printed).print(row_table(rows), summary_table(rows))
    assert printed.getvalue().count("too large") == 2


@pytest.mark.nightly
def test_the_script_prints_tables_and_appends_rows(stub, tmp_path, capsys):
    out = tmp_path / "rows.jsonl"
    script.main([
        "2", "--seeds", "1", "--cap", "20", "--peers", "certified", f"{stub}:planned", "gurobi",
        "--python", f"gurobi={tmp_path}/nowhere", "--out", str(out),
    ])  # fmt: skip
    told = capsys.readouterr().out
    assert "cost ratio" in told
    rows = [json.loads(line) for line in out.read_text().splitlines()]
    assert [r["peer"] for r in rows] == ["certified", f"{stub}:planned", "gurobi"]
    assert [r["status"] for r in rows] == ["optimal", "feasible", "not installed"]
    assert {"seed", "versions", "cpus", "cap", "certified", "bound"} <= rows[0].keys()
    assert rows[0]["cost"] == pytest.approx(rows[1]["cost"], rel=1e-9)


@pytest.mark.parametrize("extra", [["--peers", "cplex"], ["--python", "ipopt"]])
def test_the_script_refuses_peers_and_interpreters_that_make_no_sense(extra, capsys):
    with pytest.raises(SystemExit):
        script.parsed(["2", *extra])
    assert "usage" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("peer", "packages"),
    [
        ("ipopt", ["casadi"]),
        ("cvxpy", ["cvxpy", "highspy"]),
        ("cvxpy-scip", ["cvxpy", "pyscipopt"]),
        ("gurobi", ["gurobipy"]),
        ("multi-vehicle", []),
        ("uniform", []),
    ],
)
def test_real_peers_keep_limits_reach_goals_and_are_judged(peer, packages):
    # Looked for, not imported: solvers that clash must not meet in this process.
    absent = [package for package in packages if importlib.util.find_spec(package) is None]
    if absent:
        pytest.skip(f"{absent[0]} is not installed")
    if peer == "gurobi":
        need_gurobi()
    found = run(peer, ASKED)
    assert found.status in {"optimal", "feasible"}, found.note  # the referee sees no problem
    assert np.isfinite(found.certified)
    assert found.is_within
    assert 7.8 < found.cost < 8.2
    assert set(packages) <= found.versions.keys()


def test_the_big_m_peer_and_radmpc_agree_at_the_same_allocation(monkeypatch):
    need_gurobi()
    with_gurobi = importlib.import_module("peers.with_gurobi")
    scenario, gap = paper(3, 1), 1e-6
    program = build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)
    allocation = uniform_allocation(program, scenario.risk_bound - program.initial_risk)
    share = float(allocation.max())
    assert allocation.min() == share
    monkeypatch.setattr(with_gurobi, "state", lambda s: replace(state(s), share=share))
    answer = with_gurobi.solve(scenario, 30.0, gap, 0)
    planner = replace(parse_planner("uniform"), solver=Branch(), gap=gap)
    ours = plan(scenario, planner)
    assert answer.status == "optimal"
    assert judge(scenario, answer.controls, "gurobi").cost == pytest.approx(ours.cost, rel=1e-5)


def test_every_peer_is_a_function_of_a_module_in_the_folder():
    for target in PEERS.values():
        name, _, function = target.partition(":")
        source = importlib.util.find_spec(name).origin
        with open(source, encoding="utf-8") as file:
            assert f"def {function}(" in file.read()
