"""What stands in the way of a plan, as a value."""

from __future__ import annotations

from radmpc.arrays import Matrix
from radmpc.records import dataclass

__all__ = ["WhyNot"]


@dataclass(frozen=True, slots=True, eq=False)
class WhyNot:
    """What stands in the way of a plan.

    Attributes
    ----------
    explanation : str
        In sentences, naming vehicles, obstacles and times.
    is_proven : bool
        Whether the half-spaces searched, finer ones included, leave no plan; no proof against
        others. Otherwise none was found.
    controls : tuple of (T, m) array
        The safest plan found meanwhile, for the referee to judge; empty without one.
    sets : tuple of tuple of int
        Vehicles that were planned together in it.
    rules_out_any : bool
        Whether what is proven leaves no plan by any half-spaces, within the polytopes that programs
        keep to in place of limits of norms.
    blocked : tuple of int
        Vehicles for which the faces of the scenario leave no plan; empty where faces do not
        matter.
    """

    explanation: str
    is_proven: bool
    controls: tuple[Matrix, ...] = ()
    sets: tuple[tuple[int, ...], ...] = ()
    blocked: tuple[int, ...] = ()
    rules_out_any: bool = False
