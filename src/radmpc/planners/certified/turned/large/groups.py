"""Which vehicles share a linear program while half-spaces are turned."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.turned.tuning import TUNING

__all__ = ["groups_of", "parts_of"]


def groups_of(sets: Sequence[Members], count: int) -> tuple[Members, ...]:
    """Group vehicles by linear program: all in a small fleet, else sets side by side.

    A solve takes HiGHS and numpy about as long for a dozen vehicles as for one. The vehicles of
    sets too large for that are spread over several programs.

    Parameters
    ----------
    sets : sequence of tuple of int
        Who is planned together: the fleet, or those of it that are not held where they are.
    count : int
        Vehicles of the fleet.

    Returns
    -------
    tuple of tuple of int
        A partition of the same vehicles, numbers ascending in each part.
    """
    if count <= TUNING.most_together:
        return (tuple(range(count)),)
    groups: list[Members] = []
    for members in sets:
        is_small = len(members) <= TUNING.most_together
        for part in (members,) if is_small else [(i,) for i in members]:
            if groups and len(groups[-1]) + len(part) <= TUNING.side_by_side:
                groups[-1] = tuple(sorted(groups[-1] + part))
            else:
                groups.append(tuple(sorted(part)))
    return tuple(groups)


def parts_of(groups: Sequence[Members]) -> tuple[Members, ...]:
    """Return groups parted into few vehicles each, to be planned one after the other.

    Parameters
    ----------
    groups : sequence of tuple of int
        Vehicles that would share a linear program.

    Returns
    -------
    tuple of tuple of int
        A partition of the same vehicles.
    """
    each = TUNING.each_before_plan
    return tuple(group[k : k + each] for group in groups for k in range(0, len(group), each))
