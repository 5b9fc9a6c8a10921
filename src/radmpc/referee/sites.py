"""Where and when a half-space must hold: what every bound of the referee is made over."""

from __future__ import annotations

from dataclasses import dataclass

from radmpc.arrays import Indices, Matrix, Tensor, Vector

__all__ = ["Sites"]


@dataclass(frozen=True, slots=True, eq=False)
class Sites:
    """Places where one half-space must hold, at one step or at all ends of an interval.

    Attributes
    ----------
    means : (S, E, d) array
        Mean (relative) positions [m].
    covariances : (S, E, d, d) array
        Their covariances [m²].
    is_near : tuple of bool
        Which of the E ends stand at the beginning of the interval; one alone is a step.
    bows : (S, d) array
        How far the mean curve hangs off its chord in the middle of the interval, 0 at steps [m].
    radii : (S,) array
        Radius that grows the set [m].
    vertices : (S, 1 or 2, V, d) array
        Corners of the set, at both steps around where it moves; the origin for pairs [m].
    blends : (S, E) array
        How far between those steps each end is, 0 to 1.
    edges : (S, 1 or 2, R, 2, d) array
        Ends of the set's edges in space; R = 0 in the plane and for pairs [m].
    """

    means: Tensor
    covariances: Tensor
    is_near: tuple[bool, ...]
    bows: Matrix
    radii: Vector
    vertices: Tensor
    blends: Matrix
    edges: Tensor

    def take(self, chosen: Indices) -> Sites:
        """Return some of the sites."""
        return Sites(
            self.means[chosen],
            self.covariances[chosen],
            self.is_near,
            self.bows[chosen],
            self.radii[chosen],
            self.vertices[chosen],
            self.blends[chosen],
            self.edges[chosen],
        )
