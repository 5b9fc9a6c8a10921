"""The bound on any certified plan, set by set, at the shadow price of the plan at hand."""

from __future__ import annotations

from types import MappingProxyType

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.proof.grouping import Proven
from radmpc.planners.certified.proof.tuning import TUNING
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.records import dataclass
from radmpc.solvers.solution import relative_gap

__all__ = ["Proof", "bound_on_any"]


@dataclass(frozen=True, slots=True, eq=False)
class Proof:
    """What the relaxation says.

    Attributes
    ----------
    bound : float
        No plan that the referee would certify costs less; at most the cost of the plan at hand.
    controls : tuple of (T, m) array
        The best plan of the relaxation, in the scenario's order: it risks too much, by a little,
        but its sides may be better ones. Empty where it is the plan at hand.
    is_outside : bool
        Whether that plan may be beyond the limits that programs keep.
    """

    bound: float
    controls: tuple[Matrix, ...] = ()
    is_outside: bool = False


def bound_on_any(
    fleet: Fleet,
    incumbent: FleetIncumbent,
    price: float | None,
    most_nodes: float = float("inf"),
    proven: Proven = MappingProxyType({}),
) -> Proof:
    """Return a lower bound on the cost of any plan that the referee would certify.

    Parameters
    ----------
    fleet : Fleet
        The fleet, with the limits that end the proof.
    incumbent : FleetIncumbent
        The plan at hand.
    price : float or None
        Its shadow price of Δ, per unit of probability; None where it is not known.
    most_nodes : float
        Nodes after which no set is searched on [-].
    proven : mapping of tuple of int to mapping of tuple of int to RelaxedSet
        What is known of parts, from the proof around another plan.

    Returns
    -------
    Proof
        Its bound is what the vehicles cost alone in empty space, at least.
    """
    base = float(sum(fleet.base))
    cost = incumbent.cost
    if relative_gap(cost, base) <= TUNING.gap:
        return Proof(min(base, cost))
    # A vehicle that nothing stops costs no more than in empty space.
    from radmpc.planners.certified.proof.search import BoundSearch  # noqa: PLC0415 - vehicles without conflicts do without

    search = BoundSearch(fleet, incumbent, price or 0.0, base, most_nodes, proven=dict(proven))
    search.run()
    return Proof(min(search.best, cost), search.relaxed_controls())
