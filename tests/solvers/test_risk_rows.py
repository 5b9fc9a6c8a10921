"""Chance rows kept by compiled code: the linear programs that Python makes, to the last entry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import circle, clutter, paper
from radmpc.model.scenario import Scenario
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.compiled_code import is_compiled
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.priced import lp as priced_lp
from radmpc.solvers.priced.lp import RiskLp
from radmpc.solvers.priced.numpy_risk_rows import NumpyRiskRows
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.set_bounds import SetBound
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

pytestmark = pytest.mark.skipif(not is_compiled(), reason="no compiled code here")

if is_compiled():
    from radmpc.solvers import _compiled

UNIT, PRICE = 0.2, 0.3

BOUNDS = (SetBound(frozenset({0}), 0.5), SetBound(frozenset({0, 1}), 1.5))

SCENES: dict[str, tuple[Scenario, tuple[SetBound, ...]]] = {
    "pairs and obstacles at steps": (paper(3, 0), BOUNDS),
    "along intervals": (replace(paper(3, 1), avoidance="intervals"), BOUNDS),
    "among boxes": (clutter(1, 20, 0), ()),
    "covariances from six samples": (replace(paper(3, 2), covariance_samples=6), ()),
    "no noise": (
        replace(
            paper(2, 0),
            vehicles=tuple(
                replace(v, disturbance_covariance=0.0, initial_covariance=0.0)
                for v in paper(2, 0).vehicles
            ),
        ),
        (),
    ),
}


def rater_of(scenario: Scenario) -> Rater:
    models = condensed_models(scenario)
    return Rater(build_program(scenario, models, risk_bound=scenario.risk_bound), UNIT)


def by_python(monkeypatch: pytest.MonkeyPatch, rater: Rater, bounds: tuple[SetBound, ...]):
    """Return a program whose chance rows Python keeps."""
    with monkeypatch.context() as patch:
        patch.setattr(
            priced_lp, "_risk_rows", lambda around, rater: NumpyRiskRows(around, rater.tangents)
        )
        return RiskLp(rater.program, UNIT, PRICE, bounds, rater)


def contents(lp: RiskLp) -> list[np.ndarray]:
    """Return costs and bounds of columns, then rows: starts, columns, values, bounds."""
    parts = lp._lp.compiled.contents()
    kinds = [float, float, float, np.int32, np.int32, float, float, float]
    return [np.frombuffer(part, dtype=kind) for part, kind in zip(parts, kinds, strict=True)]


@pytest.mark.parametrize("scene", SCENES)
def test_rows_columns_and_tangents_are_those_of_python(
    scene: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario, bounds = SCENES[scene]
    rater = rater_of(scenario)
    program = rater.program
    compiled, python = (
        RiskLp(program, UNIT, PRICE, bounds, rater),
        by_python(monkeypatch, rater, bounds),
    )
    rng, refined = np.random.default_rng(5), 0
    chosen: tuple[int, ...] = ()
    for _ in range(60):
        avoidance = int(rng.integers(program.num_avoidances))
        possible = rater.table[avoidance][rater.table[avoidance] >= 0]
        kept = tuple(c for c in chosen if rng.random() < 0.8)
        chosen = (*kept, int(rng.choice(possible)))
        for lp in (compiled, python):
            lp.activate(chosen)
        for _ in range(3):
            outcome, _ = python.solve()
            assert compiled.solve()[0] is outcome
            if outcome is not LpOutcome.OPTIMAL:
                break
            # Both are asked about the same point: vertices may differ in the last bits.
            point = python.point()
            rating = rater.rate(point[: program.num_columns])
            answers = {lp.refine(rating, point, 1e-6) for lp in (compiled, python)}
            assert len(answers) == 1
            refined += answers == {True}
    for one, other in zip(contents(compiled), contents(python), strict=True):
        assert one == pytest.approx(other, rel=1e-9, abs=1e-12)
    assert refined > 5 or scene == "no noise"


def test_rows_switched_off_are_dropped_before_they_crowd() -> None:
    rater = rater_of(clutter(1, 20, 0))
    lp = RiskLp(rater.program, UNIT, PRICE, (), rater)
    most = 0
    for avoidance in range(rater.program.num_avoidances):
        lp.activate((int(rater.table[avoidance].max()),))
        most = max(most, lp._lp.num_rows)
    assert 400 < most < 450


def test_rows_are_switched_on_however_many_a_program_has_without_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # Polygons within limits of norms: 540 rows of three vehicles.
    there = circle(3)
    normed = [replace(v, control_limit=None, control_norm=2.0) for v in there.vehicles]
    rater = rater_of(replace(there, vehicles=tuple(normed)))
    program = rater.program
    assert program.hard.shape[0] > 500
    for lp in (RiskLp(program, UNIT, PRICE), by_python(monkeypatch, rater, ())):
        lp.activate((0,))
        starts, (_, bound) = lp.starts, lp.solve()
        # Half of the alternatives stand across the path of least effort.
        bounds = []
        for alternative in range(min(program.num_alternatives, 40)):
            lp.activate((alternative,))
            bounds.append(lp.solve()[1])
        assert max(bounds) > bound * 1.01
        assert lp.starts == starts
    tree = RiskTree(program, UNIT, PRICE, gap=1e-3, scale=1e-3, limits=Limits())
    tree.run(2_000)
    assert tree.value <= tree.bound * (1.0 + 1.1e-3)


@pytest.mark.parametrize("scene", SCENES)
def test_searches_prove_what_those_by_python_do(
    scene: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario, _ = SCENES[scene]
    found = []
    for is_python in (False, True):
        rater = rater_of(scenario)
        tree = RiskTree(
            rater.program, UNIT, PRICE, gap=1e-4, scale=1e-3, limits=Limits(), rater=rater
        )
        if is_python:
            tree._solver._lp = by_python(monkeypatch, rater, ())
        tree.run(3_000)
        found.append((tree.bound, tree.value))
    (bound, value), (other_bound, other_value) = found
    assert bound <= other_value * (1.0 + 1e-9)
    assert other_bound <= value * (1.0 + 1e-9)
    assert value == pytest.approx(other_value, rel=2e-3)


@pytest.mark.parametrize(
    ("change", "kind"),
    [
        ({0: "no program"}, TypeError),
        ({1: "no ratings"}, TypeError),
        ({2: np.zeros(3)}, ValueError),  # deviations
        ({3: np.zeros(1, dtype=np.int32)}, ValueError),  # blocks
        ({4: np.array([99], dtype=np.int32), 5: np.ones((1, 3), dtype=bool)}, ValueError),
        ({7: np.ones(7)}, ValueError),  # slopes
        ({9: 99}, ValueError),  # the budget's row
    ],
)
def test_what_does_not_fit_is_refused(change: dict[int, object], kind: type[Exception]) -> None:
    rater = rater_of(paper(3, 0))
    program, first = rater.program, rater.tangents.first
    lp = RiskLp(program, UNIT, PRICE, (), rater)
    given: list[object] = [
        lp._lp.compiled,
        rater.compiled,
        program.rows.deviations,
        program.blocks.astype(np.int32),
        np.zeros(0, dtype=np.int32),
        np.zeros((0, 3), dtype=bool),
        first.clearances,
        first.slopes,
        first.heights,
        lp._lp.num_rows - 1,
        *(UNIT, PRICE, 1.0, 0.2, 0.8, 5.0),
    ]
    rows = _compiled.RiskRows(*given)
    with pytest.raises(ValueError, match="alternative"):
        rows.activate((program.num_alternatives,), 400, 12)
    with pytest.raises(ValueError, match="lengths"):
        rows.refine(np.zeros(3), np.zeros(3), 0.0)
    for place, value in change.items():
        given[place] = value
    with pytest.raises(kind):
        _compiled.RiskRows(*given)
