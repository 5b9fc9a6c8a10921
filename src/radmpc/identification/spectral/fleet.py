"""How much less vehicles tell together than as many independent ones."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.identification.segments import Transitions

__all__ = ["repetition"]

_LEAST_STEPS = 20
"""Steps at equal times below which two vehicles count as independent."""


def repetition(group: Sequence[Transitions], pieces: Sequence[Matrix]) -> float:
    """Return by what factor variances of products are larger than those of independent vehicles.

    Parameters
    ----------
    group : sequence of Transitions
        Of vehicles with the same noise.
    pieces : sequence of (k, p) array
        Their whitened residuals, a piece per segment.
    """
    rows: dict[str, dict[int, Matrix]] = {}
    clocks: dict[str, str] = {}
    owners = [(one, segment) for one in group for segment in one.segments]
    for (one, segment), piece in zip(owners, pieces, strict=True):
        clocks[one.name] = one.clock
        rows.setdefault(one.name, {}).update(
            (segment.first + k, row) for k, row in enumerate(piece)
        )
    total = 0.0
    for name, other in combinations(rows, 2):
        both = sorted(rows[name].keys() & rows[other].keys())
        if len(both) < _LEAST_STEPS or clocks[name] != clocks[other]:
            continue
        first, second = (np.array([rows[owner][k] for k in both]) for owner in (name, other))
        across = first.T @ second / len(both)
        p = across.shape[0]
        # By chance alone the square of a correlation is 1/N.
        total += max(float(np.sum(across**2)) / p - p / len(both), 0.0)
    return 1.0 + 2.0 * total / max(len(rows), 1)
