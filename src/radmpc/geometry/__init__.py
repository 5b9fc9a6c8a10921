"""Convex polytopes, and polygons split into them."""

from radmpc.geometry.inner import inner_faces
from radmpc.geometry.polygon import convex_pieces, planar
from radmpc.geometry.polytope import Polytope, box, halfspaces, hull, sphere_directions

__all__ = [
    "Polytope",
    "box",
    "convex_pieces",
    "halfspaces",
    "hull",
    "inner_faces",
    "planar",
    "sphere_directions",
]
