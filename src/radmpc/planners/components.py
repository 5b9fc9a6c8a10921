"""Connected components of a graph; scipy's take a tenth of a second to load."""

from __future__ import annotations

from collections.abc import Iterable

__all__ = ["components"]


def components(count: int, edges: Iterable[tuple[int, int]]) -> tuple[tuple[int, ...], ...]:
    """Return the connected components of a graph.

    Parameters
    ----------
    count : int
        Number of nodes.
    edges : iterable of (int, int)
        Which nodes are connected, either way round.

    Returns
    -------
    tuple of tuple of int
        Each component's nodes, ascending; the components in the order of their first nodes.
    """
    # Each node's parent is of its component and no higher; the first is its own.
    parents = list(range(count))

    def first_of(node: int) -> int:
        while parents[node] != node:
            parents[node] = parents[parents[node]]
            node = parents[node]
        return node

    for one, two in edges:
        low, high = sorted((first_of(one), first_of(two)))
        parents[high] = low
    found: dict[int, list[int]] = {}
    for node in range(count):
        found.setdefault(first_of(node), []).append(node)
    return tuple(tuple(nodes) for nodes in found.values())
