"""The best certified plan of a fleet so far."""

from __future__ import annotations

from radmpc.arrays import Matrix
from radmpc.planners.certified.merging import Members
from radmpc.records import dataclass

__all__ = ["FleetIncumbent"]


@dataclass(frozen=True, slots=True, eq=False)
class FleetIncumbent:
    """The best certified plan; without any, what a plan is compared with.

    Attributes
    ----------
    controls : tuple of (T, m) array
        Its controls, in the scenario's order; empty without a plan.
    cost : float
        Its cost; inf without a plan.
    sets : tuple of tuple of int
        Vehicles that were planned together.
    union_bound : float
        What its union bounds sum to beyond the starts, at most [-]; of a plan by turned
        half-spaces, those of the plan by faces that it began with.
    certified : float
        Its certificate [-].
    turned_price : float or None
        What a little more Δ would save by half-spaces turned to the last plan that had any, per
        unit of probability; None if none had.
    risk_ratio : float
        What the risks of those half-spaces summed to, over the certificate [-].
    """

    controls: tuple[Matrix, ...] = ()
    cost: float = float("inf")
    sets: tuple[Members, ...] = ()
    union_bound: float = 0.0
    certified: float = 0.0
    turned_price: float | None = None
    risk_ratio: float = 1.0
