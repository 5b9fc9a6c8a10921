"""Joint routes of all vehicles over the nodes of a graph, for knots that no priorities undo.

LaCAM (Okumura 2023): a depth-first search over configurations, the nodes of all vehicles at a tick,
that adds which vehicle must go where lazily. Configurations are proposed by priority inheritance
with backtracking (PIBT, Okumura et al. 2022), with swaps in narrow passages (`swapping`). It finds
a solution if there is any and time allows.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from typing import Self

import numpy as np

from radmpc.planners.certified.turned.narrow.swapping import Swapping
from radmpc.records import dataclass, field

__all__ = ["Configuration", "GoalGraph", "Neighbors", "joint_search"]

_UNREACHED = 1 << 30
"""Distance of nodes from which a goal is out of reach [edges]."""

Configuration = tuple[int, ...]
"""The node of every vehicle."""

Neighbors = Sequence[Sequence[int]]
"""Nodes next to each node."""


@dataclass(frozen=True, slots=True, eq=False)
class GoalGraph:
    """A graph, and how far its nodes are from the goals.

    Attributes
    ----------
    neighbors : sequence of sequence of int
        Nodes next to each node.
    distances : sequence of sequence of int
        Edges from each node to the goal of each vehicle [-].
    """

    neighbors: Neighbors
    distances: Sequence[Sequence[int]]

    @classmethod
    def to(cls, goals: Configuration, neighbors: Neighbors) -> Self:
        """Return the graph with the distances to goals.

        Parameters
        ----------
        goals : tuple of int
            Where vehicles want to be.
        neighbors : sequence of sequence of int
            Nodes next to each node.
        """
        return cls(neighbors, [_edges_to(neighbors, goal) for goal in goals])


@dataclass(frozen=True, slots=True, eq=False)
class _Constraint:
    """Which vehicle must go where next: one after the other, from the last."""

    vehicle: int = -1
    node: int = -1
    before: _Constraint | None = None
    depth: int = 0


@dataclass(slots=True, eq=False)
class _Visit:
    """A configuration, where it came from, and what of it was not tried yet."""

    here: Configuration
    before: _Visit | None
    priorities: tuple[float, ...]
    order: tuple[int, ...]
    untried: deque[_Constraint] = field(default_factory=deque)


def joint_search(
    graph: GoalGraph,
    starts: Configuration,
    goals: Configuration,
    max_visits: int,
    rng: np.random.Generator,
    is_stopped: Callable[[], bool],
) -> list[Configuration]:
    """Return configurations from starts to goals: no two vehicles at a node, or across an edge.

    Parameters
    ----------
    graph : GoalGraph
        With the distances to these goals.
    starts, goals : tuple of int
        Where vehicles are and want to be; no node twice in either.
    max_visits : int
        Configurations that are looked at, at most [-].
    rng : Generator
        Chooses among nodes that are as near to a goal.
    is_stopped : callable
        Returns True once it is time to stop.

    Returns
    -------
    list of tuple of int
        One per tick, the starts first; empty where none was found.
    """
    neighbors, distances = graph.neighbors, graph.distances
    if any(d[start] >= _UNREACHED for d, start in zip(distances, starts, strict=True)):
        return []
    proposals = _Proposals(graph, rng)
    first = _Visit(
        starts,
        None,
        tuple(d[s] / len(neighbors) for d, s in zip(distances, starts, strict=True)),
        (),
    )
    first.order = _ordered(first.priorities)
    first.untried.append(_Constraint())
    stack, known = [first], {starts: first}
    for _ in range(max_visits):
        if not stack or is_stopped():
            return []
        visit = stack[-1]
        if visit.here == goals:
            return _traced(visit)
        if not visit.untried:
            stack.pop()
            continue
        constraint = _next_constraint(visit, neighbors)
        following = proposals.next(visit, constraint)
        if following is None:
            continue
        if following not in known:
            known[following] = _visit_after(visit, following, goals)
        stack.append(known[following])
    return []


def _next_constraint(visit: _Visit, neighbors: Neighbors) -> _Constraint:
    """Return the next constraint to try, and queue those that add another vehicle to it."""
    constraint = visit.untried.popleft()
    if constraint.depth < len(visit.here):
        vehicle = visit.order[constraint.depth]
        for node in (*neighbors[visit.here[vehicle]], visit.here[vehicle]):
            visit.untried.append(_Constraint(vehicle, node, constraint, constraint.depth + 1))
    return constraint


def _visit_after(visit: _Visit, following: Configuration, goals: Configuration) -> _Visit:
    """Return the first visit to a configuration: the longest wait comes first."""
    priorities = tuple(
        p + 1.0 if following[i] != goals[i] else p - float(np.floor(p))
        for i, p in enumerate(visit.priorities)
    )
    return _Visit(following, visit, priorities, _ordered(priorities), deque([_Constraint()]))


def _ordered(priorities: Sequence[float]) -> tuple[int, ...]:
    """Return vehicles by priority, the highest first."""
    return tuple(sorted(range(len(priorities)), key=lambda i: -priorities[i]))


def _edges_to(neighbors: Neighbors, goal: int) -> list[int]:
    """Return how many edges each node is from a goal."""
    found = [_UNREACHED] * len(neighbors)
    found[goal] = 0
    queue = deque([goal])
    while queue:
        node = queue.popleft()
        for other in neighbors[node]:
            if found[other] == _UNREACHED:
                found[other] = found[node] + 1
                queue.append(other)
    return found


def _traced(visit: _Visit | None) -> list[Configuration]:
    """Return the configurations that led to one."""
    found = []
    while visit is not None:
        found.append(visit.here)
        visit = visit.before
    return found[::-1]


class _Proposals:
    """Next configurations by priority inheritance with backtracking."""

    def __init__(self, graph: GoalGraph, rng: np.random.Generator) -> None:
        self._neighbors, self._distances, self._rng = graph.neighbors, graph.distances, rng
        self._swapping = Swapping(graph.neighbors, graph.distances)
        self._here: Configuration = ()
        self._at: dict[int, int] = {}
        self._next: list[int] = []
        self._taken: dict[int, int] = {}

    def next(self, visit: _Visit, constraint: _Constraint) -> Configuration | None:
        """Return a configuration to go to next; None where none keeps to the constraint."""
        self._here, self._at = visit.here, {node: i for i, node in enumerate(visit.here)}
        self._next, self._taken = [-1] * len(visit.here), {}
        each: _Constraint | None = constraint
        while each is not None and each.vehicle >= 0:
            if not self._is_free(each.vehicle, each.node):
                return None
            self._take(each.vehicle, each.node)
            each = each.before
        for i in visit.order:
            if self._next[i] < 0 and not self._move(i):
                return None
        return tuple(self._next)

    def _is_free(self, vehicle: int, node: int) -> bool:
        """Whether a vehicle may go to a node: none goes there, or comes toward it from there."""
        if node in self._taken:
            return False
        other = self._at.get(node)
        return other is None or other == vehicle or self._next[other] != self._here[vehicle]

    def _take(self, vehicle: int, node: int) -> None:
        self._next[vehicle] = node
        self._taken[node] = vehicle

    def _move(self, vehicle: int) -> bool:
        """Move a vehicle toward its goal, others out of its way; tell whether it found a node."""
        here, distance = self._here[vehicle], self._distances[vehicle]
        nodes = [*self._neighbors[here], here]
        ties = self._rng.random(len(nodes)).tolist()
        costs = [distance[node] + (0.5 if node in self._at else 0.0) for node in nodes]
        ordered = [node for _, _, node in sorted(zip(costs, ties, nodes, strict=True))]
        pulled = self._swapping.partner(vehicle, self._here, self._next, self._at, ordered[0])
        if pulled is not None:
            costs = [cost - 2.0 * distance[node] for cost, node in zip(costs, nodes, strict=True)]
            ordered = [node for _, _, node in sorted(zip(costs, ties, nodes, strict=True))]
        for node in ordered:
            if not self._is_free(vehicle, node):
                continue
            self._take(vehicle, node)
            other = self._at.get(node)
            if other is None or other == vehicle or self._next[other] >= 0 or self._move(other):
                if pulled is not None and node == ordered[0] and self._next[pulled] < 0:
                    self._pull(pulled, here)
                return True
            # No vehicle leaves that node: the one that inherited stays where it tried to go.
            if self._taken.get(node) == vehicle:
                del self._taken[node]
        self._take(vehicle, here)
        return False

    def _pull(self, vehicle: int, node: int) -> None:
        """Have a vehicle follow to where another one leaves, if no other goes there."""
        if self._is_free(vehicle, node):
            self._take(vehicle, node)
