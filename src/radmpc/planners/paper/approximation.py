"""What RADMPC hands to the stages after it."""

from __future__ import annotations

from radmpc.arrays import Matrix
from radmpc.planners.draft import Event, Step
from radmpc.records import dataclass

__all__ = ["Approximation"]


@dataclass(frozen=True, slots=True, eq=False)
class Approximation:
    """What RADMPC found.

    Attributes
    ----------
    controls : tuple of (T, m) array or None
        Executed controls per vehicle; None if some vehicle has no plan even alone, or a limit
        was hit.
    pair_risk : (N, N) array
        Entry (i, j): largest collision probability of i with j's temporal obstacle at the first
        step of i's subproblems.
    forced : tuple of (int, int)
        Couplings of vehicles whose subproblem had no solution with those in their way.
    pool : tuple of float
        The risk pool Δ# after each subproblem.
    steps : tuple of Step
        The subproblems.
    events : tuple of Event
        Subproblems without a solution.
    stuck : tuple of int
        Vehicles without any plan.
    is_limited : bool
        Whether a limit ended it.
    """

    controls: tuple[Matrix, ...] | None
    pair_risk: Matrix
    forced: tuple[tuple[int, int], ...]
    pool: tuple[float, ...]
    steps: tuple[Step, ...]
    events: tuple[Event, ...]
    stuck: tuple[int, ...] = ()
    is_limited: bool = False
