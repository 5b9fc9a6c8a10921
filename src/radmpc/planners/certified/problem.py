"""One set of vehicles: its program, and how far its search has come."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Tensor, Vector
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.lattice.passage import Passage
from radmpc.planners.certified.lattice.search import PathSearch
from radmpc.planners.certified.tuning import TUNING
from radmpc.planners.policies.policy import SolveRequest
from radmpc.program.build import SharedBlocks, build_program
from radmpc.program.condensed import CondensedModel
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass, replace
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.priced.nodes import Frontier, Incumbent
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.set_bounds import SetBound
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

__all__ = ["Order", "SetProblem", "SetState", "advance"]

_TUNED = TUNING.sets


@dataclass(frozen=True, slots=True, eq=False)
class SetProblem:
    """A set's program, made once.

    Attributes
    ----------
    members : tuple of int
        The vehicles, by their number in the fleet, ascending; block i is member i.
    models : tuple of CondensedModel
        Their condensed models.
    program : DisjunctiveProgram
        Their obstacles, workspace and pairs.
    rater : Rater
        The program laid out for rating.
    passage : Passage or None
        A heuristic for a vehicle alone in the plane.
    """

    members: tuple[int, ...]
    models: tuple[CondensedModel, ...]
    program: DisjunctiveProgram
    rater: Rater
    passage: Passage | None

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        members: tuple[int, ...],
        models: Sequence[CondensedModel],
        unit: float,
        shared: SharedBlocks | None = None,
    ) -> SetProblem:
        """Build the program of some vehicles of a fleet.

        Parameters
        ----------
        scenario : Scenario
            These vehicles alone.
        members : tuple of int
            Their numbers in the fleet, ascending.
        models : sequence of CondensedModel
            Those of the whole fleet.
        unit : float
            The fleet's unit of risk [-], see `radmpc.planners.certified.fleet`.
        shared : SharedBlocks or None
            Rows that programs of the fleet have in common.

        Returns
        -------
        SetProblem
            With a lattice search where it is one vehicle in the plane.
        """
        chosen = tuple(models[i] for i in members)
        program = build_program(scenario, chosen, risk_bound=scenario.risk_bound, shared=shared)
        rater = Rater(program, unit)
        passage = None
        if len(chosen) == 1 and program.num_avoidances and not rater.is_infeasible:
            path_search = PathSearch(program, chosen[0], unit)
            passage = Passage(path_search, rater) if path_search.is_possible else None
        return cls(members, chosen, program, rater, passage)

    def without_cost(self) -> SetProblem:
        """Return the same set with all effort free."""
        program = replace(self.program, cost=np.zeros(self.program.num_columns))
        passage = self.passage
        if passage is not None:
            unit = passage.path_search.unit
            path_search = PathSearch(program, self.models[0], unit)
            path_search.motion = replace(path_search.motion, weight=0.0)
            passage = Passage(path_search, Rater(program, unit))
        return replace(self, program=program, passage=passage)

    def means(self, z: np.ndarray) -> Tensor:
        """Return the mean positions of the members, (n, T+1, d)."""
        program = self.program
        outputs = (program.outputs @ z + program.constant)[: program.num_positions]
        shape = self.models[0].drift_position.shape
        return np.asarray(outputs.reshape(len(self.members), *shape))


@dataclass(frozen=True, slots=True, eq=False)
class SetState:
    """How far the search for a set's best plan has come.

    Attributes
    ----------
    unit_price : float
        Cost of one unit of risk that value and bound refer to.
    best : Incumbent or None
        The best plan at that price.
    bound : float
        Proven least ``cost + unit_price · risk / unit``; inf where no plan exists at any price.
    frontier : Frontier
        What is left of the search.
    nodes : int
        Nodes so far at this price.
    all_nodes : int
        Nodes so far at all prices.
    is_limited : bool
        Whether a limit ended the search.
    """

    unit_price: float
    best: Incumbent | None
    bound: float
    frontier: Frontier
    nodes: int
    all_nodes: int
    is_limited: bool


@dataclass(frozen=True, slots=True, eq=False)
class Order:
    """What is asked of a set.

    Attributes
    ----------
    unit : float
        The fleet's unit of risk [-].
    unit_price : float
        Cost of one unit of risk.
    gap, scale : float
        Relative gap [-], and the value below which it is taken of this instead.
    max_nodes : int
        Nodes to spend now.
    base : float
        What the set costs at least, whatever it risks.
    bounds : tuple of SetBound
        Lower bounds proven for subsets at this price.
    hint : (n,) array or None
        A point to begin with.
    is_rough : bool
        Whether plans are only to tell the price, so that the lattice is not searched.
    """

    unit: float
    unit_price: float
    gap: float
    scale: float
    max_nodes: int
    base: float = 0.0
    bounds: tuple[SetBound, ...] = ()
    hint: Vector | None = None
    is_rough: bool = False


def advance(
    problem: SetProblem, scenario: Scenario, state: SetState | None, order: Order, limits: Limits
) -> SetState:
    """Search on for a set's best plan at a price of risk.

    Parameters
    ----------
    problem : SetProblem
        The set.
    scenario : Scenario
        These vehicles alone.
    state : SetState or None
        Where the search stood, at any price.
    order : Order
        What is asked.
    limits : Limits
        When to stop early.

    Returns
    -------
    SetState
        With a plan where one was found; an infinite bound is a proof that there is none.
    """
    tree = RiskTree(
        problem.program,
        order.unit,
        order.unit_price,
        gap=order.gap,
        scale=order.scale,
        limits=limits,
        bounds=order.bounds,
        rater=problem.rater,
    )
    if state is not None and state.bound < float("inf"):
        tree.resume(state.frontier, state.unit_price, state.best, order.base)
    if order.hint is not None:
        tree.consider(order.hint)
    tree.run(min(order.max_nodes, _TUNED.patience * len(problem.members)))
    if tree.best is None and tree.is_limited and not limits.reached:
        _rescue(problem, scenario, tree, limits)
    has_time = tree.is_limited and not limits.reached
    if problem.passage is not None and has_time and not order.is_rough:
        found = problem.passage.plan(order.unit_price, order.scale, limits, tree.best)
        if found is not None:
            tree.consider(found.z)
    if tree.is_limited and tree.nodes < order.max_nodes:
        tree.run(order.max_nodes - tree.nodes)
    is_same = state is not None and state.unit_price == order.unit_price
    return SetState(
        order.unit_price,
        tree.best,
        _proven(tree, order),
        tree.frontier,
        tree.nodes + (state.nodes if state is not None and is_same else 0),
        tree.nodes + (state.all_nodes if state is not None else 0),
        tree.is_limited,
    )


def _proven(tree: RiskTree, order: Order) -> float:
    """Return the best lower bound on the value of a set's plans: never above the best plan's."""
    # Parts of a set share neither cost nor risk: what single vehicles cost adds up.
    alone = [b.value for b in order.bounds if len(b.blocks) == 1]
    bound = max([tree.bound, sum(alone), *(b.value for b in order.bounds)])
    return bound if tree.best is None else min(bound, tree.value)


def _rescue(problem: SetProblem, scenario: Scenario, tree: RiskTree, limits: Limits) -> None:
    """Look for any plan by iterative risk allocation, which has heuristics for coupled sets."""
    from radmpc.planners.coarse_search import propose_alternatives  # noqa: PLC0415 - few need it
    from radmpc.planners.policies.ira import Ira  # noqa: PLC0415 - few need it

    request = SolveRequest(
        problem.program,
        Branch(_TUNED.rescue_nodes * len(problem.members)),
        1e-2,
        limits,
        "rescue",
        tuple(v.name for v in scenario.vehicles),
        propose=lambda margins: propose_alternatives(
            problem.program, problem.models, margins, limits
        ),
    )
    solved = Ira().solve(request)
    if solved.solution.z is not None:
        tree.consider(solved.solution.z)
