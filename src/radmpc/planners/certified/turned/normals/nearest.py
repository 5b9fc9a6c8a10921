"""Where within its window a path is nearest to what it passes: there alone it gives way.

Between half-spaces that both ends of a window keep, a path never turns about a corner: either end
would come closer to the half-space that is there now, though not to the one that turns with it. To
first order the best clearance of a window is that of the point where the path is nearest.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.turned.normals.encounter import Encounter, tangents_of

__all__ = ["nearest_shares"]

_ANGLE = 1e-4
"""Angle by which normals are turned either way to see what changes [rad]."""

_KINK = 1e-2
"""Share of a way's length by which the slopes to either side differ at most: beyond, they are of
two corners, and a face is passed [1/rad]."""

_AT_ENDS = 1e-3
"""Share of a window up to which an end is nearest: slopes are no more precise [-]."""

_ALONG = 0.2
"""Share of its length by which a window's path may approach along the normal and still pass
[-]."""


def nearest_shares(encounter: Encounter, normals: Matrix) -> Vector:
    """Return after which share of each window the path is nearest to a corner that it passes.

    Where the normal is the best one, turning it gains as much at one end as it loses at the other:
    weighted with this share, the slopes of both ends' distances vanish.

    Parameters
    ----------
    encounter : Encounter
        The path past something, window by window; both ends count.
    normals : (w, d) array
        The directions of most clearance.

    Returns
    -------
    (w,) array
        Shares in (0, 1); nan where an end is nearest, or a face is passed.
    """
    here = _distances(encounter, normals)
    lengths = np.linalg.norm(encounter.ends[1] - encounter.ends[0], axis=1)
    slopes, is_smooth = [], np.ones(len(normals), dtype=bool)
    for tangents in tangents_of(normals).transpose(1, 0, 2):
        ahead = (_distances(encounter, normals + _ANGLE * tangents) - here) / _ANGLE
        behind = (here - _distances(encounter, normals - _ANGLE * tangents)) / _ANGLE
        is_smooth &= (np.abs(ahead - behind) <= _KINK * lengths).all(axis=0)
        slopes.append(0.5 * (ahead + behind))
    start, end = np.stack(slopes).transpose(1, 0, 2)
    turned = end - start
    size = np.square(turned).sum(axis=0)
    found: Vector = -(start * turned).sum(axis=0) / np.where(size > 0.0, size, 1.0)
    is_passing = np.abs(here[1] - here[0]) < _ALONG * lengths
    is_within = (found > _AT_ENDS) & (found < 1.0 - _AT_ENDS) & (size > 0.0)
    return np.where(is_smooth & is_passing & is_within, found, np.nan)


def _distances(encounter: Encounter, normals: Matrix) -> Matrix:
    """Return what both ends keep from what is avoided along normals, (2, w) [m]."""
    reaches = encounter.supports(normals[:, None])
    both = zip(encounter.ends, reaches, strict=True)
    return np.stack([np.einsum("wd,wd->w", normals, at) - reach[:, 0] for at, reach in both])
