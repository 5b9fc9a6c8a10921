"""What CONTRIBUTING says of adding a part: a toy of each kind works with nothing else touched."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.experiments.families import paper
from radmpc.identification.track import Track
from radmpc.importing import formats
from radmpc.importing.formats import import_scenario
from radmpc.importing.logs import reading
from radmpc.importing.logs.reading import read_logs
from radmpc.importing.logs.recording import Recording
from radmpc.importing.problem import ForeignProblem, ForeignVehicle
from radmpc.io.export import exporting
from radmpc.io.export.exporting import export_plan
from radmpc.io.export.job import Job
from radmpc.io.text.document import Document
from radmpc.model.plan import Status
from radmpc.planners import (
    BigM,
    Branch,
    Centralized,
    Decomposition,
    Planner,
    Policy,
    Receding,
    Run,
    Solver,
)
from radmpc.planners.draft import Draft
from radmpc.planners.policies import Family, RiskUse, Solved, SolveRequest
from radmpc.planning import plan
from radmpc.program.allocation import margins_of
from radmpc.solvers.milp.big_m import BACKENDS
from radmpc.solvers.milp.model import MilpAnswer, MilpModel
from radmpc.solvers.solution import Limits, Outcome, Solution


@dataclass(frozen=True, slots=True)
class Cautious(Policy):
    """Half of Δ, spread evenly over all risk items."""

    family: ClassVar[Family] = "fixed"
    needs_proof: ClassVar[bool] = False

    def __str__(self) -> str:
        return "cautious"

    def solve(self, request: SolveRequest) -> Solved:
        """Solve once."""
        program = request.program
        count = len(program.risk_items)
        most = int(np.bincount(program.rows.risk_items, minlength=count).max(initial=1))
        allocation = np.full(count, 0.5 * request.budget / (count * most))
        solution = request.solve(margins_of(program, allocation))
        step = request.step(
            0, solution, RiskUse(allocated=float(allocation.sum()), used=float("nan"))
        )
        return Solved(solution, allocation, (step,))


@dataclass(frozen=True, slots=True)
class Twice(Decomposition):
    """The whole fleet, planned twice: the second plan counts."""

    default_seconds: ClassVar[float | None] = 30.0

    def __str__(self) -> str:
        return "twice"

    def plan(self, scenario, planner: Planner, run: Run) -> Draft:
        """Plan as `Centralized` does, two times."""
        Centralized().plan(scenario, planner, run)
        return Centralized().plan(scenario, planner, run)


@dataclass(frozen=True, slots=True)
class Patient(Solver):
    """`Branch`, asked for a tenth of the gap."""

    def __str__(self) -> str:
        return "patient"

    def solve(self, program, margins, *, gap, limits, start=None, guide=None, rng=None) -> Solution:
        """Minimize the cost at fixed margins."""
        return Branch().solve(
            program, margins, gap=0.1 * gap, limits=limits, start=start, guide=guide, rng=rng
        )


class Scipy:
    """A mixed-integer backend: what SciPy has."""

    name = "scipy"

    def minimize(self, model: MilpModel, gap: float, limits: Limits) -> MilpAnswer:
        """Solve a model, whatever time that takes."""
        del limits
        found = milp(
            model.cost,
            integrality=np.arange(len(model.cost)) >= model.num_continuous,
            bounds=Bounds(model.lower, model.upper),
            constraints=LinearConstraint(model.matrix, model.row_lower, model.row_upper),
            options={"mip_rel_gap": gap},
        )
        outcome = Outcome.INFEASIBLE if found.x is None else Outcome.OPTIMAL
        bound = np.inf if found.x is None else found.mip_dual_bound
        return MilpAnswer(outcome, found.x, bound, found.mip_node_count or 0)


def is_toy(value: object) -> bool:
    """Whether a file's content looks like a problem in the toy format."""
    return isinstance(value, Mapping) and "toys" in value


def read_toy(document: Document) -> ForeignProblem:
    """Return the problem in a toy file: ways, from position to position."""
    still = np.zeros(2)
    vehicles = tuple(
        ForeignVehicle(name, start, goal, still, still, 0.3, 1.5, 1.0)
        for name, (start, goal) in document.value["toys"].items()
    )
    reasons = (("radius", "0.3 m, as toys have"),)
    return ForeignProblem("nursery", "toy", document.name, vehicles, reasons=reasons)


def write_toy(job: Job) -> bytes:
    """Return a plan in the toy format: where its vehicles come to rest."""
    ends = {track.name: track.positions[-1].tolist() for track in job.tracks}
    return json.dumps({"toys": ends}).encode()


def test_a_policy_of_ones_own_plans_with_every_decomposition_that_takes_its_family():
    for decomposition in (Centralized(), Receding(), Twice()):
        result = plan(paper(2, 1), Planner(Cautious(), Branch(), decomposition))
        assert result.status is Status.FEASIBLE
        assert result.is_certified
        assert result.plan.planner == f"cautious, branch, {decomposition}"


def test_a_solver_of_ones_own_is_asked_like_any_other():
    ours = plan(paper(2, 1), Planner(Cautious(), Patient(), Centralized()))
    theirs = plan(paper(2, 1), Planner(Cautious(), Branch(), Centralized(), gap=1e-4))
    assert ours.cost == pytest.approx(theirs.cost, rel=1e-9)


def test_what_does_not_go_together_is_refused_by_what_the_parts_say_of_themselves():
    @dataclass(frozen=True, slots=True)
    class Priced(Cautious):
        family: ClassVar[Family] = "priced"

    with pytest.raises(ScenarioError, match="does not go with 'twice'"):
        Planner(Priced(), Branch(), Twice())


@pytest.mark.slow
def test_a_backend_of_ones_own_finds_what_the_others_find(monkeypatch):
    with pytest.raises(ScenarioError, match="backend must be one of"):
        BigM("scipy")
    monkeypatch.setitem(BACKENDS, "scipy", Scipy)
    ours, theirs = (
        plan(paper(2, 1), Planner(Cautious(), BigM(backend), Centralized()))
        for backend in ("scipy", "highs")
    )
    assert ours.status is theirs.status
    assert ours.plan.planner == "cautious, big_m(scipy), centralized"
    assert ours.cost == pytest.approx(theirs.cost, rel=2e-3)


def test_a_backend_of_ones_own_may_say_that_there_is_no_solution():
    one, row = np.ones(1), csr_array(np.eye(1))
    # A binary that is to be a half.
    model = MilpModel(one, 0.0 * one, one, 0, row, 0.5 * one, 0.5 * one)
    answers = [kind().minimize(model, 1e-3, Limits()) for kind in (Scipy, BACKENDS["highs"])]
    assert [answer.outcome for answer in answers] == [Outcome.INFEASIBLE] * 2
    assert all(answer.x is None for answer in answers)


def test_a_format_of_ones_own_is_read_with_what_it_does_not_say_told(monkeypatch, tmp_path):
    path = tmp_path / "nursery.yaml"
    path.write_text("toys:\n  duck: [[0, 0], [5, 0]]\n  bear: [[5, 4], [0, 4]]\n", encoding="utf-8")
    with pytest.raises(FileFormatError, match="is of no format known here"):
        import_scenario(path)
    toy = formats._Importer("toy", is_toy, read_toy)
    monkeypatch.setattr(formats, "_IMPORTERS", (*formats._IMPORTERS, toy))
    imported = import_scenario(path)
    assert [vehicle.name for vehicle in imported.scenario.vehicles] == ["duck", "bear"]
    assert imported.choices["radius"] == "0.3 m, as toys have"
    assert imported.scenario.source["format"] == "toy"
    assert plan(imported.scenario).is_certified


def test_a_format_of_ones_own_is_written(monkeypatch):
    planned = plan(paper(2, 1), Planner(Cautious(), Branch(), Centralized())).require()
    with pytest.raises(ScenarioError, match="must be one of"):
        export_plan(planned, "toy", "toys.json")
    monkeypatch.setitem(exporting._FLEET, "toy", write_toy)
    # The file makes this of its registries.
    monkeypatch.setattr(exporting, "FORMATS", (*exporting._SINGLE, *exporting._FLEET))
    exported = export_plan(planned, "toy", "toys.json")
    [content] = exported.files.values()
    [v1, _] = planned.trajectories
    assert json.loads(content)["toys"]["v1"] == pytest.approx(v1.means[-1, :2].tolist())


def read_toy_log(path: Path) -> Recording:
    """Return the vehicle of a toy log: a line of numbers, its place at every second."""
    x = np.array([float(word) for word in path.read_text(encoding="utf-8").split()])
    places = np.column_stack([x, 0.0 * x])
    return Recording((Track("duck", str(path), str(path), np.arange(float(len(x))), places),))


def test_a_format_of_logs_of_ones_own_is_read(monkeypatch, tmp_path):
    path = tmp_path / "pond.quack"
    path.write_text("0 1 2.5 4", encoding="utf-8")
    with pytest.raises(FileFormatError, match=r"a log must end in .*, or be the folder of a bag"):
        read_logs([path])
    monkeypatch.setitem(reading._READERS, ".quack", read_toy_log)
    [track] = read_logs([path]).tracks
    assert track.name == "duck"
    assert track.positions[:, 0].tolist() == [0.0, 1.0, 2.5, 4.0]
    with pytest.raises(FileFormatError, match=r"\.quack"):
        read_logs([tmp_path / "pond.moo"])
