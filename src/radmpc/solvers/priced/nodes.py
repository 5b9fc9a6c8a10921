"""What a search over faces and risks finds, and what it leaves open."""

from __future__ import annotations

from dataclasses import dataclass, field

from radmpc.arrays import Indices, Vector

__all__ = ["Frontier", "Incumbent", "Node"]

Frontier = tuple[tuple[float, tuple[int, ...]], ...]
"""Nodes of a search: a lower bound each, and the alternatives chosen."""


@dataclass(frozen=True, slots=True, eq=False)
class Incumbent:
    """A solution.

    Attributes
    ----------
    z : (n,) array
        The point.
    selection : (v,) int array
        Its sides.
    cost, risk : float
        Its cost without risk, and its true risk.
    """

    z: Vector
    selection: Indices
    cost: float
    risk: float


@dataclass(order=True, slots=True)
class Node:
    """A node, ordered by its bound, then deeper first, then older first.

    A dive takes its nodes without looking for them in the heap: they stay there, no longer open,
    until they come to the top. A node that is opened again is queued still, or pushed.
    """

    bound: float
    depth: int
    number: int
    chosen: tuple[int, ...] = field(compare=False)
    is_open: bool = field(compare=False, default=True)
    is_queued: bool = field(compare=False, default=False)
    is_solved: bool = field(compare=False, default=False)
    sides: tuple[int, ...] = field(compare=False, default=())
