"""Joint routes made shorter: a few vehicles at a time are routed anew around all others.

Large neighborhood search for multi-agent path finding (Li et al. 2021). A depth-first search over
configurations ends with the first solution, in which vehicles wander and wait; on 32 x 32 cells 40
of them come 157 ticks late in all, and 15 after 0.3 s of this. A route is a shortest path over
(node, tick), found by A* with the distances in the graph.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from radmpc.planners.certified.turned.narrow.joint_search import Configuration, GoalGraph

__all__ = ["rerouted"]

_FEWEST, _MOST = 2, 8
"""Vehicles that are routed anew together [-]."""

_LAST = 0.5
"""Share of the tries that begin with the last to arrive, others with anyone that is late [-]."""

_BATCH, _ENOUGH = 3, 0.1
"""Tries per vehicle [-] in which the delay of all has to fall by such a share for more to follow:
on 32 x 32 cells 40 robots are done after 6 per vehicle, 0.3 s, and 80 after 12, 3.7 s."""

_SELDOM = 1e-3
"""Weight of a vehicle that is not late, against a tick of delay [ticks]."""

_NOBODY = -1
"""Stands where no vehicle is."""

Route = list[int]
"""Node of a vehicle at every tick."""


def rerouted(
    graph: GoalGraph,
    configurations: Sequence[Configuration],
    tries: int,
    rng: np.random.Generator,
    is_stopped: Callable[[], bool],
) -> list[Configuration]:
    """Return joint routes of as many ticks or fewer; of as many, with less delay and fewer moves.

    Parameters
    ----------
    graph : GoalGraph
        With the distances to their goals.
    configurations : sequence of tuple of int
        One per tick: no two vehicles at a node, or across an edge; the goals last.
    tries : int
        Groups of vehicles that are routed anew [-].
    rng : Generator
        Draws the groups, and their order.
    is_stopped : callable
        Returns True once it is time to stop.

    Returns
    -------
    list of tuple of int
        One per tick.
    """
    routes = _Routes(graph, configurations)
    batch, before = _BATCH * len(configurations[0]), float("inf")
    for number in range(tries):
        if number % batch == 0:
            if routes.delay >= (1.0 - _ENOUGH) * before:
                break
            before = routes.delay
        if is_stopped() or not routes.delay:
            break
        routes.try_anew(routes.group(rng))
    return routes.configurations()


class _Routes:
    """The routes of all vehicles, and which vehicle is where at each tick."""

    def __init__(self, graph: GoalGraph, configurations: Sequence[Configuration]) -> None:
        self._neighbors, self._distances = graph.neighbors, graph.distances
        self._starts, self._goals = configurations[0], configurations[-1]
        self._next = [(*others, node) for node, others in enumerate(graph.neighbors)]
        self._routes: list[Route] = [list(route) for route in zip(*configurations, strict=True)]
        self._moves = [_moves(route) for route in self._routes]
        self._arrivals = [self._arrival(i, route) for i, route in enumerate(self._routes)]
        self._at = [[_NOBODY] * len(graph.neighbors) for _ in configurations]
        for here, nodes in zip(self._at, configurations, strict=True):
            for i, node in enumerate(nodes):
                here[node] = i

    @property
    def delay(self) -> int:
        """Ticks by which vehicles come later than alone, in all [-]."""
        return sum(self._delays())

    def configurations(self) -> list[Configuration]:
        """Return where everyone is, tick by tick, until the last one has arrived."""
        last = max(self._arrivals)
        return list(zip(*(route[: last + 1] for route in self._routes), strict=True))

    def group(self, rng: np.random.Generator) -> list[int]:
        """Draw vehicles, one that is late and others on its way, in the order of their routing."""
        delays = np.array(self._delays())
        count = len(delays)
        if rng.random() < _LAST:
            first = int(np.argmax(np.array(self._arrivals) + rng.random(count)))
        else:
            weights = delays + _SELDOM
            first = int(rng.choice(count, p=weights / weights.sum()))
        way = {*self._routes[first], *self._shortest(first, rng)}
        beside = {here[node] for here in self._at for node in way} - {_NOBODY, first}
        drawn = rng.permutation(sorted(beside))[: int(rng.integers(_FEWEST, _MOST + 1)) - 1]
        return [int(i) for i in rng.permutation([first, *drawn.tolist()])]

    def try_anew(self, group: Sequence[int]) -> None:
        """Route vehicles anew, one after the other; keep that unless it is worse."""
        before = {i: (self._routes[i], self._arrivals[i]) for i in group}
        worth = self._worth()
        for i in group:
            self._lift(i)
        is_found = True
        for i in group:
            route = self._route(i)
            if route is None:
                is_found = False
                break
            self._take(i, route, self._arrival(i, route))
        if is_found and self._worth() <= worth:
            return
        for i in group:
            self._lift(i)
        for i, (route, arrival) in before.items():
            self._take(i, route, arrival)

    def _worth(self) -> tuple[int, int, int]:
        """Return the last arrival, what all are late, and how often they move; less is better."""
        return max(self._arrivals), sum(self._arrivals), sum(self._moves)

    def _delays(self) -> list[int]:
        """Return by how many ticks each comes later than alone [-]."""
        triples = zip(self._arrivals, self._distances, self._starts, strict=True)
        return [arrival - distance[start] for arrival, distance, start in triples]

    def _shortest(self, i: int, rng: np.random.Generator) -> Route:
        """Draw one of the routes that a vehicle would take alone."""
        distance, node = self._distances[i], self._starts[i]
        route = [node]
        while distance[node]:
            nearer = [other for other in self._neighbors[node] if distance[other] < distance[node]]
            node = nearer[int(rng.integers(len(nearer)))]
            route.append(node)
        return route

    def _arrival(self, i: int, route: Route) -> int:
        """Return the tick from which on a vehicle stays at its goal."""
        goal, tick = self._goals[i], len(route) - 1
        while tick and route[tick - 1] == goal:
            tick -= 1
        return tick

    def _take(self, i: int, route: Route, arrival: int) -> None:
        """Give a vehicle a route."""
        self._routes[i], self._arrivals[i], self._moves[i] = route, arrival, _moves(route)
        for here, node in zip(self._at, route, strict=True):
            here[node] = i

    def _lift(self, i: int) -> None:
        """Take a vehicle off its route."""
        for here, node in zip(self._at, self._routes[i], strict=True):
            if here[node] == i:
                here[node] = _NOBODY

    def _route(self, i: int) -> Route | None:
        """Return the route on which a vehicle arrives first around all others, to stay there.

        Of those the one of fewest moves. Both are bounded by the distance that is left, so that of
        all the shortest routes over an open lattice few are looked at.
        """
        goal, distance, at = self._goals[i], self._distances[i], self._at
        last = len(at) - 1
        # Others may still have to pass through the goal.
        free_from = last + 1
        while free_from and at[free_from - 1][goal] == _NOBODY:
            free_from -= 1
        start, size = self._starts[i], len(self._neighbors)
        known: dict[int, int] = {}
        # Arrival and moves at best, edges to go, node, tick, and where that came from.
        heap = [(max(distance[start], free_from), distance[start], 0, start, 0, start)]
        while heap:
            _, most, _, node, tick, before = heapq.heappop(heap)
            if tick * size + node in known:
                continue
            known[tick * size + node] = before
            if node == goal and tick >= free_from:
                return self._back(known, node, tick)
            if tick == last:
                continue
            here, there, soon = at[tick], at[tick + 1], tick + 1
            comes, so_far = there[node], most - distance[node]
            for other in self._next[node]:
                if there[other] != _NOBODY or soon * size + other in known:
                    continue
                # Two vehicles may not exchange their nodes within one tick.
                if comes != _NOBODY and here[other] == comes:
                    continue
                left = distance[other]
                if soon + left <= last:
                    arrival = max(soon + left, free_from)
                    moves = so_far + (other != node) + left
                    heapq.heappush(heap, (arrival, moves, left, other, soon, node))
        return None

    def _back(self, known: dict[int, int], node: int, tick: int) -> Route:
        """Return the route that led to a node, and stays there."""
        route, size = [node] * (len(self._at) - tick), len(self._neighbors)
        while tick:
            node, tick = known[tick * size + node], tick - 1
            route.insert(0, node)
        return route


def _moves(route: Route) -> int:
    """Return how often a vehicle moves to another node [-]."""
    return sum(here != there for here, there in pairwise(route))
