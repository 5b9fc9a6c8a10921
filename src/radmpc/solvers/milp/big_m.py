r"""The paper's encoding: one binary per alternative, rows switched off by a large M.

.. math:: h^\top y \le g - m + M b,\qquad \sum_j b_j \le \mathrm{card}(O) - 1

(paper, section Avoidance Constraints.) M is as small as reach allows, row by row: solvers accept
1e-6 of integrality slack, which a large M turns into meters.
"""

from __future__ import annotations

import time

import numpy as np
from scipy.sparse import block_array, coo_array, csr_array, eye_array

from radmpc.arguments import value_text
from radmpc.arrays import Indices, Vector
from radmpc.errors import ScenarioError
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.lp.one_selection import solve_selection
from radmpc.solvers.milp.gurobi import GurobiBackend
from radmpc.solvers.milp.highs import HighsBackend
from radmpc.solvers.milp.model import Backend, MilpModel
from radmpc.solvers.milp.scip import ScipBackend
from radmpc.solvers.selection import least_violated, violations_of
from radmpc.solvers.solution import Guide, Limits, Outcome, Solution, Solver, relative_gap

__all__ = ["BACKENDS", "BigM"]

BACKENDS: dict[str, type[Backend]] = {
    "highs": HighsBackend,
    "scip": ScipBackend,
    "gurobi": GurobiBackend,
}
"""Backends by name."""

_ROUNDING = 1e-6
"""By how much the bounds of outputs are widened [m]: they are exact only up to rounding."""


@dataclass(frozen=True, slots=True)
class BigM(Solver):
    """The disjunctions as a mixed-integer program.

    Attributes
    ----------
    backend : {'highs', 'scip', 'gurobi'}
        The mixed-integer solver.
    """

    backend: str = "highs"

    def __post_init__(self) -> None:
        """Refuse unknown backends."""
        if not (isinstance(self.backend, str) and self.backend in BACKENDS):
            names = ", ".join(BACKENDS)
            raise ScenarioError(f"backend must be one of {names}, got {value_text(self.backend)}")

    def __str__(self) -> str:
        return "big_m" if self.backend == "highs" else f"big_m({self.backend})"

    def solve(
        self,
        program: DisjunctiveProgram,
        margins: Vector,
        *,
        gap: float,
        limits: Limits,
        start: Indices | None = None,
        guide: Guide | None = None,
        rng: np.random.Generator | None = None,
    ) -> Solution:
        """Minimize the cost at fixed margins; see `radmpc.solvers.solution.Solver`.

        Parameters
        ----------
        program, margins, gap, limits
            As there.
        start, guide
            Ignored: the paper's method starts every solve afresh.
        rng
            Ignored: the backends are deterministic.
        """
        del start, guide, rng
        begun = time.perf_counter()
        nothing = Solution(Outcome.INFEASIBLE, None, None, float("inf"), float("inf"))
        if np.any(program.upper < program.lower) or np.any(np.diff(program.avoidance_starts) == 0):
            return nothing
        answer = BACKENDS[self.backend]().minimize(encode(program, margins), gap, limits)
        seconds = time.perf_counter() - begun
        if answer.x is None:
            return Solution(
                answer.outcome, None, None, float("inf"), answer.bound, answer.nodes, 0, seconds
            )
        z = answer.x[: program.num_columns]
        selection = least_violated(program, violations_of(program, margins, z))
        repaired = solve_selection(program, margins, selection)
        if repaired.z is None:
            # Only the integrality slack made the point feasible: it is no solution.
            return Solution(
                Outcome.LIMIT, None, None, float("inf"), answer.bound, answer.nodes, 0, seconds
            )
        cost, z = repaired.cost, repaired.z
        bound = min(answer.bound, cost)
        closed = relative_gap(cost, bound) <= gap * (1.0 + 1e-6) + 1e-9
        return Solution(
            outcome=Outcome.OPTIMAL if closed else Outcome.FEASIBLE,
            z=z,
            selection=selection,
            cost=cost,
            bound=bound,
            nodes=answer.nodes,
            lps=0,
            seconds=time.perf_counter() - begun,
        )


def encode(program: DisjunctiveProgram, margins: Vector) -> MilpModel:
    """Return the mixed-integer program of a disjunctive one at fixed margins.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program; no avoidance without alternatives.
    margins : (r,) array
        Back-off of each row [m].

    Returns
    -------
    MilpModel
        Columns z, then the outputs that rows see, then one binary ``is_off`` per alternative.
    """
    rows, num_columns = program.rows, program.num_columns
    # The outputs that rows see are columns of their own: rows over them have few entries, rows
    # over controls many, which costs mixed-integer solvers up to three times the time.
    seen = np.flatnonzero(abs(rows.normals).sum(axis=0) > 0.0)
    outputs = csr_array(program.outputs[seen])
    num_seen, num_off = seen.size, program.num_alternatives
    big_m = _largest_excess(program, margins)
    switch = coo_array(
        (-big_m, (program.alternative_rows, program.entry_owners())), shape=(rows.count, num_off)
    )
    sizes = np.diff(program.avoidance_starts)
    choices = (program.layout.owners, np.arange(num_off))
    cover = coo_array((np.ones(num_off), choices), shape=(sizes.size, num_off))
    matrix = block_array(
        [
            [program.hard, csr_array((program.hard.shape[0], num_seen)), None],
            [outputs, -eye_array(num_seen), None],
            [None, csr_array(rows.normals)[:, seen], switch],
            [None, None, cover],
        ],
        format="csr",
    )
    constant = program.constant[seen]
    unbounded = np.full(rows.count + sizes.size, -np.inf)
    return MilpModel(
        cost=np.concatenate([program.cost, np.zeros(num_seen + num_off)]),
        lower=np.concatenate(
            [program.lower, program.output_lower[seen] - _ROUNDING, np.zeros(num_off)]
        ),
        upper=np.concatenate(
            [program.upper, program.output_upper[seen] + _ROUNDING, np.ones(num_off)]
        ),
        num_continuous=num_columns + num_seen,
        matrix=csr_array(matrix),
        row_lower=np.concatenate([program.hard_lower, -constant, unbounded]),
        row_upper=np.concatenate(
            [program.hard_upper, -constant, rows.offsets - margins, sizes - 1.0]
        ),
    )


def _largest_excess(program: DisjunctiveProgram, margins: Vector) -> Vector:
    """Return by how much each row can be violated within reach: the least valid M, (r,) [m]."""
    normals = program.rows.normals
    up, down = normals.maximum(0.0), normals.minimum(0.0)
    largest = up @ program.output_upper + down @ program.output_lower
    excess: Vector = largest - program.rows.offsets + margins
    return np.maximum(excess, 0.0)
