"""Joint routes that are routed anew are still joint routes, and vehicles come sooner."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from radmpc.planners.certified.turned.narrow.joint_search import GoalGraph, joint_search
from radmpc.planners.certified.turned.narrow.rerouting import _Routes, rerouted

SIDE = 6


def graph(rng: np.random.Generator) -> list[list[int]]:
    """Return the cells of a grid next to each cell, some of them blocked."""
    is_open = rng.random((SIDE, SIDE)) > 0.12
    numbers = np.full((SIDE + 2, SIDE + 2), -1)
    numbers[1:-1, 1:-1][is_open] = np.arange(int(is_open.sum()))
    around = ((0, 1), (1, 0), (0, -1), (-1, 0))
    return [
        [int(numbers[x + a, y + b]) for a, b in around if numbers[x + a, y + b] >= 0]
        for x, y in np.argwhere(numbers >= 0).tolist()
    ]


def arrivals(routes: list[tuple[int, ...]]) -> list[int]:
    """Return the tick from which on each vehicle stays where it ends."""
    at = np.array(routes)
    return [
        max((k + 1 for k in range(len(at)) if at[k, i] != at[-1, i]), default=0)
        for i in range(at.shape[1])
    ]


def never() -> bool:
    return False


@pytest.mark.parametrize("seed", range(25))
def test_routes_that_are_drawn_anew_keep_apart_and_are_no_later_in_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    neighbors = graph(rng)
    count = 8
    starts, goals = (
        tuple(rng.choice(len(neighbors), count, replace=False).tolist()) for _ in range(2)
    )
    toward = GoalGraph.to(goals, neighbors)
    drawn = joint_search(toward, starts, goals, 2000, rng, never)
    if not drawn:
        return
    found = rerouted(toward, drawn, 200, rng, never)
    assert found[0] == starts
    assert found[-1] == goals
    for here, there in pairwise(found):
        assert len(set(there)) == count
        edges = {(a, b) for a, b in zip(here, there, strict=True) if a != b}
        assert all(b in neighbors[a] for a, b in edges)
        assert not any((b, a) in edges for a, b in edges)
    assert max(arrivals(found)) <= max(arrivals(drawn))
    assert sum(arrivals(found)) <= sum(arrivals(drawn))
    assert len(found) == max(arrivals(found)) + 1


def test_one_that_others_would_have_to_wait_for_lets_them_pass() -> None:
    # A lane with a bay at its second node: the one in the lane goes into the bay first.
    lane = [[1], [0, 2, 5], [1, 3], [2, 4], [3], [1]]
    # It waits at the far end until the other has come, four ticks late each.
    slow = [(0, 4), (0, 3), (0, 2), (0, 1), (0, 5), (1, 5), (2, 5), (3, 5), (4, 5), (4, 1), (4, 0)]
    found = rerouted(GoalGraph.to((4, 0), lane), slow, 200, np.random.default_rng(0), never)
    assert found[-1] == (4, 0)
    # It comes to the bay in three, the other passes, and it needs two more: none can do better.
    assert len(found) - 1 < len(slow) - 1
    assert len(found) - 1 == quickest(lane, (0, 4), (4, 0))


def quickest(neighbors: list[list[int]], starts: tuple[int, int], goals: tuple[int, int]) -> int:
    """Return the fewest ticks in which two get to their goals, tried by brute force."""
    here, ticks = {starts}, 0
    while goals not in here:
        here = {
            (a, b)
            for one, two in here
            for a in (one, *neighbors[one])
            for b in (two, *neighbors[two])
            if a != b and (a, b) != (two, one)
        }
        ticks += 1
    return ticks


@pytest.mark.parametrize("seed", range(25))
def test_a_route_arrives_first_and_moves_least_around_all_others(seed: int) -> None:
    rng = np.random.default_rng(seed)
    neighbors = graph(rng)
    starts, goals = (tuple(rng.choice(len(neighbors), 8, replace=False).tolist()) for _ in "ab")
    toward = GoalGraph.to(goals, neighbors)
    drawn = joint_search(toward, starts, goals, 2000, rng, never)
    routes = _Routes(toward, drawn or [starts])
    for i in range(8 if drawn else 0):
        before = [at[i] for at in drawn]
        routes._lift(i)
        route = routes._route(i)
        assert route is not None
        others = [at[:i] + at[i + 1 :] for at in drawn]
        arrival = arrivals([(node,) for node in route])[0]
        moves = sum(here != there for here, there in pairwise(route))
        assert (arrival, moves) == best(neighbors, (starts[i], goals[i]), others)
        routes._take(i, before, arrivals([(node,) for node in before])[0])


def best(
    neighbors: list[list[int]], ends: tuple[int, int], others: list[tuple[int, ...]]
) -> tuple[int, int]:
    """Return when one arrives first, to stay, and its fewest moves; by every way tick by tick."""
    start, goal = ends
    free_from = max((k + 1 for k, at in enumerate(others) if goal in at), default=0)
    fewest = {start: 0}
    for tick in range(len(others)):
        if tick >= free_from and goal in fewest:
            return tick, fewest[goal]
        here, there = others[tick : tick + 2]
        reached: dict[int, int] = {}
        for node, moves in fewest.items():
            for other in (node, *neighbors[node]):
                is_met = (other, node) in zip(here, there, strict=True)
                if other not in there and not is_met:
                    more = moves + (other != node)
                    reached[other] = min(reached.get(other, more), more)
        fewest = reached
    raise AssertionError("nobody arrives")


def test_time_that_is_up_leaves_routes_as_they_are() -> None:
    lane = [[1], [0, 2], [1, 3], [2], [5], [4]]
    slow = [(0, 4), (0, 4), (1, 4), (2, 4), (3, 5)]
    assert (
        rerouted(GoalGraph.to((3, 5), lane), slow, 100, np.random.default_rng(0), lambda: True)
        == slow
    )


def test_two_of_which_one_waits_for_nothing_both_go_at_once() -> None:
    lane = [[1], [0, 2], [1, 3], [2], [5], [4]]
    slow = [(0, 4), (0, 4), (1, 4), (2, 4), (3, 5)]
    found = rerouted(GoalGraph.to((3, 5), lane), slow, 100, np.random.default_rng(0), never)
    assert found == [(0, 4), (1, 5), (2, 5), (3, 5)]
