"""Cones around outlines, and what they let through."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.program.relaxed.cones import Cones

Array = npt.NDArray[np.float64]


def directions(count: int) -> Array:
    angles = 2.0 * np.pi * np.arange(count) / count
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)[None]


def clearances_of(cones: Cones, mean: Array) -> Array:
    """By every cone at the first instant; -inf where there is none."""
    is_there = np.isfinite(cones.offsets[0])
    slack = cones.normals[0] @ mean - np.where(is_there, cones.offsets[0], 0.0)
    return np.where(is_there, slack / np.where(is_there, cones.deviations[0], 1.0), -np.inf)


def chains(cones: Cones) -> list[list[int]]:
    """Every narrow cone at the first instant with the wider ones around it that are there."""
    is_there = np.isfinite(cones.offsets[0])
    found = []
    for cone in np.flatnonzero(is_there & ~np.isin(np.arange(is_there.size), cones.parents)):
        chain = [int(cone)]
        while cones.parents[chain[-1]] >= 0:
            chain.append(int(cones.parents[chain[-1]]))
        found.append([c for c in chain if is_there[c]])
    return found
