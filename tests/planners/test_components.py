"""Connected components against scipy's."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from radmpc.planners.components import components


def test_components_are_those_of_scipy_in_the_order_of_their_first_nodes() -> None:
    rng = np.random.default_rng(4)
    for _ in range(300):
        count = int(rng.integers(1, 60))
        edges = rng.integers(count, size=(rng.integers(0, count), 2))
        graph = coo_array((np.ones(len(edges)), edges.T), shape=(count, count))
        number, labels = connected_components(graph, directed=False)
        wanted = sorted(tuple(np.flatnonzero(labels == k).tolist()) for k in range(number))
        found = components(count, [(int(i), int(j)) for i, j in edges])
        assert list(found) == wanted


def test_a_long_chain_told_backwards_is_one_component() -> None:
    edges = [(i + 1, i) for i in range(3000)]
    assert components(3001, edges[::-1]) == (tuple(range(3001)),)


def test_nodes_without_edges_are_alone() -> None:
    assert components(3, []) == ((0,), (1,), (2,))
