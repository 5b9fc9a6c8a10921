"""Half-spaces at moments, turned into rows on the deviations of states."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.records import replace
from radmpc.referee.bound.persistence import TELLING
from radmpc.referee.conditional.loops import Loops, since, together
from radmpc.referee.conditional.rows import Flags, HalfspaceRows, Parties
from radmpc.referee.conditional.spreads import deviations_of
from radmpc.referee.conditional.strays import strays_of
from radmpc.referee.conditional.tables import TimedRows
from radmpc.referee.reserve import in_deviations
from radmpc.referee.tails import exceeding
from radmpc.referee.tracks import Tracks

__all__ = ["compiled", "with_telling_links"]


def compiled(
    moments: TimedRows, parties: Parties, loops: Loops, tracks: Tracks | None
) -> HalfspaceRows:
    """Return half-spaces as rows on states, with what they share with the rows before.

    Parameters
    ----------
    moments : TimedRows
        The half-spaces.
    parties : Parties
        The encounters.
    loops : Loops
        Of the fleet.
    tracks : Tracks or None
        Obstacles whose place is not known exactly; None where all are.
    """
    first = parties.first[moments.encounters]
    is_pair = parties.are_pairs[moments.encounters]
    other = np.where(is_pair, parties.other[moments.encounters], 0)
    rows_first = _on_states(moments, first, loops)
    rows_other = np.where(is_pair[:, None], _on_states(moments, other, loops), 0.0)
    spread = _spread(loops, first, other, is_pair)
    own = np.einsum("ed,edf,ef->e", moments.normals, spread, moments.normals)
    linked, at = moments.before >= 0, moments.before
    # The far end of a step's last part stands at the near end of the next one's first.
    turns = linked & (moments.windows[at] < moments.windows)
    normals = moments.normals[at]
    positions = np.einsum("ed,edn->en", normals, loops.picks[first])
    others = np.einsum("ed,edn->en", normals, loops.picks[other])
    others = np.where(is_pair[:, None], others, 0.0)
    crossed = np.einsum("ed,edf,ef->e", normals, spread, moments.normals)
    crossed = moments.shares[at] * moments.shares * crossed
    fresh, link = np.square(moments.shares) * own, np.where(turns | ~linked, 0.0, crossed)
    rest = np.zeros(len(link))
    if tracks is not None:
        strays = strays_of(moments, parties, tracks)
        fresh, link, rest = fresh + strays.own, link + strays.linked, strays.before
    return HalfspaceRows(
        encounters=moments.encounters,
        windows=moments.windows,
        normals=moments.normals,
        margins=moments.margins,
        shares=moments.shares,
        bends=moments.bends,
        before=moments.before,
        nested=moments.nested,
        first=rows_first,
        other=rows_other,
        fresh=fresh,
        link_first=np.where(turns[:, None], positions, rows_first[at]),
        link_other=np.where(turns[:, None], others, rows_other[at]),
        link_fresh=link,
        link_rest=rest,
    )


def _on_states(moments: TimedRows, vehicles: Indices, loops: Loops) -> Matrix:
    """Return ``n·[(1 − s) P + s P F − s (1 − s) G − β G]`` per row, (E, n)."""
    s = moments.shares[:, None, None]
    onward: Tensor = loops.picks @ loops.transitions[:, 0]
    matrix = (1.0 - s) * loops.picks[vehicles] + s * onward[vehicles]
    matrix -= (s * (1.0 - s) + moments.bends[:, None, None]) * loops.bends[vehicles]
    return np.asarray(np.einsum("ed,edn->en", moments.normals, matrix))


def _spread(loops: Loops, first: Indices, other: Indices, are_pairs: Flags) -> Tensor:
    """Return what a step adds to the covariance of relative positions, (E, d, d) [m²]."""
    # What a filter makes of the noise comes on top of the position's own, which is always the same.
    fresh_of_all = loops.picks @ loops.disturbance[:, 0] @ loops.picks.transpose(0, 2, 1)
    pairs = are_pairs[:, None, None]
    spread = fresh_of_all[first] + np.where(pairs, fresh_of_all[other], 0.0)
    if loops.pushes is not None:
        met = loops.picks @ loops.pushes[:, 0]
        both = met[first] @ met[other].transpose(0, 2, 1)
        spread -= np.where(pairs, both + both.transpose(0, 2, 1), 0.0)
    return np.asarray(spread)


def with_telling_links(
    rows: HalfspaceRows,
    widths: Vector,
    loops: Loops,
    parties: Parties,
    leg: tuple[int, int | None],
) -> HalfspaceRows:
    """Cut the links whose rows the certificate charges whole, because little is gained by them.

    Parameters
    ----------
    rows : HalfspaceRows
        All of them.
    widths : (B,) array
        Into how many parts each encounter is cut [-].
    loops : Loops
        Of the fleet.
    parties : Parties
        The encounters.
    leg : tuple of int and int or None
        Number of steps T, and the independent steps that covariances were estimated from; None is
        that they are known.
    """
    horizon, samples = leg
    if not (rows.before >= 0).any():
        return rows
    noise = since(loops, horizon, 0, is_measured=False)
    noise = together(noise, loops, parties.first, parties.others)
    spread = deviations_of(rows, parties, noise)
    charged = exceeding(in_deviations(rows.margins, spread), samples)
    sums = np.bincount(rows.encounters, charged, len(parties.causes))
    least = (TELLING * sums / widths)[rows.encounters]
    telling = (charged > least) & (charged[rows.before] > 1e-3 * charged)
    return replace(rows, before=np.where(telling | rows.nested, rows.before, -1))
