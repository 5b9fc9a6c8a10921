"""Obstacles whose place is not known exactly, in rows: nothing of them is measured under way.

Given all that is measured, their place at any two steps has the covariance that it had at first.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.referee.conditional.rows import Parties
from radmpc.referee.conditional.tables import TimedRows
from radmpc.referee.tracks import Tracks

__all__ = ["Strays", "places_at", "strays_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Strays:
    """What an obstacle's place adds to each of E rows.

    Attributes
    ----------
    own : (E,) array
        To its variance [m²].
    linked : (E,) array
        To its covariance with the row before [m²].
    before : (E,) array
        To the variance of the row before [m²].
    """

    own: Vector
    linked: Vector
    before: Vector


def strays_of(moments: TimedRows, parties: Parties, tracks: Tracks) -> Strays:
    """Return what obstacles' places add to rows.

    Parameters
    ----------
    moments : TimedRows
        The rows.
    parties : Parties
        The encounters.
    tracks : Tracks
        The obstacles.
    """
    count, d = len(moments.windows), tracks.dimension
    made = Strays(np.zeros(count), np.zeros(count), np.zeros(count))
    place = _places(parties, tracks)[moments.encounters]
    at = np.flatnonzero(place >= 0)
    states = tracks.states[place[at], moments.windows[at]]
    fresh = tracks.disturbances[place[at], :d, :d]
    shares, normals = moments.shares, moments.normals
    mine = _on_track(normals[at], shares[at], tracks)
    made.own[at] = _product(mine, states, mine)
    made.own[at] += shares[at] ** 2 * _product(normals[at], fresh, normals[at])
    before = np.maximum(moments.before[at], 0)
    # The far end of a step stands where the next one begins.
    turns = moments.windows[before] < moments.windows[at]
    share = np.where(turns, 0.0, shares[before])
    theirs = _on_track(normals[before], share, tracks)
    linked = moments.before[at] >= 0
    crossed = _product(theirs, states, mine)
    crossed += share * shares[at] * _product(normals[before], fresh, normals[at])
    made.linked[at] = np.where(linked, crossed, 0.0)
    made.before[at] = np.where(linked & turns, _product(theirs, states, theirs), 0.0)
    return made


def places_at(
    parties: Parties, encounters: Indices, steps: Indices, tracks: Tracks | None, dimension: int
) -> Tensor:
    """Return covariances of obstacles' places at steps, (E, d, d); 0 where they are known [m²].

    Parameters
    ----------
    parties : Parties
        The encounters.
    encounters, steps : (E,) int array
        Which, and when.
    tracks : Tracks or None
        The obstacles; None where all are known exactly.
    dimension : int
        d.
    """
    found = np.zeros((len(steps), dimension, dimension))
    if tracks is not None:
        place = _places(parties, tracks)[encounters]
        at = np.flatnonzero(place >= 0)
        found[at] = tracks.positions[place[at], steps[at]]
    return found


def _places(parties: Parties, tracks: Tracks) -> Indices:
    """Return the track of each encounter, −1 where it has none, (B,)."""
    are_obstacles = np.array([cause == "obstacle" for cause in parties.causes], dtype=bool)
    result = np.full(len(are_obstacles), -1)
    result[are_obstacles] = tracks.places[parties.other[are_obstacles]]
    return result


def _on_track(normals: Matrix, shares: Vector, tracks: Tracks) -> Matrix:
    """Return ``n·P [(1 − s) + s Φ]`` as rows on place and velocity, (E, 2 d)."""
    d = tracks.dimension
    picked = np.eye(2 * d)[:d]
    s = shares[:, None, None]
    seen = (1.0 - s) * picked + s * (picked @ tracks.transition)
    return np.asarray(np.einsum("ed,edq->eq", normals, seen))


def _product(left: Matrix, middle: Tensor, right: Matrix) -> Vector:
    """Return ``left M right`` row by row."""
    return np.asarray(np.einsum("ei,eij,ej->e", left, middle, right))
