"""Whether two vehicles have to change places in a passage with room for one, and can.

Priority inheritance alone lets such pairs push each other to and fro. With this test, one goes
backward to where the passage branches and pulls the other along (Okumura 2023, "Improving LaCAM for
scalable eventually optimal multi-agent pathfinding", section on swaps).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

__all__ = ["Swapping"]


class Swapping:
    """Finds who has to change places with whom.

    Parameters
    ----------
    neighbors : sequence of sequence of int
        Nodes next to each node.
    distances : sequence of sequence of int
        How many edges each node is from each vehicle's goal.
    """

    def __init__(
        self, neighbors: Sequence[Sequence[int]], distances: Sequence[Sequence[int]]
    ) -> None:
        self._neighbors, self._distances = neighbors, distances

    def partner(
        self,
        vehicle: int,
        here: Sequence[int],
        following: Sequence[int],
        at: Mapping[int, int],
        ahead: int,
    ) -> int | None:
        """Return whom a vehicle has to let by, and can, by going the other way; None if nobody.

        Parameters
        ----------
        vehicle : int
            Who moves.
        here : sequence of int
            The node of every vehicle.
        following : sequence of int
            Where everyone goes next; negative where that is open.
        at : mapping of int to int
            Who is at each node that is taken.
        ahead : int
            The node that the vehicle would go to.
        """
        place = here[vehicle]
        if ahead == place:
            return None
        other = at.get(ahead)
        if (
            other is not None
            and following[other] < 0
            and self._is_required(vehicle, other, place, ahead, at)
            and self._is_possible(ahead, place, at)
        ):
            return other
        # Who stands beside may want to go through, too, once this one has moved ahead.
        for node in self._neighbors[place]:
            third = at.get(node)
            if third is None or node == ahead:
                continue
            if self._is_required(third, vehicle, place, ahead, at) and self._is_possible(
                ahead, place, at
            ):
                return third
        return None

    def _is_required(
        self, pusher: int, puller: int, behind: int, before: int, at: Mapping[int, int]
    ) -> bool:
        """Whether pushing through a passage ends where each wants to be on the other's side."""
        to_pusher, to_puller = self._distances[pusher], self._distances[puller]
        while to_pusher[before] < to_pusher[behind]:
            num_ways, onward = self._ways(before, behind, at)
            if num_ways >= 2:
                return False
            if num_ways <= 0:
                break
            behind, before = before, onward
        return to_puller[behind] < to_puller[before] and (
            to_pusher[behind] == 0 or to_pusher[before] < to_pusher[behind]
        )

    def _is_possible(self, behind: int, before: int, at: Mapping[int, int]) -> bool:
        """Whether the passage branches somewhere in that direction."""
        first = behind
        while before != first:
            num_ways, onward = self._ways(before, behind, at)
            if num_ways != 1:
                return num_ways >= 2
            behind, before = before, onward
        return False

    def _ways(self, node: int, behind: int, at: Mapping[int, int]) -> tuple[int, int]:
        """Return how many ways lead on from a node, and the last of them.

        A dead end in which somebody is at its goal is no way.
        """
        num_ways, onward = 0, node
        for other in self._neighbors[node]:
            if other == behind:
                continue
            if len(self._neighbors[other]) == 1:
                resident = at.get(other)
                if resident is not None and self._distances[resident][other] == 0:
                    continue
            num_ways, onward = num_ways + 1, other
        return num_ways, onward
