"""Distances to obstacles for the second simulator, by shapely and from the half-spaces of hulls."""

from __future__ import annotations

import numpy as np
import shapely
from scipy.spatial import ConvexHull

from radmpc.model.obstacle import BoxShape, MovingShape, Obstacle, PolygonShape, TrackShape


class Distance:
    """Distance of places to an obstacle as it is at a share of a step; 0 inside."""

    def __init__(self, thing: Obstacle, dt: float, step: int, moving: bool) -> None:
        shape = thing.shape
        self.travel = 0.0
        self._known: dict[float, tuple[object, np.ndarray]] = {}
        if isinstance(shape, MovingShape | TrackShape):
            before = _expected(shape, dt, step)
            after = _expected(shape, dt, step + 1) if moving else before
            sweep = (after[None] - before[:, None]).reshape(-1, before.shape[1])
            self.travel = float(np.linalg.norm(sweep, axis=1).max())
            self._outlines = before, after
        else:
            corners = _outline(shape)
            self._outlines = None
            solid = shape
            if isinstance(shape, PolygonShape):
                solid = _solid(corners, keep=True)
            self._known[0.0] = solid, ConvexHull(corners).equations

    def __call__(self, share: float, places: np.ndarray) -> np.ndarray:
        return _gaps(self._at(share)[0], places) if len(places) else np.zeros(0)

    def at_least(self, share: float, places: np.ndarray) -> np.ndarray:
        """How far places are beyond a face of the hull: not above the distance, and cheap."""
        equations = self._at(share)[1]
        return (places @ equations[:, :-1].T + equations[:, -1]).max(axis=1)

    def _at(self, share: float) -> tuple[object, np.ndarray]:
        """Return the obstacle at a share of the step, and the faces of its hull."""
        share = 0.0 if self._outlines is None else share
        if share not in self._known:
            before, after = self._outlines
            cloud = (1.0 - share) * before[:, None] + share * after[None]
            corners = cloud.reshape(-1, before.shape[1])
            self._known[share] = _solid(corners, keep=False), ConvexHull(corners).equations
        return self._known[share]


def _expected(shape: MovingShape | TrackShape, dt: float, step: int) -> np.ndarray:
    """Return where the corners of what moves are expected."""
    if isinstance(shape, MovingShape):
        return shape.outlines[step]
    d = shape.outline.shape[1]
    return shape.outline + shape.start[:d] + step * dt * shape.start[d:]


def _outline(shape: BoxShape | PolygonShape) -> np.ndarray:
    """Return the corners of a shape that stands still."""
    if isinstance(shape, PolygonShape):
        return shape.vertices
    sides = np.stack([shape.lower, shape.upper], axis=1)
    return np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, len(sides))


def _solid(points: np.ndarray, *, keep: bool):
    """Return a polygon, or a polytope's faces and triangles; ``keep`` the order of the points."""
    if points.shape[1] == 2:
        polygon = shapely.Polygon(points) if keep else shapely.MultiPoint(points).convex_hull
        shapely.prepare(polygon)
        return polygon
    found = ConvexHull(points)
    return found.equations, points[found.simplices]


def _gaps(solid, places: np.ndarray) -> np.ndarray:
    """Return the distances of places to a solid."""
    if isinstance(solid, shapely.Geometry):
        return shapely.distance(shapely.points(places), solid)
    if isinstance(solid, BoxShape):
        outside = np.maximum(np.maximum(solid.lower - places, places - solid.upper), 0.0)
        return np.asarray(np.linalg.norm(outside, axis=1))
    equations, triangles = solid
    inside = np.all(places @ equations[:, :3].T + equations[:, 3] <= 0.0, axis=1)
    return np.where(inside, 0.0, _to_triangles(places[:, None], triangles).min(axis=1))


def _to_triangles(places: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return distances to triangles: to the plane above one, else to its nearest side."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    above, along = True, np.inf
    for p, q in ((a, b), (b, c), (c, a)):
        above = above & (((places - p) * np.cross(normal, q - p)).sum(axis=2) >= 0.0)
        share = ((places - p) * (q - p)).sum(axis=2) / ((q - p) ** 2).sum(axis=1)
        foot = p + np.clip(share, 0.0, 1.0)[:, :, None] * (q - p)
        along = np.minimum(along, np.linalg.norm(places - foot, axis=2))
    return np.where(above, np.abs(((places - a) * normal).sum(axis=2)), along)
