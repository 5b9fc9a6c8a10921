"""What a search over alternatives and risks finds, and what it leaves open."""

from __future__ import annotations

from enum import IntEnum

from radmpc.arrays import Indices, Vector
from radmpc.records import dataclass
from radmpc.solvers.diving import OpenNode

__all__ = ["Frontier", "Incumbent", "Node", "NodeState"]

Frontier = tuple[tuple[float, tuple[int, ...]], ...]
"""Nodes of a search: a lower bound each, and the alternatives chosen."""


class NodeState(IntEnum):
    """What became of a node, by the numbers of compiled code (`compiled/node.h`).

    OPEN: it is branched on. PARKED: nothing below it matters now. DROPPED: there is nothing below
    it. CROWDED: nothing was done, as there are too many rows. UNSOLVED: a linear program that
    matters was not solved.
    """

    OPEN = 0
    PARKED = 1
    DROPPED = 2
    CROWDED = 3
    UNSOLVED = 4


@dataclass(frozen=True, slots=True, eq=False)
class Incumbent:
    """A solution.

    Attributes
    ----------
    z : (n,) array
        The point.
    selection : (v,) int array
        The alternative chosen for each avoidance.
    cost, risk : float
        Its cost without risk, and its true risk.
    """

    z: Vector
    selection: Indices
    cost: float
    risk: float


@dataclass(slots=True, eq=False)
class Node(OpenNode):
    """An open node, with the result of its linear program once that has been solved.

    Attributes
    ----------
    is_solved : bool
        Whether it has been.
    alternatives : tuple of int
        The alternatives to branch on; empty where there is nothing left to decide.
    basis : (int, bytes)
        Where its linear program ended, for those of its children to begin with; see `RiskLp`.
    """

    is_solved: bool = False
    alternatives: tuple[int, ...] = ()
    basis: tuple[int, bytes] = (0, b"")
