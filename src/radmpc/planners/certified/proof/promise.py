"""Whether going on with a proof promises anything."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.proof.tuning import TUNING

__all__ = ["hidden_value", "is_slow", "unsearched_value"]


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
        How many are left [-]; where that is inf, nobody asks for haste.
    missing : float
        By how much the bound has to rise.
    """
    return gain * left < TUNING.slow * missing * spent
