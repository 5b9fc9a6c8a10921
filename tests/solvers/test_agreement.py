"""Branch, big M and an independent enumeration must find the same optimum."""

from __future__ import annotations

import numpy as np
import pytest
from oracle import least_cost
from problems import random_problem

from radmpc.program.allocation import margins_of
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.milp.big_m import BigM, encode
from radmpc.solvers.milp.highs import HighsBackend
from radmpc.solvers.milp.scip import ScipBackend
from radmpc.solvers.solution import Limits, Outcome
from running import need_gurobi

SLOW = {5, 11, 13, 17, 29, 35}  # seconds of enumeration each
SEEDS = [seed for seed in range(46) if seed not in SLOW]
GAP = 1e-6


def _problem(seed):
    scenario = random_problem(seed)
    program = build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)
    risk = scenario.risk_bound / (6 * scenario.horizon)
    margins = margins_of(program, np.full(len(program.risk_items), risk))
    return scenario, program, margins, risk


def _openings(scenario, program):
    """Directions of the rows that are no face of an obstacle or a pair, by who avoids what."""
    axes = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]], dtype=float)
    known = {o.name: np.vstack([piece.normals for piece in o.at(0)]) for o in scenario.obstacles}
    first, found = {}, {}
    for i, vehicle in enumerate(scenario.vehicles):
        first[vehicle.name] = 2 * (scenario.horizon + 1) * i
    rows = program.rows.normals.tocsr()
    for number, label in enumerate(program.avoidances):
        for side in program.alternatives_of(number):
            row = rows[[int(program.rows_of(side)[0])]]
            place = first[label.vehicle] + 2 * label.step
            normal = -row[:, place : place + 2].toarray().ravel()
            faces = known.get(label.other, axes)
            if np.abs(faces - normal).max(axis=1).min() > 1e-6:
                found.setdefault((label.vehicle, label.other), {})[tuple(normal.round(9))] = normal
    return {who: list(normals.values()) for who, normals in found.items()}


@pytest.mark.slow
@pytest.mark.sampled(4)
@pytest.mark.parametrize("seed", SEEDS)
def test_branch_big_m_and_enumeration_find_the_same_optimum(seed):
    scenario, program, margins, risk = _problem(seed)
    # Where a start or goal stands at a corner, the program has a face more than there are.
    more = _openings(scenario, program)
    truth = straight = least_cost(scenario, risk, more=more)
    if scenario.avoidance == "intervals":
        straight = least_cost(scenario, risk, is_curved=False, more=more)
    for solver in (Branch(), BigM()):
        solution = solver.solve(program, margins, gap=GAP, limits=Limits())
        if scenario.avoidance == "intervals":
            # The reserve may be kept at either end: no dearer than both, no cheaper than none.
            assert straight * (1.0 - 1e-5) <= solution.cost <= truth * (1.0 + 1e-5)
            assert solution.bound <= solution.cost
        elif truth == np.inf:
            assert solution.outcome is Outcome.INFEASIBLE
            assert solution.z is None
        else:
            assert solution.outcome is Outcome.OPTIMAL
            assert solution.cost == pytest.approx(truth, rel=1e-5)
            assert solution.bound <= truth * (1 + 1e-6)


def test_points_that_cost_more_than_allowed_are_none() -> None:
    _, program, margins, _ = _problem(0)
    model = encode(program, margins)
    least = HighsBackend().minimize(model, GAP, Limits()).bound
    over, under = (model.costing_at_most(share * least) for share in (1.01, 0.99))
    allowed = HighsBackend().minimize(over, GAP, Limits())
    assert allowed.bound == pytest.approx(least, rel=1e-5)
    assert HighsBackend().minimize(under, GAP, Limits()).outcome is Outcome.INFEASIBLE


def test_a_tree_that_is_cut_short_proves_less() -> None:
    _, program, margins, _ = _problem(28)
    model = encode(program, margins)
    whole = HighsBackend().minimize(model, GAP, Limits())
    cut = HighsBackend(most_nodes=5).minimize(model, GAP, Limits())
    assert cut.nodes <= 5 < whole.nodes
    assert cut.outcome in {Outcome.LIMIT, Outcome.FEASIBLE}
    assert cut.bound < whole.bound


def test_some_problems_have_a_face_that_opens_a_start_or_goal():
    opened = {}
    for seed in SEEDS:
        scenario, program, _, _ = _problem(seed)
        opened[seed] = len(_openings(scenario, program))
    assert sum(opened.values()) >= 2
    assert all(count <= 1 for count in opened.values())


@pytest.mark.slow
def test_the_problems_hold_everything_that_makes_a_program_hard():
    problems = [_problem(seed) for seed in SEEDS]
    outcomes = [
        Branch().solve(program, margins, gap=GAP, limits=Limits())
        for _, program, margins, _ in problems
    ]
    free = [
        Branch().solve(program, 0.0 * margins, gap=GAP, limits=Limits())
        for _, program, margins, _ in problems
    ]
    binding = [
        s.cost > f.cost + 1e-6 for s, f in zip(outcomes, free, strict=True) if s.z is not None
    ]
    assert len(SEEDS) >= 40
    assert sum(s.outcome is Outcome.INFEASIBLE for s in outcomes) >= 5
    assert sum(s.outcome is Outcome.OPTIMAL for s in outcomes) >= 20
    assert sum(binding) >= 10
    assert sum(any(e.cause == "pair" for e in p.avoidances) for _, p, _, _ in problems) >= 10
    several_rows = [np.any(np.diff(p.alternative_starts) >= 2) for _, p, _, _ in problems]
    assert 10 <= sum(several_rows) <= len(SEEDS) - 10


@pytest.mark.slow
def test_scip_agrees_where_it_is_installed():
    pytest.importorskip("pyscipopt")
    for seed in (3, 4, 7):
        _, program, margins, _ = _problem(seed)
        ours = Branch().solve(program, margins, gap=GAP, limits=Limits())
        theirs = BigM("scip").solve(program, margins, gap=GAP, limits=Limits())
        assert theirs.outcome is ours.outcome
        assert theirs.cost == pytest.approx(ours.cost, rel=1e-5)


def test_scip_says_infeasible_in_its_own_words():
    pytest.importorskip("pyscipopt")
    _, program, margins, _ = _problem(3)
    model = encode(program, margins + 100.0)
    assert ScipBackend().minimize(model, GAP, Limits()).outcome is Outcome.INFEASIBLE


def test_gurobi_agrees_where_it_is_installed():
    need_gurobi()
    for seed in (3, 4):
        _, program, margins, _ = _problem(seed)
        ours = Branch().solve(program, margins, gap=GAP, limits=Limits())
        theirs = BigM("gurobi").solve(program, margins, gap=GAP, limits=Limits())
        assert theirs.cost == pytest.approx(ours.cost, rel=1e-5)
