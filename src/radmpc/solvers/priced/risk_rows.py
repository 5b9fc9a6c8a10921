"""Chance rows in a linear program: switched on and off, with tangents to the risk they run.

A chosen row with noise has a column for its risk, shared by the rows of one event, and tangents to
its tail that touch where searches came by. Rows switched off stay in the program without bounds.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

from radmpc.arrays import Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.lp.bounded_lp import BoundedLp
from radmpc.solvers.priced.rating import Rating

__all__ = ["FLAT", "RiskRows", "Surroundings"]

FLAT = 1e-7
"""Share of the unit below which a tangent is no better than t >= 0 [-]: none is added there."""


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """What chance rows are added to.

    Attributes
    ----------
    lp : BoundedLp
        The linear program; its first columns are the decision variables.
    program : DisjunctiveProgram
        Whose rows.
    unit : float
        Risk budget: the risk that a column's 1 stands for.
    price : float
        Cost of one unit of risk.
    row_scale : float
        What rows with prices in them are multiplied by [-].
    budget_row : int
        The row that keeps all risk within the unit.
    bound_rows : tuple of (frozenset of int, int)
        Proven bounds: blocks, and the row that says so.
    crowd : int
        Rows beyond which those switched off are dropped [-], beside some per active row. More than
        there are without chance rows: else none could ever be switched on.
    """

    lp: BoundedLp
    program: DisjunctiveProgram
    unit: float
    price: float
    row_scale: float
    budget_row: int
    bound_rows: tuple[tuple[frozenset[int], int], ...]
    crowd: int


class RiskRows(ABC):
    """The chance rows seen so far, and which of them are on."""

    @abstractmethod
    def activate(self, alternatives: tuple[int, ...]) -> bool:
        """Switch the rows of these alternatives on and all others off, adding those that are new.

        Parameters
        ----------
        alternatives : tuple of int
            Their numbers.

        Returns
        -------
        bool
            False, and nothing is done, where too many rows are switched off: they cost time in
            every pivot.
        """

    @abstractmethod
    def refine(self, rating: Rating, point: Vector, tolerance: float) -> bool:
        """Add tangents where the risk of rows that are on is underestimated.

        Parameters
        ----------
        rating : Rating
            Of the decision variables of a point.
        point : (c,) array
            All columns of it.
        tolerance : float
            Share of the unit by which risks may be underestimated in all [-].

        Returns
        -------
        bool
            Whether any was added.
        """
