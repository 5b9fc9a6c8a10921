"""Whether going on with a proof promises anything."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.proof.tuning import TUNING

__all__ = ["hidden_value", "is_slow", "least_worth", "most_promising_first", "unsearched_value"]


def most_promising_first(
    parts: Iterable[Members], paid: Callable[[Members], float]
) -> tuple[Members, ...]:
    """Return parts by what their searches promise over what these take.

    A search takes about the square of the vehicles: parts of one to seven of ``fleet(1000, 0)``
    take 5, 15, 51, 45, 136, 287 and 445 ms in the mean.

    Parameters
    ----------
    parts : iterable of tuple of int
        The parts.
    paid : callable
        What the plan at hand of a part costs beyond the least in empty space.
    """
    return tuple(sorted(parts, key=lambda part: -paid(part) / len(part) ** 2))


def least_worth(paid: Iterable[float], at_stake: float) -> float:
    """Return what a part must promise to be searched.

    Many parts that promise little each leave much open together.

    Parameters
    ----------
    paid : iterable of float
        What the plans at hand of the parts cost beyond the least in empty space.
    at_stake : float
        The gap at which the bound is good enough, in cost.
    """
    most, left_out = TUNING.worth * at_stake, 0.0
    for each in sorted(paid):
        left_out += max(each, 0.0)
        if each > most or left_out > TUNING.left_out * at_stake:
            return min(most, math.nextafter(each, 0.0))
    return most


def hidden_value(
    found: Iterable[tuple[Members, RelaxedSet]], paid: Callable[[Members], float]
) -> float:
    """Return what hazards that were left out may add at most to the relaxed plans' value.

    Parameters
    ----------
    found : iterable of (tuple of int, RelaxedSet)
        Parts that were searched as a whole.
    paid : callable
        What the plan at hand of a part costs beyond the least in empty space.
    """
    gains = (paid(m) + whole.base - whole.value for m, whole in found if not whole.is_complete)
    return sum(max(gain, 0.0) for gain in gains)


def unsearched_value(paid: Mapping[Members, float], worth: float, at_risk: float) -> float:
    """Return by how much searches of parts that were not searched as a whole may raise the bound.

    Parameters
    ----------
    paid : mapping of tuple of int to float
        What the plan at hand of each of these parts costs beyond the least in empty space.
    worth : float
        What a part has to promise to be searched at all.
    at_risk : float
        What all of Δ is worth: parts too large to be searched together from the first may be
        charged for it, too.
    """
    is_large = any(len(members) > TUNING.most_together for members in paid)
    return sum(each for each in paid.values() if each > worth) + is_large * at_risk


def is_slow(gain: float, spent: int, left: float, missing: float) -> bool:
    """Tell whether what is left to spend raises the bound too little, at the rate of the latest.

    Parameters
    ----------
    gain : float
        By how much the latest nodes raised the bound: all later ones raise it by less each.
    spent : int
        How many these were [-].
    left : float
        How many are left [-]; inf is no limit.
    missing : float
        By how much the bound has to rise.
    """
    return gain * left < TUNING.slow * missing * spent
