"""Half-spaces between a group of vehicles and what it passes, turned to the latest paths.

The faces of a program are a choice of directions made beforehand. Any other direction is as valid:
what a path keeps from a convex set along one unit normal, it keeps from the set. Turned to the path
at hand, half-spaces allow it at least as much as faces do, and paths nearby mostly more.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.geometry import inner_faces
from radmpc.planners.certified.turned.near import Near, squared_limits
from radmpc.planners.certified.turned.neighbors import near_pieces, near_vehicles
from radmpc.planners.certified.turned.normals.at_steps import (
    beside_pieces,
    beside_vehicles,
    is_nearest_best,
)
from radmpc.planners.certified.turned.normals.directions import closest_approach, from_obstacles
from radmpc.planners.certified.turned.normals.encounter import (
    Encounter,
    ends_of,
    furthest,
    noise_of,
)
from radmpc.planners.certified.turned.normals.pair_normals import (
    end_normals,
    pair_encounter,
    pair_normals,
)
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces, laid_out
from radmpc.planners.certified.turned.paths import Paths
from radmpc.program.hazards import Hazards

__all__ = ["half_spaces"]


def half_spaces(
    hazards: Hazards,
    paths: Paths,
    group: Sequence[int],
    near: Near,
    ahead: Paths | None = None,
    counts: npt.NDArray[np.bool_] | None = None,
) -> HalfSpaces:
    """Turn half-spaces to the paths of a group, at all windows where something is near.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    paths : Paths
        Everyone's latest paths.
    group : sequence of int
        Vehicles that are planned; ascending.
    near : Near
        What counts as near.
    ahead : Paths or None
        Where paths are expected to move, which directions are turned to; None is the latest paths.
    counts : (N+1, T) bool array or None
        Who counts in which windows; last, whether obstacles and borders do. None is all.
    """
    ahead = paths if ahead is None else ahead
    both, members = (paths, ahead), np.asarray(group)
    pairs = near_vehicles(hazards, paths, members, near)
    found = [_between(hazards, both, pairs, near, counts)]
    if hazards.shapes.count:
        found.append(_around(hazards, both, members, near))
    if hazards.workspace is not None:
        found.append(_inside(hazards, paths, members, near))
    if hazards.ranges:
        found.append(_within(hazards, paths, members, near))
    joined = found[0] if len(found) == 1 else HalfSpaces.joined(found)
    return joined if counts is None else joined.of(counts[joined.second, joined.windows])


def _between(
    hazards: Hazards,
    both: tuple[Paths, Paths],
    pairs: tuple[Indices, Indices],
    near: Near,
    counts: npt.NDArray[np.bool_] | None,
) -> HalfSpaces:
    """Return half-spaces between pairs of vehicles, along the line of closest approach."""
    paths = both[0]
    one, two = pairs
    if counts is not None:
        is_asked = counts[two].any(axis=1)
        one, two = one[is_asked], two[is_asked]
    relative = paths.means[one] - paths.means[two]
    closest = closest_approach(relative) if hazards.intervals else relative[:, 1:]
    apart = np.sqrt(np.einsum("ptd,ptd->pt", closest, closest))
    radii = hazards.radii[one] + hazards.radii[two]
    spread = np.sqrt(hazards.variances[one] + hazards.variances[two])
    limit = radii[:, None] + near.clearance * spread + near.reach
    is_near = apart < limit
    if counts is not None:
        is_near &= counts[two]
    number, window = np.nonzero(is_near)
    pairing = one[number], two[number], window
    keys = (pairing[0] * hazards.count + pairing[1]) * hazards.horizon + window
    if is_nearest_best(hazards, of_pieces=False):
        return beside_vehicles(hazards, both, pairing, keys, is_refined=near.is_refined)
    normals = pair_normals(hazards, both, pairing, radii[number], is_refined=near.is_refined)
    met = pair_encounter(hazards, paths, pairing, radii[number])
    if not (near.is_start_given and hazards.intervals):
        return laid_out(met, normals, pairing, keys, near.is_nearest_asked)
    is_given, ends = window == 0, np.flatnonzero((window == 0) | (window == hazards.horizon - 1))
    if ends.size:
        who, apart_at = tuple(each[ends] for each in pairing), (radii[number[ends]], near.clearance)
        normals[ends], is_kept = end_normals(hazards, paths, who, normals[ends], apart_at)
        is_given[ends] &= is_kept
    return laid_out(met, normals, pairing, keys, near.is_nearest_asked, is_given)


def _around(
    hazards: Hazards, both: tuple[Paths, Paths], members: Indices, near: Near
) -> HalfSpaces:
    """Return half-spaces between vehicles and obstacles, by the direction of most room."""
    paths, ahead = both
    shapes, path = hazards.shapes, paths.means[members]
    begin = path[:, :-1] if hazards.intervals else path[:, 1:]
    places, pieces = near_pieces(hazards, path, members, near)
    lower = np.minimum(begin[places], path[places, 1:])
    upper = np.maximum(begin[places], path[places, 1:])
    gaps = np.maximum(shapes.lower[pieces] - upper, lower - shapes.upper[pieces])
    gaps = np.maximum(gaps, 0.0)
    limit = squared_limits(hazards, (members, places, pieces), near)
    number, window = np.nonzero(np.einsum("pwd,pwd->pw", gaps, gaps) < limit)
    piece, first = pieces[number], members[places[number]]
    base = hazards.count**2 * hazards.horizon
    keys = base + (first * shapes.count + piece) * hazards.horizon + window
    if is_nearest_best(hazards, of_pieces=True):
        which = first, piece, window
        return beside_pieces(hazards, both, which, keys, is_refined=near.is_refined)
    radius = hazards.radii[first][:, None]
    later = shapes.vertices[piece, window + 1]
    corners = ends_of(hazards, shapes.vertices[piece, window], later)

    def supports(directions: Tensor) -> tuple[Vector, Vector]:
        end = furthest(directions, later) + radius
        return (furthest(directions, corners[0]) + radius if hazards.intervals else end), end

    def encounter(paths: Paths) -> Encounter:
        return Encounter(
            ends_of(hazards, paths.means[first, window], paths.means[first, window + 1]),
            noise_of(hazards, window, first, None, piece),
            paths.sagittas[first, window],
            supports,
            hazards.is_isotropic,
        )

    faces, moved = shapes.faces[piece, window], None
    met = encounter(paths)
    if near.is_refined and piece.size:
        moved = encounter(ahead)
    normals = from_obstacles((met, moved), (faces, corners))
    which = first, np.full(piece.size, -1), window
    return laid_out(met, normals, which, keys, near.is_nearest_asked)


def _inside(hazards: Hazards, paths: Paths, members: Indices, near: Near) -> HalfSpaces:
    """Return the faces of the workspace that vehicles come near."""
    d = hazards.dimension
    lower, upper = hazards.workspace or (np.full(d, -np.inf), np.full(d, np.inf))
    sides = np.concatenate([np.eye(d), -np.eye(d)])
    limits = np.broadcast_to(np.concatenate([lower, -upper]), (members.size, 2 * d))
    base = hazards.count * (hazards.count + hazards.shapes.count)
    who = members, None, base + members * len(sides)
    return _before_faces(hazards, paths, who, (sides, limits), near)


def _within(hazards: Hazards, paths: Paths, members: Indices, near: Near) -> HalfSpaces:
    """Return the faces of the polytopes within ranges that members come near."""
    one, two, reach = (np.array(column) for column in zip(*hazards.ranges, strict=True))
    mine = np.flatnonzero(np.isin(one, members) | np.isin(two, members))
    outward, share = inner_faces(hazards.dimension)
    limits = np.repeat(-share * reach[mine, None], len(outward), axis=1)
    base = hazards.count * (hazards.count + hazards.shapes.count + 2 * hazards.dimension)
    who = one[mine], two[mine], base + mine * len(outward)
    return _before_faces(hazards, paths, who, (-outward, limits), near)


def _before_faces(
    hazards: Hazards,
    paths: Paths,
    who: tuple[Indices, Indices | None, Indices],
    faces: tuple[Matrix, Matrix],
    near: Near,
) -> HalfSpaces:
    """Return those faces of convex sets that vehicles, or one relative to another, come near."""
    (one, two, numbers), (sides, limits) = who, faces
    means, hang, variances = paths.means[one], paths.sagittas[one], hazards.variances[one]
    if two is not None:
        means, hang = means - paths.means[two], hang - paths.sagittas[two]
        variances = variances + hazards.variances[two]
    heights = means @ sides.T - limits[:, None]
    lowest = heights[:, 1:]
    if hazards.intervals:
        lowest = np.minimum(heights[:, :-1], lowest)
    spread = np.sqrt(variances)[:, :, None]
    place, window, face = np.nonzero(lowest < near.clearance * spread + near.reach)
    first, second = one[place], None if two is None else two[place]

    def supports(directions: Tensor) -> tuple[Vector, Vector]:
        reach = np.broadcast_to(limits[place, face][:, None], directions.shape[:2])
        return reach, reach

    encounter = Encounter(
        ends_of(hazards, means[place, window], means[place, window + 1]),
        noise_of(hazards, window, first, second),
        hang[place, window],
        supports,
        hazards.is_isotropic,
    )
    keys = (numbers[place] + face) * hazards.horizon + window
    others = np.full(first.size, -1) if second is None else second
    return laid_out(encounter, sides[face], (first, others, window), keys)
