"""What a decomposition hands over. Knows no algorithm."""

from __future__ import annotations

from collections.abc import Mapping

from radmpc.arrays import Matrix
from radmpc.model.plan import Coupling, FirstPlan, Status
from radmpc.records import dataclass

__all__ = ["Draft", "Event", "Step"]


@dataclass(frozen=True, slots=True)
class Step:
    """The record of one solve.

    Attributes
    ----------
    stage : str
        Which stage made it.
    vehicles : tuple of str
        Which vehicles were planned.
    iteration : int
        Counts from 0 within the stage and set.
    cost : float
        Cost of the solve.
    num_active, num_chosen : int
        Risk items that used all their risk, and risk items with a chosen row.
    allocated : float
        Risk that the chosen rows were allocated [-].
    used : float
        Risk that they run [-].
    gap : float
        Relative gap of the solve [-].
    nodes : int
        Nodes of its search tree.
    seconds : float
        Time taken.
    """

    stage: str
    vehicles: tuple[str, ...]
    iteration: int
    cost: float
    num_active: int
    num_chosen: int
    allocated: float
    used: float
    gap: float
    nodes: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Event:
    """A departure from the paper's pseudo-code: a subproblem without a solution.

    Attributes
    ----------
    step : int
        When.
    vehicle : str
        Whose subproblem had no solution.
    blocked_by : tuple of str
        The vehicles in its way; it is coupled with them.
    """

    step: int
    vehicle: str
    blocked_by: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Draft:
    """What a decomposition hands back before the referee sees it.

    Attributes
    ----------
    status : Status
        How it ended.
    controls : tuple of (T, m) array
        Nominal controls, in the scenario's order; empty without a plan.
    sets : tuple of tuple of int
        Vehicles planned together.
    steps : tuple of Step
        The solves.
    events : tuple of Event
        Departures from the paper's pseudo-code.
    seconds : mapping
        Seconds per stage.
    explanation : str or None
        Why there is no plan, or what it took to find this one.
    lower_bound : float or None
        Proven least cost of the program, where there is a proof.
    certified_lower_bound : float or None
        Proven least cost of any plan that the referee would certify, where there is a proof.
    price : float or None
        Shadow price of Δ: what a little more of it would save, per unit of probability.
    couplings : tuple of Coupling
        Why the vehicles of a set were planned together.
    rules_out_any : bool
        Whether an infeasible status holds of any plan that the referee would certify, not of plans
        by the half-spaces that were searched alone.
    stopped_by : str or None
        The limit that ended the search, as a clause; None where the caller's own limits tell.
    first : FirstPlan or None
        When the first certified plan was there; None where none was told of.
    """

    status: Status
    controls: tuple[Matrix, ...]
    sets: tuple[tuple[int, ...], ...]
    steps: tuple[Step, ...]
    events: tuple[Event, ...]
    seconds: Mapping[str, float]
    explanation: str | None = None
    lower_bound: float | None = None
    certified_lower_bound: float | None = None
    price: float | None = None
    couplings: tuple[Coupling, ...] = ()
    stopped_by: str | None = None
    rules_out_any: bool = False
    first: FirstPlan | None = None
