"""The value of points in the priced problem, and differences of value that count as none."""

from __future__ import annotations

from radmpc.arrays import Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.priced.rating import Rating
from radmpc.solvers.priced.tuning import TUNING

__all__ = ["ROUNDING", "Precision", "negligible_difference", "priced_value"]

ROUNDING = 1e-6
"""How far a row held at its cap may exceed it by the linear solver's tolerance [-]. Such a point
is a candidate at a price only: its risks are rescaled to the bound exactly afterwards."""


@dataclass(frozen=True, slots=True)
class Precision:
    """How exact a search is.

    Attributes
    ----------
    gap : float
        Relative gap at which it stops [-].
    scale : float
        Values below this count as this in relative gaps.
    rounds : int
        Times that a node's linear program is solved at most, with ever more tangents [-].
    most_units : float
        Units of risk that a candidate may run in all [-].
    missing : float
        Units by which the risk of chosen rows may be underestimated where a point is beyond that
        in truth [-]; more tangents otherwise. inf is as elsewhere.
    """

    gap: float
    scale: float
    rounds: int = 8
    most_units: float = TUNING.overdrawn
    missing: float = float("inf")


def priced_value(
    program: DisjunctiveProgram,
    z: Vector,
    rating: Rating,
    *,
    unit: float,
    price: float,
    row_cap: float,
    most_units: float = TUNING.overdrawn,
) -> float:
    """Return ``cost(z) + price · risk(z) / unit``; inf where z is no candidate.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    z : (n,) array
        The point.
    rating : Rating
        Its rating.
    unit : float
        Risk budget.
    price : float
        Cost of one unit of risk.
    row_cap : float
        Most that one row may risk.
    most_units : float
        Units of risk that a candidate may run in all [-].

    Returns
    -------
    float
        inf where one row, or all together, exceed what they may risk by far.
    """
    if rating.largest > row_cap * (1.0 + ROUNDING):
        return float("inf")
    if rating.risk > most_units * unit:
        return float("inf")
    return float(program.cost @ z) + price * rating.risk / unit


def negligible_difference(value: float, gap: float, scale: float) -> float:
    """Return the difference of value that counts as none.

    Parameters
    ----------
    value : float
        What is compared; inf where nothing is known.
    gap : float
        Relative gap of the search.
    scale : float
        Values below this count as this.
    """
    return TUNING.tie * gap * max(abs(value) if value < float("inf") else 0.0, scale)
