"""A mixed-integer linear program as a value, and the interface of backends that solve it."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from scipy.sparse import csr_array, vstack

from radmpc.arrays import Vector
from radmpc.records import dataclass, replace
from radmpc.solvers.solution import Limits, Outcome

__all__ = ["Backend", "MilpAnswer", "MilpModel"]


@dataclass(frozen=True, slots=True, eq=False)
class MilpModel:
    """Minimize ``cost @ x`` with ``row_lower <= matrix @ x <= row_upper``.

    Attributes
    ----------
    cost, lower, upper : (n,) array
        Costs and bounds of the columns.
    num_continuous : int
        The columns after this many are binary.
    matrix : (r, n) sparse array
        Row coefficients.
    row_lower, row_upper : (r,) array
        Row bounds, ±inf where there is none.
    """

    cost: Vector
    lower: Vector
    upper: Vector
    num_continuous: int
    matrix: csr_array
    row_lower: Vector
    row_upper: Vector

    def costing_at_most(self, cost: float) -> MilpModel:
        """Return the program of those points only that cost no more than this.

        Parameters
        ----------
        cost : float
            The most that a point may cost.
        """
        return replace(
            self,
            matrix=csr_array(vstack([self.matrix, csr_array(self.cost[None, :])])),
            row_lower=np.append(self.row_lower, -np.inf),
            row_upper=np.append(self.row_upper, cost),
        )


@dataclass(frozen=True, slots=True, eq=False)
class MilpAnswer:
    """The answer of a backend.

    Attributes
    ----------
    outcome : Outcome
        How it ended.
    x : (n,) array or None
        The best point.
    bound : float
        Proven lower bound.
    nodes : int
        Nodes of its tree.
    """

    outcome: Outcome
    x: Vector | None
    bound: float
    nodes: int


class Backend(Protocol):
    """A mixed-integer solver."""

    @property
    def name(self) -> str:
        """What users call it."""
        ...

    def minimize(self, model: MilpModel, gap: float, limits: Limits) -> MilpAnswer:
        """Solve a model to a relative gap, or until a limit.

        Parameters
        ----------
        model : MilpModel
            The mixed-integer program.
        gap : float
            Relative gap at which to stop.
        limits : Limits
            When to stop early.
        """
        ...
