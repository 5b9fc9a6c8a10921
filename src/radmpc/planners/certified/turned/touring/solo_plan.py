"""What a vehicle that is planned by itself does, and what half-spaces say of its path."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.paths import Paths
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass

__all__ = ["SoloPlan", "heights_on"]


@dataclass(frozen=True, slots=True, eq=False)
class SoloPlan:
    """What a vehicle does.

    Attributes
    ----------
    model : CondensedModel
        It, with its visits at these steps.
    controls : (T, m) array
        Its nominal controls.
    means : (T+1, d) array
        Its mean positions, or those of a reference that no controls follow yet [m].
    missed : float
        How far half-spaces were missed when it was planned [m].
    """

    model: CondensedModel
    controls: Matrix
    means: Matrix
    missed: float

    @property
    def effort(self) -> float:
        """Sum of the magnitudes of its controls."""
        return float(np.abs(self.controls).sum())


def heights_on(paths: Paths, spaces: HalfSpaces) -> Matrix:
    """Return the left sides of half-spaces on paths that they were not turned to, (w, 2) [m].

    Parameters
    ----------
    paths : Paths
        Everyone's paths.
    spaces : HalfSpaces
        As they are, with the shares of the reserve that they have.
    """
    one, two, k = spaces.first, spaces.second, spaces.windows
    others = two >= 0
    ends = [paths.means[one, k], paths.means[one, k + 1]]
    hang = paths.sagittas[one, k]
    for end, each in enumerate(ends):
        each[others] -= paths.means[two[others], k[others] + end]
    hang[others] -= paths.sagittas[two[others], k[others]]
    reserve = 4.0 * np.maximum(np.einsum("wd,wd->w", spaces.normals, hang), 0.0)
    kept = np.stack([np.square(spaces.shares), np.square(1.0 - spaces.shares)], axis=1)
    heights = np.stack([np.einsum("wd,wd->w", spaces.normals, each) for each in ends], axis=1)
    return np.asarray(heights - kept * reserve[:, None])
