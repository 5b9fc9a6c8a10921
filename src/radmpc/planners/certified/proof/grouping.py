"""Which vehicles are searched together in a proof, and what is kept when others are."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING

from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.proof.packing import gains_of, packed
from radmpc.planners.certified.proof.symmetry import with_images
from radmpc.planners.certified.proof.tuning import TUNING

if TYPE_CHECKING:
    # Vehicles without conflicts need no relaxation.
    from radmpc.planners.certified.proof.relaxed_set import RelaxedSet

__all__ = [
    "PartTotals",
    "Proven",
    "bound_together",
    "bounds_within",
    "grows_after",
    "most_fewer",
    "parts_of",
    "proven_within",
    "surplus",
]

Proven = Mapping[Members, Mapping[Members, "RelaxedSet"]]
"""What is known of parts of a fleet, by the vehicles' places in each."""


def parts_of(sets: Sequence[Members], num_obstacles: int) -> tuple[Members, ...]:
    """Return the parts of a fleet that are searched as wholes: any parting of it gives a bound.

    Parameters
    ----------
    sets : sequence of tuple of int
        A partition of the fleet.
    num_obstacles : int
        Obstacles of the fleet [-]: among many, programs of pairs alone are large.

    Returns
    -------
    tuple of tuple of int
        The same, but that vehicles of large sets are alone.
    """
    is_open = num_obstacles < TUNING.many_obstacles
    most = TUNING.most_in_pairs if is_open else TUNING.most_together
    parts: list[Members] = []
    for members in sets:
        is_small = len(members) <= most
        parts += [tuple(sorted(members))] if is_small else [(i,) for i in members]
    return tuple(parts)


def most_fewer(nodes: int) -> int:
    """Return how many vehicles the largest sets have that are searched before one of more is.

    Parameters
    ----------
    nodes : int
        Nodes per vehicle that a set may take [-]: where a few hundred do, pairs are enough.
    """
    more = (nodes // TUNING.nodes_of_pairs).bit_length()
    return min(2 + more, TUNING.most_together)


def grows_after(effort: int, nodes: int) -> bool:
    """Whether sets of more vehicles are searched before larger ones in the next effort.

    Parameters
    ----------
    effort : int
        How often the nodes were doubled [-].
    nodes : int
        Nodes per vehicle without any more effort [-].
    """
    return most_fewer(nodes * 2 ** (effort + 1)) > most_fewer(nodes * 2**effort)


def surplus(rows: dict[Members, int]) -> list[Members]:
    """Return whose rows are beyond as many as are kept; the latest are kept in any case.

    Parameters
    ----------
    rows : dict of tuple of int to int
        Rows that are kept of some vehicles, the latest last [-].
    """
    kept, found = 0, []
    for members, count in reversed(rows.items()):
        if count and kept and kept + count > TUNING.most_rows:
            found.append(members)
        kept += count
    return found


def proven_within(members: Members, proven: Proven) -> dict[Members, RelaxedSet]:
    """Return what searches of smaller parts have proven of vehicles of another part.

    Parameters
    ----------
    members : tuple of int
        The vehicles of the other part, ascending.
    proven : mapping of tuple of int to mapping of tuple of int to RelaxedSet
        What is known of parts.

    Returns
    -------
    dict of tuple of int to RelaxedSet
        By their places in the other part.
    """
    place = {i: number for number, i in enumerate(members)}
    return {
        tuple(place[part[block]] for block in blocks): found
        for part, sets in proven.items()
        if set(part) <= set(members)
        for blocks, found in sets.items()
    }


def bounds_within(members: Members, proven: Proven, price: float) -> dict[Members, float]:
    """Return the bounds on vehicles of a part that searches of smaller parts have proven.

    Parameters
    ----------
    members, proven
        As in `proven_within`.
    price : float
        Cost per unit of probability that the bounds are to hold at.
    """
    return {blocks: one.bound_at(price) for blocks, one in proven_within(members, proven).items()}


def bound_together(
    sets: Mapping[Members, RelaxedSet],
    base: Sequence[float],
    price: float,
    below: Mapping[Members, float] = MappingProxyType({}),
    group: Sequence[Members] = (),
) -> float:
    """Return what the vehicles of a part cost at least, by what is proven of any of them.

    A part whose search was ended early may not have been searched as a whole, or hardly: bounds of
    sets that share no vehicle add up.

    Parameters
    ----------
    sets : mapping of tuple of int to RelaxedSet
        What is known of vehicles of the part, by their places in it.
    base : sequence of float
        What each of them is known to cost at least.
    price : float
        Cost per unit of probability; what was proven at another does not count.
    below : mapping of tuple of int to float
        What else is proven of vehicles of the part, by their places in it.
    group : sequence of tuple of int
        Its `symmetries`.
    """
    bounds = {places: one.bound for places, one in sets.items() if one.price == price}
    bounds = with_images(bounds, group)
    bounds |= {m: max(bound, bounds.get(m, 0.0)) for m, bound in below.items()}
    whole = bounds.pop(tuple(range(len(base))), 0.0)
    total, gains = gains_of(bounds, dict(enumerate(base)))
    if max(map(len, gains), default=0) > 2:
        return max(total + packed(gains)[0], whole)
    left = set(range(len(base)))
    for places in sorted(gains, key=lambda one: gains[one], reverse=True):
        if left.issuperset(places):
            total += gains[places]
            left.difference_update(places)
    return max(total, whole)


class PartTotals:
    """Bounds and rows of parts, each counted once for what is known of it: a fleet has hundreds.

    Parameters
    ----------
    known : mapping of tuple of int to mapping of tuple of int to RelaxedSet
        What is known of parts to begin with.
    """

    def __init__(self, known: Proven) -> None:
        self._bounds: dict[Members, tuple[Mapping[Members, RelaxedSet], float, float]] = {}
        self._rows = {members: _num_rows(sets) for members, sets in known.items()}
        self._asked: tuple[Sequence[Members], float] = (), 0.0
        self._values: dict[Members, float] = {}
        self._changed: set[Members] = set()

    def keep_latest(
        self,
        known: dict[Members, Mapping[Members, RelaxedSet]],
        members: Members,
        latest: Mapping[Members, RelaxedSet],
    ) -> None:
        """Keep what is known of a part; leave behind what others search, beyond so many rows.

        Parameters
        ----------
        known : dict of tuple of int to mapping of tuple of int to RelaxedSet
            What is known of parts; changed in place.
        members : tuple of int
            The part.
        latest : mapping of tuple of int to RelaxedSet
            What is known of its vehicles now.
        """
        known[members] = latest
        self._changed.add(members)
        self._rows.pop(members, None)
        self._rows[members] = _num_rows(latest)
        for part in surplus(self._rows):
            known[part] = {m: found.left_behind() for m, found in known[part].items()}
            self._rows[part] = _num_rows(known[part])

    def bound_of(
        self,
        members: Members,
        sets: Mapping[Members, RelaxedSet],
        base: Sequence[float],
        price: float,
        below: Mapping[Members, float],
        group: Sequence[Members],
    ) -> float:
        """Return `bound_together` of a part.

        Parameters
        ----------
        members : tuple of int
            The part.
        sets, price, below, group
            As there.
        base : sequence of float
            What every vehicle of the fleet is known to cost at least, the same in all calls.
        """
        latest = self._bounds.get(members)
        if latest is None or latest[0] is not sets or latest[1] != price:
            bound = bound_together(sets, [base[i] for i in members], price, below, group)
            latest = self._bounds[members] = sets, price, bound
        return latest[2]

    def bound(
        self, parts: Sequence[Members], price: float, bound_of: Callable[[Members], float]
    ) -> float:
        """Return the sum of the bounds of all parts; those kept since are computed anew.

        Parameters
        ----------
        parts : sequence of tuple of int
            The parts, the same object as before where they are the same.
        price : float
            Cost per unit of probability.
        bound_of : callable
            Returns the bound of a part at that price.
        """
        if self._asked[0] is not parts or self._asked[1] != price:
            self._asked, self._values = (parts, price), dict.fromkeys(parts, 0.0)
            self._changed = set(parts)
        for members in self._changed:
            self._values[members] = bound_of(members)
        self._changed.clear()
        return sum(self._values.values())


def _num_rows(sets: Mapping[Members, RelaxedSet]) -> int:
    """Return how many rows are kept of a part."""
    return sum(found.num_rows for found in sets.values())
