"""Nodes solved by compiled code in one go: what Python finds step by step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import clutter, paper
from radmpc.model.scenario import Scenario
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.compiled_code import is_compiled
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.priced import lp as priced_lp
from radmpc.solvers.priced import node_solver
from radmpc.solvers.priced.budget import BudgetTree
from radmpc.solvers.priced.node_solver import NodeSolver
from radmpc.solvers.priced.nodes import Node, NodeState
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

pytestmark = pytest.mark.skipif(not is_compiled(), reason="no compiled code here")

if is_compiled():
    from radmpc.solvers import _compiled
    from radmpc.solvers.priced import compiled_nodes
    from radmpc.solvers.priced.branching import FACTORS

UNIT, PRICE = 0.2, 0.3

SCENES: dict[str, Scenario] = {
    "pairs and obstacles at steps": paper(3, 0),
    "along intervals": replace(paper(3, 1), avoidance="intervals"),
    "among boxes": clutter(1, 20, 0),
    "covariances from six samples": replace(paper(3, 2), covariance_samples=6),
}


def tree_of(scenario: Scenario, kind: type[RiskTree] = RiskTree) -> RiskTree:
    models = condensed_models(scenario)
    program = build_program(scenario, models, risk_bound=scenario.risk_bound)
    return kind(program, UNIT, PRICE, gap=1e-4, scale=1e-3, limits=Limits())


def history(tree: RiskTree, solve: Callable[[Node], NodeState], nodes: int) -> list[tuple]:
    """Return what became of every node of a search."""
    found: list[tuple] = []

    def noted(node: Node) -> NodeState:
        state = solve(node)
        found.append((node.chosen, state, node.bound, node.alternatives, tree.value))
        return state

    tree._solver.solve = noted
    tree.run(nodes)
    return found


@pytest.mark.parametrize("kind", [RiskTree, BudgetTree])
@pytest.mark.parametrize("scene", SCENES)
def test_every_node_ends_as_it_does_step_by_step(scene: str, kind: type[RiskTree]) -> None:
    scenario = SCENES[scene]
    compiled, python = tree_of(scenario, kind), tree_of(scenario, kind)
    ours = history(compiled, compiled._solver.solve, 400)
    theirs = history(python, python._solver._by_python, 400)
    assert len(ours) == len(theirs) >= 5
    for one, other in zip(ours, theirs, strict=True):
        assert one[:2] == other[:2]
        assert one[3] == other[3]
        assert one[2] == pytest.approx(other[2], rel=1e-9, abs=1e-9)
        assert one[4] == pytest.approx(other[4], rel=1e-9, abs=1e-9)
    assert compiled.nodes == python.nodes
    assert compiled.lps == python.lps
    assert compiled.bound == pytest.approx(python.bound, rel=1e-9)
    assert np.array_equal(compiled.best.selection, python.best.selection)
    assert compiled.best.cost == pytest.approx(python.best.cost, rel=1e-9)
    assert compiled.best.risk == pytest.approx(python.best.risk, rel=1e-6)


def test_rows_that_crowd_are_dropped_and_the_search_goes_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = tree_of(SCENES["among boxes"])
    whole.run(10_000)
    few = replace(priced_lp.TUNING, crowd=1, crowd_share=1, crowd_each=4)
    monkeypatch.setattr(priced_lp, "TUNING", few)
    monkeypatch.setattr(compiled_nodes, "TUNING", few)
    crowded = tree_of(SCENES["among boxes"])
    crowded.run(10_000)
    assert crowded._solver.lp.starts > whole._solver.lp.starts
    assert crowded.value == pytest.approx(whole.value, rel=2e-4)
    assert crowded.bound <= whole.value * (1.0 + 1e-9)


def test_what_compiled_code_gives_up_highs_solves(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = tree_of(SCENES["pairs and obstacles at steps"])
    whole.run(10_000)
    monkeypatch.setattr(compiled_nodes, "LEAST_PIVOTS", 3)
    monkeypatch.setattr(compiled_nodes, "PIVOTS", 0)
    states = []
    solve = NodeSolver._by_python
    monkeypatch.setattr(
        node_solver.NodeSolver,
        "_by_python",
        lambda self, node, first=0: states.append(first) or solve(self, node, first),
    )
    given_up = tree_of(SCENES["pairs and obstacles at steps"])
    given_up.run(10_000)
    assert states
    assert given_up.value == pytest.approx(whole.value, rel=2e-4)
    assert given_up.bound == pytest.approx(whole.bound, rel=2e-4)


def test_a_linear_program_that_nobody_solves_leaves_its_node_over(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tree = tree_of(SCENES["pairs and obstacles at steps"])
    monkeypatch.setattr(compiled_nodes, "LEAST_PIVOTS", 0)
    monkeypatch.setattr(compiled_nodes, "PIVOTS", 0)
    failed = LpOutcome.FAILED, -np.inf
    monkeypatch.setattr(type(tree._solver.lp), "solve", lambda self, cutoff=np.inf: failed)
    tree.run(100)
    assert tree.is_limited
    assert tree.bound == -np.inf


@pytest.mark.parametrize(
    ("change", "kind"),
    [
        ({0: "no rows"}, TypeError),
        ({1: "no ratings"}, TypeError),
        ({2: np.zeros(1, dtype=np.int32)}, ValueError),  # owners
        ({3: np.zeros(1, dtype=bool)}, ValueError),  # whether others refine
        ({4: np.ones(1)}, ValueError),  # weights
        ({5: np.ones(2)}, ValueError),  # factors
        ({6: np.ones(1)}, ValueError),  # a point
        ({7: np.ones(1, dtype=np.int64)}, ValueError),  # a selection
        ({8: np.ones((1, 1))}, ValueError),  # shortfalls
    ],
)
def test_what_does_not_fit_is_refused(change: dict[int, object], kind: type[Exception]) -> None:
    tree = tree_of(paper(3, 0))
    rater, rows, choice = tree.rater, tree._solver.lp.rows, tree._solver.choice
    weights = np.ones(tree.program.num_avoidances)
    given: list[object] = [
        rows.compiled,
        rater.compiled,
        choice.owners.astype(np.int32),
        choice.is_refined,
        weights,
        FACTORS,
        np.empty(tree.program.num_columns),
        np.empty(tree.program.num_avoidances, np.int64),
        np.empty(rater.table.shape),
        (1e-4, 1e-3, 1.0, 0.01, 0.3),
        (0.2, 0.2, np.inf),
        (8, 500, 3, 400, 12),
    ]
    nodes = _compiled.Nodes(*given)
    with pytest.raises(ValueError, match="alternative"):
        nodes.solve((tree.program.num_alternatives,), b"", 0.0, np.inf, False)
    with pytest.raises(ValueError, match="basis"):
        nodes.solve((), b"12345678" * 3, 0.0, np.inf, False)
    for place, value in change.items():
        given[place] = value
    with pytest.raises(kind):
        _compiled.Nodes(*given)


def test_a_search_whose_points_are_rated_for_another_unit_goes_step_by_step() -> None:
    tree = tree_of(paper(3, 0))
    tree._solver.rater = Rater(tree.program, 0.5 * UNIT)
    assert tree._solver._compiled_nodes() is None
    tree.run(50)
    assert tree.bound > 0.0
