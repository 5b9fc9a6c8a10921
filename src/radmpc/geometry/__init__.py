"""Convex polytopes, and polygons split into them."""

from radmpc.geometry.inner import directions_ahead, inner_corners, inner_faces, inner_faces_ahead
from radmpc.geometry.polygon import convex_pieces, planar
from radmpc.geometry.polytope import Polytope, box, halfspaces, hull, sphere_directions

__all__ = [
    "Polytope",
    "box",
    "convex_pieces",
    "directions_ahead",
    "halfspaces",
    "hull",
    "inner_corners",
    "inner_faces",
    "inner_faces_ahead",
    "planar",
    "sphere_directions",
]
