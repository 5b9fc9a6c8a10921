"""The plan that a relaxation leads to, to turn half-spaces to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.proof.grouping import Proven
from radmpc.program.build import controls_of
from radmpc.program.condensed import CondensedModel

__all__ = ["best_points", "relaxed_plan"]

_SAME = 1e-6
"""Difference of controls up to which two plans are one [in the units of controls]."""


def best_points(proven: Proven, order: Sequence[Members]) -> dict[Members, Vector]:
    """Return the best points of the relaxation of parts.

    Parameters
    ----------
    proven : mapping of tuple of int to mapping of tuple of int to RelaxedSet
        What is known of parts.
    order : sequence of tuple of int
        The parts.

    Returns
    -------
    dict of tuple of int to (n,) array
        Of every part that was searched as a whole, and else of sets of its vehicles that share
        none, the largest first.
    """
    points: dict[Members, Vector] = {}
    for part in order:
        known, left = proven.get(part, {}), set(range(len(part)))
        for places in sorted(known, key=len, reverse=True):
            best = known[places].best
            if best is not None and left.issuperset(places):
                points[tuple(part[place] for place in places)] = best.z
                left.difference_update(places)
    return points


def relaxed_plan(
    models: Sequence[CondensedModel], controls: Sequence[Matrix], found: Mapping[Members, Vector]
) -> tuple[Matrix, ...]:
    """Return a plan in which some parts of a fleet do what the relaxation says.

    Parameters
    ----------
    models : sequence of CondensedModel
        The fleet.
    controls : sequence of (T, m) array
        Of the plan at hand.
    found : mapping of tuple of int to (n,) array
        `best_points`.

    Returns
    -------
    tuple of (T, m) array
        Controls of all vehicles; empty where they are those of the plan at hand.
    """
    relaxed, is_other = list(controls), False
    for members, point in found.items():
        each = controls_of([models[i] for i in members], point)
        for i, other in zip(members, each, strict=True):
            is_other |= bool(np.abs(other - controls[i]).max() > _SAME)
            relaxed[i] = other
    return tuple(relaxed) if is_other else ()
