"""How far any place is from standing obstacles, and routes that keep room and have few corners."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.planners.certified.turned.grid import COARSE, Grid, finest
from radmpc.planners.certified.turned.narrow.tuning import TUNING
from radmpc.planners.certified.turned.straight import StandingFaces
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass, replace

__all__ = ["Clear", "Kept"]


@dataclass(frozen=True, slots=True, eq=False)
class Clear:
    """The distance to the nearest obstacle in the plane, interpolated between points of a grid.

    Attributes
    ----------
    grid : Grid
        The points.
    origin : (2,) array
        The first of them [m].
    field : (r, c) array
        Their distances, those far away cut off [m].
    least : (r, c) array
        No more than their distances, far away as well [m].
    inside : (r, c) array or None
        How far inside the workspace they are, negative outside [m]; None without one.
    """

    grid: Grid
    origin: Vector
    field: Matrix
    least: Matrix
    inside: Matrix | None = None

    @classmethod
    def of(cls, hazards: Hazards) -> Clear | None:
        """Return the distances, without borders; None where they tell nothing.

        Parameters
        ----------
        hazards : Hazards
            The fleet; double integrators in the plane, or nothing is returned.
        """
        are_double = all(m.vehicle.system.is_double_integrator for m in hazards.models)
        if hazards.dimension != 2 or not are_double:
            return None
        count, spacing = finest(hazards)
        # What the usual grid tells apart is told as it was.
        is_usual = count <= COARSE * TUNING.grid_points
        if not is_usual and spacing > COARSE * float(hazards.radii.min()):
            return None
        grid = Grid.of(hazards, TUNING.grid_points if is_usual else count)
        far = float(10.0 * hazards.radii.max() + grid.spacing)
        field, least = np.minimum(grid.distances, far), _least(grid)
        fields = field.reshape(grid.shape), least.reshape(grid.shape)
        inside = None
        if hazards.workspace is not None:
            lower, upper = hazards.workspace
            inside = np.minimum(grid.points - lower, upper - grid.points).min(axis=1)
            inside = inside.reshape(grid.shape)
        return cls(grid, grid.points[0], *fields, inside)

    def within_borders(self, radius: float) -> Clear:
        """Return the distances of a hull, borders of the workspace among them.

        Parameters
        ----------
        radius : float
            Of the hull [m]. Its center stays inside, so it may reach out by as much.
        """
        if self.inside is None:
            return self
        inside = self.inside + radius
        return replace(
            self,
            field=np.minimum(self.field, inside),
            least=np.minimum(self.least, inside),
            inside=None,
        )

    def at(self, places: Tensor) -> Tensor:
        """Return the distance at places, (...) [m], from their coordinates, (..., 2) [m]."""
        return self._between(self.field, places)

    def least_at(self, places: Tensor) -> Tensor:
        """Return the least that the distance may be at places, however far, (...) [m]."""
        return self._between(self.least, places) - self.grid.spacing

    def _between(self, field: Matrix, places: Tensor) -> Tensor:
        """Return a field between the points of the grid."""
        rows, columns = self.field.shape
        x = np.clip((places[..., 0] - self.origin[0]) / self.grid.spacing, 0.0, rows - 1.0)
        y = np.clip((places[..., 1] - self.origin[1]) / self.grid.spacing, 0.0, columns - 1.0)
        row = np.minimum(x.astype(np.int64), max(rows - 2, 0))
        column = np.minimum(y.astype(np.int64), max(columns - 2, 0))
        x, y = x - row, y - column
        flat, corner = field.ravel(), row * columns + column
        down, right = (columns if rows > 1 else 0), (1 if columns > 1 else 0)
        near = (1.0 - y) * flat[corner] + y * flat[corner + right]
        far = (1.0 - y) * flat[corner + down] + y * flat[corner + down + right]
        return np.asarray((1.0 - x) * near + x * far)

    def along(self, begin: Tensor, end: Tensor) -> Tensor:
        """Return the least distance along straight pieces, (...) [m].

        Parameters
        ----------
        begin, end : (..., 2) array
            Their ends [m].
        """
        longest = float(np.abs(end - begin).max(initial=0.0))
        count = max(2, int(longest / (TUNING.sampled * self.grid.spacing)) + 2)
        shares = np.linspace(0.0, 1.0, count)[:, None]
        between = begin[..., None, :] + shares * (end - begin)[..., None, :]
        return np.asarray(self.at(between).min(axis=-1))

    def pulled(self, route: Matrix, clearance: float) -> Matrix:
        """Return the corners of a route, pulled straight where it keeps room, or loses none.

        Parameters
        ----------
        route : (p, 2) array
            Points of the route, close to each other [m].
        clearance : float
            Distance from obstacles that is worth a longer route [m].
        """
        here = self.at(route)
        kept, i = [0], 0
        while i < len(route) - 1:
            following = np.arange(i + 1, min(len(route), i + 1 + TUNING.straight_points))
            before = np.minimum.accumulate(here[i : following[-1] + 1])[1:]
            straight = self.along(np.broadcast_to(route[i], (len(following), 2)), route[following])
            is_clear = straight >= np.minimum(clearance, before) - TUNING.lost_clearance
            is_clear[0] = True
            i = int(following[np.flatnonzero(is_clear)[-1]])
            kept.append(i)
        return np.asarray(route[kept])


def _least(grid: Grid) -> Vector:
    """Return distances where they are known, elsewhere how far it is to there, (p,) [m]."""
    is_known, least = np.isfinite(grid.distances), grid.distances.copy()
    if not is_known.any():
        least[:] = np.ptp(grid.points, axis=0).max()
    elif not is_known.all():
        least[~is_known] = cKDTree(grid.points[is_known]).query(grid.points[~is_known])[0]
    return least


Kept = tuple[Clear | StandingFaces, float]
"""How far places are from obstacles, and standard deviations to keep from them [-]."""
