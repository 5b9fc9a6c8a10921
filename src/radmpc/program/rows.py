"""Chance rows of avoidances over all windows: faces, noise, sagitta, and the presolve."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Tensor, Vector
from radmpc.gaussian import CONVEX_RISK, GAUSSIAN, Tail, clearance
from radmpc.program.avoidance import Body, End, RowBlock, Windows
from radmpc.program.program import PRESOLVED_RISK, PRESOLVED_SHARE
from radmpc.program.reserve import shares_of_reserve
from radmpc.program.row_layout import empty_block, lay_out

__all__ = ["avoidance_rows"]

_LEAST_DEVIATION = 1e-8
"""Least standard deviation of a row with noise [m]: solvers refuse slopes of 1e15 and more, which
deviations left over by cancellation give. It costs less than a tenth of a micrometer of margin."""

_SOME = 0.25
"""Share of Δ that a tight start or goal may risk for a larger share of the sagitta's reserve [-]:
more offers more alternatives there, which cost nodes."""


def avoidance_rows(
    body: Body, windows: Windows, risk_bound: float, tail: Tail = GAUSSIAN
) -> RowBlock:
    """Return the rows of avoidances, or the risk of their windows alone if all are presolved.

    A window is presolved if one of its faces holds under every admissible control with a risk of
    at most `PRESOLVED_RISK` (less where Δ is tiny): it is charged that risk and needs no choice. A
    face that no admissible control satisfies even without noise is no alternative.

    Parameters
    ----------
    body : Body
        What avoids.
    windows : Windows
        What it avoids, and when.
    risk_bound : float
        Δ, against which the risk of a presolved window is small.
    tail : Tail
        Of what the rows deviate by.

    Returns
    -------
    RowBlock
        Without rows where every window is presolved.
    """
    num_windows = len(windows.near)
    enough = float(tail.clearance_for(min(PRESOLVED_RISK, PRESOLVED_SHARE * risk_bound)))
    before = windows.numbers
    after = before + 1
    if not windows.intervals:
        ends = [_end(body, windows.normals, windows.near, after, body.covariances[after])]
        sagitta, shares = np.zeros(windows.near.shape), [np.full(windows.near.shape, 0.5)]
    else:
        here = (body, windows.normals, windows.near, before)
        there = (body, windows.normals, windows.far, after)
        ends = [_end(*here, body.covariances[before])]
        if body.bent is not None:
            ends.append(_end(*here, body.bent[before], kind=1))
        ends.append(_end(*there, body.covariances[after], is_near=False))
        sagitta = _worst_sagitta(body, windows)
        levels = enough, float(tail.clearance_for(min(_SOME * risk_bound, CONVEX_RISK)))
        near = [np.minimum.reduce([_spare(end, c) for end in ends[:-1]]) for c in levels]
        far = [_spare(ends[-1], c) for c in levels]
        shares = shares_of_reserve(near, far, sagitta, _first_and_last(windows))
    kept = [[_clearance(end, sagitta, share) for end in ends] for share in shares]
    worst = [np.asarray(np.minimum.reduce(each)) for each in kept]
    best = np.minimum.reduce([clearance(end.most, end.deviations) for end in ends])
    safest_clearance = worst[0].max(axis=1)
    is_presolved = safest_clearance >= enough
    safest = worst[0].argmax(axis=1)
    every = np.arange(num_windows)
    risks = sum(tail.probability(each[every, safest]) for each in kept[0])
    presolved_risk = float(np.sum(np.asarray(risks)[is_presolved]))
    if np.all(is_presolved):
        return empty_block(presolved_risk, num_windows)
    possible = (best >= 0.0) & ~is_presolved[:, None]
    offered = np.stack([possible & np.isfinite(share) for share in shares], axis=2)
    window, face, option = np.nonzero(offered)
    share = np.stack(shares, axis=2)[window, face, option]
    counts = np.bincount(window, minlength=num_windows)[~is_presolved]
    return lay_out(
        body, windows, ends, (window, face, share), presolved_risk, (~is_presolved, counts)
    )


def _end(
    body: Body,
    normals: Tensor,
    offsets: Vector,
    steps: Indices,
    covariances: Tensor,
    *,
    kind: int = 0,
    is_near: bool = True,
) -> End:
    """Rate one end of every window over the whole reach."""
    reach = normals * body.lower[steps][:, None, :], normals * body.upper[steps][:, None, :]
    smallest, largest = np.minimum(*reach).sum(axis=2), np.maximum(*reach).sum(axis=2)
    variances = np.einsum("wfa,wab,wfb->wf", normals, covariances, normals)
    deviations = np.sqrt(np.maximum(variances, 0.0))
    return End(
        kind,
        is_near,
        steps,
        offsets,
        np.where(deviations > 0.0, np.maximum(deviations, _LEAST_DEVIATION), 0.0),
        offsets - largest,
        # Reach is exact only up to rounding: keep what misses by less than a micrometer.
        offsets - smallest + 1e-6,
    )


def _spare(end: End, enough: float) -> Vector:
    """Return what an end keeps beyond some deviations, wherever the body may be [m]."""
    return end.least - enough * end.deviations


def _clearance(end: End, sagitta: Vector, share: Vector) -> Vector:
    """Return the least clearance of an end over the reach, its share of the reserve kept."""
    if not sagitta.any():
        return clearance(end.least, end.deviations)
    kept = share if end.is_near else 1.0 - share
    reserve = 4.0 * np.square(np.where(np.isfinite(share), kept, 0.5)) * sagitta
    return clearance(end.least - reserve, end.deviations)


def _first_and_last(windows: Windows) -> tuple[Indices, Indices]:
    """Return the places of the first and of the last window of every thing."""
    ends = np.flatnonzero(np.diff(windows.things, append=windows.things[-1] + 1))
    return np.append(0, ends[:-1] + 1), ends


def _worst_sagitta(body: Body, windows: Windows) -> Vector:
    """Return the largest sagitta of the mean curve toward each face, (w, f) [m]."""
    sagitta = np.zeros(windows.near.shape)
    for part in body.parts:
        bounds = np.maximum(part.control_bounds, 0.0)[windows.numbers]
        sagitta += np.einsum("wfc,wc->wf", np.abs(windows.normals @ part.sagitta), bounds)
    return sagitta
