"""Probability that vehicles lose the range that they keep to each other.

The disc of a range is convex, what lies outside it is not: a polytope within the disc is kept face
by face, as the workspace is. Polytopes of few faces count little twice, those of many waste little
of the disc: each pair takes the one that makes it out best.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.model.relations.keep import keep_pairs
from radmpc.model.scenario import Scenario
from radmpc.referee.bound.workspace import face_risks
from radmpc.referee.encounters import Encounters
from radmpc.referee.gather import relative_motion
from radmpc.referee.motion import FleetMotion
from radmpc.referee.polytopes import polytopes_within

__all__ = ["charged_faces", "range_faces", "range_risks"]

_TOGETHER = 500
"""Pairs at faces that are looked at in one go [-]: memory against the overhead per face."""


def range_faces(scenario: Scenario, motion: FleetMotion) -> list[list[tuple[Matrix, Encounters]]]:
    """Return all pairs that keep a range against the faces of polytopes within it.

    Parameters
    ----------
    scenario : Scenario
        Who keeps which range.
    motion : FleetMotion
        Of the fleet.

    Returns
    -------
    list of list of ((d,) array, Encounters)
        For each polytope its faces: the unit normal inward, and all relative motions against the
        half-space behind the face.
    """
    names = [vehicle.name for vehicle in scenario.vehicles]
    pairs = keep_pairs(scenario.keep, names)
    first, other = (np.array([pair[k] for pair in pairs], dtype=np.int64) for k in (0, 1))
    reach = np.array([within for _, _, within in pairs])
    batch = relative_motion(motion, first, other, "range")
    polytopes = []
    for normals, distance in polytopes_within(scenario.dimension):
        faces = []
        for outward in normals:
            corners = (distance * reach)[:, None] * outward
            wall = np.broadcast_to(-outward, (len(pairs), 1, outward.size))
            faces.append((-outward, batch.against(corners[:, None, None], wall)))
        polytopes.append(faces)
    return polytopes


def range_risks(
    scenario: Scenario, motion: FleetMotion, *, intervals: bool
) -> tuple[Encounters, Vector]:
    """Return an upper bound on the probability that each range is lost, step by step.

    Parameters
    ----------
    scenario : Scenario
        Who keeps which range.
    motion : FleetMotion
        Of the fleet.
    intervals : bool
        Whether the path between the steps counts.

    Returns
    -------
    Encounters and (B, T+1) array
        The pairs, and the risk of each with the polytope that suits it best.
    """
    polytopes = range_faces(scenario, motion)
    totals = _totals(polytopes, motion, intervals=intervals)
    pairs = polytopes[0][0][1]
    return pairs, totals[_best(totals), np.arange(len(pairs.first))]


def charged_faces(
    scenario: Scenario, motion: FleetMotion, *, intervals: bool
) -> Iterator[tuple[Matrix, Encounters]]:
    """Yield the faces by which ranges are charged: of each pair those of the best polytope.

    Parameters
    ----------
    scenario, motion, intervals
        As in `range_risks`.

    Yields
    ------
    (B, d) array and Encounters
        Unit normals inward, and relative motions against the half-spaces behind.
    """
    polytopes = range_faces(scenario, motion)
    best = _best(_totals(polytopes, motion, intervals=intervals))
    for number, faces in enumerate(polytopes):
        chosen = np.flatnonzero(best == number)
        if chosen.size:
            yield from _stacked(faces, chosen)


def _stacked(
    faces: list[tuple[Matrix, Encounters]], chosen: Indices
) -> Iterator[tuple[Matrix, Encounters]]:
    """Yield faces of some pairs together, face by face, as many as leave arrays small."""
    many = max(1, _TOGETHER // chosen.size)
    batch = faces[0][1]
    for start in range(0, len(faces), many):
        some = faces[start : start + many]
        rows = np.tile(chosen, len(some))
        corners = np.concatenate([face.vertices[chosen] for _, face in some])
        normals = np.repeat([normal for normal, _ in some], chosen.size, axis=0)
        yield normals, batch.take(rows).against(corners, normals[:, None])


def _totals(
    polytopes: list[list[tuple[Matrix, Encounters]]], motion: FleetMotion, *, intervals: bool
) -> Tensor:
    """Return what each polytope charges each pair step by step, (P, B, T+1)."""
    count, steps, _ = polytopes[0][0][1].means.shape
    totals = np.zeros((len(polytopes), count, steps))
    for number, faces in enumerate(polytopes):
        for normals, batch in _stacked(faces, np.arange(count)):
            risks = face_risks(normals, batch, motion, intervals=intervals)
            totals[number] += risks.reshape(-1, count, steps).sum(axis=0)
    return totals


def _best(totals: Tensor) -> Indices:
    """Return the polytope that charges each pair least, (B,)."""
    return np.asarray(totals.sum(axis=2).argmin(axis=0))
