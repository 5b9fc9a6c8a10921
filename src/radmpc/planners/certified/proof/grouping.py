"""Which vehicles are searched together in a proof, and what is kept when others are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.proof.tuning import TUNING

if TYPE_CHECKING:
    # Who meets nobody needs no relaxation.
    from radmpc.planners.certified.proof.relaxed_set import RelaxedSet

__all__ = ["Proven", "bounds_within", "parts_of", "proven_within"]

Proven = Mapping[Members, Mapping[Members, "RelaxedSet"]]
"""What is known of parts of a fleet, by the vehicles' places in each."""


def parts_of(sets: Sequence[Members]) -> tuple[Members, ...]:
    """Return the parts of a fleet that are searched as wholes: any parting of it gives a bound.

    Parameters
    ----------
    sets : sequence of tuple of int
        A partition of the fleet.

    Returns
    -------
    tuple of tuple of int
        The same, but that vehicles of large sets are alone.
    """
    parts: list[Members] = []
    for members in sets:
        is_small = len(members) <= TUNING.most_together
        parts += [tuple(sorted(members))] if is_small else [(i,) for i in members]
    return tuple(parts)


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
