"""Which cones wide ones are made of, level by level: the same for all hazards laid out alike."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices
from radmpc.records import dataclass

__all__ = ["Level", "Levels", "levels_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """Cones that are as many times part of wider ones.

    Attributes
    ----------
    cones : (c,) int array
        Their numbers.
    outer : (c,) int array
        The wider cone that each is part of; -1 on the first level.
    wide : (w,) int array
        Those of them that are made of narrower ones.
    order : (c,) int array
        All of them, those that are part of the same one together.
    begins : (p,) int array
        Where these begin in that order.
    parents : (p,) int array
        What these are part of.
    """

    cones: Indices
    outer: Indices
    wide: Indices
    order: Indices
    begins: Indices
    parents: Indices


@dataclass(frozen=True, slots=True, eq=False)
class Levels:
    """All levels, the widest cones first.

    Attributes
    ----------
    is_narrow : (c,) bool array
        Which cones are made of no others.
    levels : tuple of Level
        Their cones.
    """

    is_narrow: npt.NDArray[np.bool_]
    levels: tuple[Level, ...]


def levels_of(parents: Indices) -> Levels:
    """Return the levels of cones.

    Parameters
    ----------
    parents : (c,) int array
        The wider cone that each is part of; -1 where there is none.
    """
    return _levels_of(parents.astype(np.int64).tobytes())


@lru_cache(maxsize=64)
def _levels_of(written: bytes) -> Levels:
    """Return the levels of parents written as bytes; there are few layouts, and many hazards."""
    parents: Indices = np.frombuffer(written, dtype=np.int64)
    is_narrow = np.ones(parents.size, dtype=bool)
    is_narrow[parents[parents >= 0]] = False
    depth = np.zeros(parents.size, dtype=np.int64)
    outer = parents
    while (is_part := outer >= 0).any():
        depth += is_part
        outer = np.where(is_part, parents[outer], -1)
    ranked = depth.argsort(kind="stable")
    cut = np.split(ranked, np.flatnonzero(np.diff(depth[ranked])) + 1)
    return Levels(is_narrow, tuple(_level(cones, parents, is_narrow) for cones in cut))


def _level(cones: Indices, parents: Indices, is_narrow: npt.NDArray[np.bool_]) -> Level:
    """Return one level."""
    outer = parents[cones]
    order = cones[outer.argsort(kind="stable")]
    above = parents[order]
    begins = np.flatnonzero(np.append(True, above[1:] != above[:-1]))
    return Level(cones, outer, cones[~is_narrow[cones]], order, begins, above[begins])
