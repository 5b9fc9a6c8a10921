"""Whether straight pieces of a route pass standing obstacles, and routes pulled straight."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass

__all__ = ["StandingFaces", "pulled"]

_FOLLOWING = 200
"""Corners ahead of each that it is pulled straight to, at most [-]."""

_LOOKED_AT = 0.7
"""Distance of places at which a way is looked at [radii of the smallest]."""

_FAR = 5.0
"""Standard deviations beside the largest hull from which on nothing is near [-]: more than any
clearance that is kept."""

_MOST_LOOKS = 60
"""Most of them on one way [-]."""

_LOST = 1e-3
"""Distance from obstacles that a straight piece may lose [m]."""

_TINY = 1e-12
"""Stands for a slope of 0 where one divides by it [m]."""


def pulled(around: StandingFaces, route: Matrix, clearance: float) -> Matrix:
    """Return the corners of a route, pulled straight where it keeps off, or loses nothing.

    Parameters
    ----------
    around : StandingFaces
        What stands.
    route : (p, d) array
        Corners of the route [m].
    clearance : float
        Distance from obstacles that is worth a longer route [m].
    """
    here, kept, i = around.at(route), [0], 0
    while i < len(route) - 1:
        following = np.arange(i + 1, min(len(route), i + 1 + _FOLLOWING))
        begin = np.broadcast_to(route[i], (len(following), route.shape[1]))
        before = np.minimum.accumulate(here[i : following[-1] + 1])[1:]
        kept_off = np.minimum(clearance, before) - _LOST
        is_open = around.are_open(begin, route[following], kept_off)
        is_open[0] = True
        i = int(following[np.flatnonzero(is_open)[-1]])
        kept.append(i)
    return np.asarray(route[kept])


@dataclass(frozen=True, slots=True, eq=False)
class StandingFaces:
    """The distance to the nearest standing obstacle, of its faces, in space.

    Attributes
    ----------
    faces : (o, f, d) array
        Outward normals of each obstacle; zeros where it has fewer.
    offsets : (o, f) array
        How far they are along these [m]; inf where there are fewer.
    boxes : (o, 2, d) array
        Lower and upper corners around each [m].
    spacing : float
        Distance of the places on a way at which it is looked at [m].
    far : float
        Distance from which on nothing is near [m].
    """

    faces: Tensor
    offsets: Matrix
    boxes: Tensor
    spacing: float
    far: float

    @classmethod
    def of(cls, hazards: Hazards) -> StandingFaces:
        """Return the faces of what stands.

        Parameters
        ----------
        hazards : Hazards
            The fleet and the obstacles.
        """
        vertices = hazards.shapes.vertices
        standing = (vertices == vertices[:, :1]).all(axis=(1, 2, 3))
        faces, corners = hazards.shapes.faces[standing, 0], vertices[standing, 0]
        offsets = np.einsum("ofd,ovd->ofv", faces, corners).max(axis=2, initial=-np.inf)
        offsets[~faces.any(axis=2)] = np.inf
        boxes = np.stack([corners.min(axis=1), corners.max(axis=1)], axis=1)
        spread = float(np.sqrt(hazards.variances.max(initial=0.0)))
        far = float(hazards.radii.max()) + _FAR * spread
        return cls(faces, offsets, boxes, _LOOKED_AT * float(hazards.radii.min()), far)

    def are_open(
        self, begin: Matrix, end: Matrix, clearance: float | Vector = 0.0
    ) -> npt.NDArray[np.bool_]:
        """Whether straight pieces keep away from what stands, (m,).

        Parameters
        ----------
        begin, end : (m, d) array
            Ends of the pieces [m].
        clearance : float or (m,) array
            How far they stay from the faces [m]; 0 where touching is all that counts.
        """
        offsets = self.offsets + np.reshape(clearance, (-1, 1, 1))
        from_begin = np.einsum("md,ofd->mof", begin, self.faces)
        slopes = np.einsum("md,ofd->mof", end - begin, self.faces)
        shares = (offsets - from_begin) / np.where(np.abs(slopes) < _TINY, _TINY, slopes)
        # Inside a piece are the shares of the way that are behind none of its faces.
        entered = np.where(slopes < 0.0, shares, 0.0).max(axis=2, initial=0.0)
        left = np.where(slopes > 0.0, shares, 1.0).min(axis=2, initial=1.0)
        is_beside = ((np.abs(slopes) < _TINY) & (from_begin >= offsets)).any(axis=2)
        return np.asarray(((entered >= left) | is_beside).all(axis=1))

    def within_borders(self, _radius: float) -> StandingFaces:
        """Return the same: routes do not lead past borders, nor do straight pieces of them."""
        return self

    def at(self, places: Tensor) -> Tensor:
        """Return the distance at places, (...) [m], from their coordinates, (..., d) [m]."""
        flat = places.reshape(-1, places.shape[-1])
        found = np.full(len(flat), np.inf)
        for faces, offsets in zip(self.faces, self.offsets, strict=True):
            found = np.minimum(found, (flat @ faces.T - offsets).max(axis=1))
        return found.reshape(places.shape[:-1])

    def least_at(self, places: Tensor) -> Tensor:
        """Return the same, as `Clear.least_at`."""
        return self.at(places)

    def along(self, begin: Matrix, end: Matrix) -> Vector:
        """Return the least distance along straight pieces, those far away cut off, (m,) [m].

        Parameters
        ----------
        begin, end : (m, d) array
            Their ends [m].
        """
        longest = float(np.abs(end - begin).max(initial=0.0))
        count = max(2, int(longest / max(self.spacing, _TINY)) + 2)
        shares = np.linspace(0.0, 1.0, min(count, _MOST_LOOKS))[:, None]
        lower, upper = np.minimum(begin, end) - self.far, np.maximum(begin, end) + self.far
        found = np.full(len(begin), self.far)
        for faces, offsets, corners in zip(self.faces, self.offsets, self.boxes, strict=True):
            near = np.flatnonzero(((lower < corners[1]) & (upper > corners[0])).all(axis=1))
            between = begin[near, None] + shares * (end - begin)[near, None]
            distances = (between @ faces.T - offsets).max(axis=2)
            found[near] = np.minimum(found[near], distances.min(axis=1, initial=np.inf))
        return found
