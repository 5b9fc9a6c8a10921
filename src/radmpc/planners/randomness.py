"""Sources of random choices for parts of a run, all from the one that enters at the front door."""

from __future__ import annotations

import copy

import numpy as np

__all__ = ["children"]


def children(rng: np.random.Generator, count: int) -> list[np.random.Generator]:
    """Return independent generators; the given one is as it was before.

    Parameters
    ----------
    rng : Generator
        Any generator, also one whose seed is not known.
    count : int
        How many.
    """
    seeds = copy.deepcopy(rng).integers(2**63, size=count)
    return [np.random.default_rng(int(seed)) for seed in seeds]
