"""Other paces for the few that cannot keep theirs, while all others stay on their paths."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.planners.certified.turned.narrow.at_pace import plan_near, who_misses
from radmpc.planners.certified.turned.narrow.tuning import TUNING as NARROW
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.solvers.solution import Limits

__all__ = ["mended"]

_WAVES = 6
"""Waves that a pace is made of [-]."""


def mended(
    successive: SuccessiveLp,
    places: Tensor,
    clearance: float,
    rng: np.random.Generator,
    limits: Limits,
) -> bool:
    """Plan those that miss anything again, along their places at paces that are drawn.

    A corner that falls between two steps cannot be kept, and a pace that a track allows may be one
    that controls just miss. Of a dozen a little sooner here and later there some are often kept.

    Parameters
    ----------
    successive : SuccessiveLp
        The latest paths.
    places : (N, T+1, d) array
        Where everyone was to be [m].
    clearance : float
        Standard deviations that they keep from everything [-].
    rng : Generator
        Draws the paces.
    limits : Limits
        When to stop.

    Returns
    -------
    bool
        Whether no clearance is missed.
    """
    missing = sorted(who_misses(successive), key=lambda i: -successive.missed[i])
    if len(missing) <= NARROW.mended:
        for i in missing:
            _mend(successive, i, places[i], clearance, rng, limits)
    return not who_misses(successive)


def _mend(
    successive: SuccessiveLp,
    i: int,
    places: Matrix,
    clearance: float,
    rng: np.random.Generator,
    limits: Limits,
) -> None:
    """Plan a vehicle at other paces until it misses nothing, or leave it at the best."""
    least, controls = float(successive.missed[i]), successive.paths.controls[i]
    base = places
    for number in range(NARROW.paces):
        if least <= NARROW.negligible or limits.reached:
            break
        strength = NARROW.strengths[number % len(NARROW.strengths)]
        tried = _paced_otherwise(base if number % 2 else places, strength, rng)
        successive.refer(i, tried)
        if _missed(successive, i, clearance) < least:
            least, controls, base = float(successive.missed[i]), successive.paths.controls[i], tried
    successive.paths.fly(i, controls)
    successive.missed[i] = least


def _missed(successive: SuccessiveLp, i: int, clearance: float) -> float:
    """Plan a vehicle until it misses nothing, or hardly less than before; return what it misses."""
    penalty, before = NARROW.mending_penalty, np.inf
    for number in range(NARROW.mending_rounds):
        plan_near(successive, i, clearance, penalty)
        missed = float(successive.missed[i])
        if missed <= NARROW.negligible or (number > 0 and missed > TUNING.stuck_at * before):
            break
        before, penalty = missed, TUNING.penalty_growth * penalty
    return float(successive.missed[i])


def _paced_otherwise(places: Matrix, strength: float, rng: np.random.Generator) -> Matrix:
    """Return places on the same way, sooner and later by waves that sum to some steps."""
    steps = np.arange(len(places))
    waves = np.arange(1, _WAVES + 1)
    shifts = strength * rng.normal(size=_WAVES) / np.sqrt(waves)
    at = steps + np.sin(np.pi * np.outer(steps, waves) / steps[-1]) @ shifts
    at = np.maximum.accumulate(np.clip(at, 0, steps[-1]))
    return np.stack([np.interp(at, steps, each) for each in places.T], axis=1)
