"""The loop of both tree searches: dive from the best open node, backtrack, dive again."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Iterator
from operator import attrgetter
from typing import Generic, TypeVar

from radmpc.records import dataclass

__all__ = ["Dives", "OpenNode", "rank"]


@dataclass(slots=True, eq=False)
class OpenNode:
    """A node, see `rank`.

    A dive takes its nodes without removing them from the heap: they stay there, no longer open,
    until they come to the top. A node that is opened again is still queued, or pushed. While it is
    queued, nothing of its rank changes.

    Attributes
    ----------
    bound : float
        Lower bound on every solution below it.
    depth : int
        Minus the number of its chosen alternatives.
    number : int
        Counts nodes in the order in which they were made.
    chosen : tuple of int
        Its alternatives.
    is_open, is_queued : bool
        Whether it is yet to be searched, and whether it is in the heap.
    """

    bound: float
    depth: int
    number: int
    chosen: tuple[int, ...]
    is_open: bool = True
    is_queued: bool = False


rank: Callable[[OpenNode], tuple[float, int, int]] = attrgetter("bound", "depth", "number")
"""What nodes are ordered by: their bound, then deeper first, then older first."""


Node = TypeVar("Node", bound=OpenNode)


class Dives(Generic[Node]):
    """Open nodes in the order of their bounds, searched by diving from the best.

    Parameters
    ----------
    patience : int
        Nodes after which a dive without a solution no longer backtracks to its last choice.
    """

    def __init__(self, patience: int) -> None:
        self._patience = patience
        # With their ranks, which are compared without a call of Python.
        self._heap: list[tuple[tuple[float, int, int], Node]] = []
        self._trail: list[Node] = []

    def __iter__(self) -> Iterator[Node]:
        """Return the open nodes, in no order."""
        return (node for _, node in self._heap if node.is_open)

    def clear(self) -> None:
        """Forget all nodes."""
        self._heap.clear()

    def open(self, node: Node) -> None:
        """Open a node, in the heap once."""
        node.is_open = True
        if not node.is_queued:
            node.is_queued = True
            heapq.heappush(self._heap, (rank(node), node))

    def leave(self, nodes: Iterable[Node]) -> None:
        """Note open siblings that a dive passes by; it backtracks to the last of them first."""
        self._trail += nodes

    def best(self) -> Node | None:
        """Return the open node of least bound; those that a dive took are dropped."""
        while self._heap and not self._heap[0][1].is_open:
            self._pop()
        return self._heap[0][1] if self._heap else None

    def dive(
        self,
        expand: Callable[[Node], Node | None],
        *,
        is_over: Callable[[], bool],
        has_solution: Callable[[], bool],
    ) -> bool:
        """Follow the best children down from the best open node.

        Parameters
        ----------
        expand : callable
            Searches a node and returns the child to go on with, if it has any.
        is_over : callable
            Whether a limit is reached.
        has_solution : callable
            Whether there is a solution: a dive backtracks as long as there is none.

        Returns
        -------
        bool
            Whether the limit ended it; the node it stood at is open again then.
        """
        self._trail.clear()
        patience = self._patience
        node: Node | None = self._pop()
        while node is not None:
            node.is_open = False
            if is_over():
                self.open(node)
                return True
            node = expand(node)
            if node is None and not has_solution() and patience > 0:
                node = self._back()
            patience -= 1
        return False

    def _back(self) -> Node | None:
        """Return the latest open node that this dive passed by."""
        while self._trail:
            node = self._trail.pop()
            if node.is_open:
                return node
        return None

    def _pop(self) -> Node:
        """Remove the first node from the heap."""
        _, node = heapq.heappop(self._heap)
        node.is_queued = False
        return node
