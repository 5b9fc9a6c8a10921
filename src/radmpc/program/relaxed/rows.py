"""Cones around a hazard as the rows of one avoidance per instant."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.gaussian import Tail, clearance
from radmpc.program.avoidance import Part, RowBlock
from radmpc.program.relaxed.cones import Cones
from radmpc.program.relaxed.instants import Instants
from radmpc.program.relaxed.levels import levels_of
from radmpc.records import dataclass, replace

__all__ = ["DROPPED", "ConeRows", "cone_rows"]

Flags = npt.NDArray[np.bool_]

DROPPED = 1e-4
"""Share of Δ up to which an instant's risk is left out [-], wherever the body may be: a relaxation
may leave out what it likes, and this costs nothing that could be seen."""

_LEAST_DEVIATION = 1e-8
"""Standard deviation below which a row asks for its half-space without any margin [m]: solvers
refuse slopes of 1e15 and more, and less is asked so."""

_REACH = 1e-6
"""By how much reach may miss a cone that is offered all the same [m]: reach is exact up to
rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class ConeRows:
    """The rows of one hazard, wherever the body's outputs are in a program.

    Attributes
    ----------
    block : RowBlock
        The rows without their coefficients.
    instant : (r,) int array
        The instant of each row.
    normals : (r, d) array
        Its unit vector away from the hazard [-].
    """

    block: RowBlock
    instant: Indices
    normals: Matrix

    def over(self, instants: Instants) -> RowBlock:
        """Return the rows over the outputs of a program.

        Parameters
        ----------
        instants : Instants
            The same instants of the same bodies, with their places in that program.
        """
        rows, outputs, values = _entries(instants, self.instant, self.normals)
        is_any = values != 0.0
        return replace(
            self.block,
            entry_rows=rows[is_any].astype(np.int32),
            entry_outputs=outputs[is_any].astype(np.int32),
            entry_values=values[is_any],
        )


def cone_rows(
    instants: Instants, cones: Cones, risk_bound: float, tail: Tail, *, is_shared: bool
) -> ConeRows:
    """Return the rows of one hazard: an avoidance per instant, an alternative per cone.

    Parameters
    ----------
    instants : Instants
        Where the body is.
    cones : Cones
        Around the hazard, for the same instants.
    risk_bound : float
        Δ [-].
    tail : Tail
        Of what the rows deviate by.
    is_shared : bool
        Whether all instants are one event, charged once at the largest risk: what a charge for the
        whole path is at least. Otherwise every instant is charged.

    Returns
    -------
    ConeRows
        Without rows where every instant is clear throughout its reach.
    """
    is_there = np.isfinite(cones.offsets)
    ends = cones.normals * instants.lower[:, None], cones.normals * instants.upper[:, None]
    least, most = np.minimum(*ends).sum(axis=2), np.maximum(*ends).sum(axis=2)
    deviations = np.where(cones.deviations >= _LEAST_DEVIATION, cones.deviations, 0.0)
    deviations = np.where(is_there, deviations, 1.0)
    enough = float(tail.clearance_for(DROPPED * risk_bound))
    worst = clearance(np.where(is_there, least - cones.offsets, -np.inf), deviations)
    is_asked = (worst.max(axis=1) < enough) & ~cones.is_void
    is_within = is_asked[:, None] & is_there & (most - cones.offsets >= -_REACH)
    is_offered, parents = _offered(is_within, cones.parents)
    instant, cone = np.nonzero(is_offered)
    steps = instants.windows[instant] + 1
    # Rows are in the order of instants.
    begins = np.append(True, instant[1:] != instant[:-1])[: instant.size]
    firsts, event_steps = np.cumsum(begins) - 1, steps[begins]
    if is_shared and instant.size:
        firsts, event_steps = np.zeros(instant.size, dtype=np.int64), steps[:1]
    nothing = np.zeros(0, dtype=np.int64)
    block = RowBlock(
        nothing,
        nothing,
        np.zeros(0),
        offsets=-cones.offsets[instant, cone],
        deviations=deviations[instant, cone],
        events=firsts.astype(np.int32),
        event_steps=event_steps,
        alternative_sizes=np.ones(instant.size, dtype=np.int32),
        avoidance_sizes=np.bincount(instant, minlength=instants.count)[is_asked],
        avoidance_windows=instants.windows[is_asked],
        presolved_risk=0.0,
        num_presolved=int(np.count_nonzero(~is_asked)),
        alternative_parents=parents[instant, cone].astype(np.int32),
    )
    return ConeRows(block, instant, cones.normals[instant, cone])


def _offered(is_within: Flags, parents: Indices) -> tuple[Flags, Indices]:
    """Return which cones are offered, and the number of the one that each is part of.

    Narrow cones that are within reach are; wide ones where they stand for several of these, and
    for fewer than the next wider one that is offered.

    Parameters
    ----------
    is_within : (I, c) bool array
        Cones within reach.
    parents : (c,) int array
        The wider cone that each is part of; -1 where there is none.

    Returns
    -------
    is_offered : (I, c) bool array
        Those that are alternatives, counted instant by instant.
    parents : (I, c) int array
        The number of the alternative that each of them refines; -1 where there is none.
    """
    laid_out = levels_of(parents)
    is_offered = is_within & laid_out.is_narrow
    stands_for = is_offered.astype(np.int64)
    for level in reversed(laid_out.levels[1:]):
        stands_for[:, level.parents] += np.add.reduceat(
            stands_for[:, level.order], level.begins, axis=1
        )
    every = stands_for[:, laid_out.levels[0].cones].sum(axis=1)[:, None]
    above, instants = np.full(is_within.shape, -1), np.arange(len(is_within))[:, None]
    for depth, level in enumerate(laid_out.levels):
        if depth:
            outer = level.outer
            above[:, level.cones] = np.where(is_offered[:, outer], outer, above[:, outer])
        wide = level.wide
        if wide.size:
            outer, count = above[:, wide], stands_for[:, wide]
            # Where there is no wider one, the last is read in its place, and not used.
            of_outer = np.where(outer >= 0, stands_for[instants, outer], every)
            is_offered[:, wide] = is_within[:, wide] & (count > 1) & (count < of_outer)
    numbers = np.cumsum(is_offered.ravel()).reshape(is_offered.shape) - 1
    return is_offered, np.where(above >= 0, numbers[instants, above], -1)


def _entries(
    instants: Instants, instant: Indices, normals: Matrix
) -> tuple[Indices, Indices, Vector]:
    """Return rows, outputs and values of ``-normal · position`` at the instant of each row."""
    if not instant.size:
        nothing: Indices = np.zeros(0, dtype=np.int64)
        return nothing, nothing, np.zeros(0)
    windows, shares = instants.windows[instant], instants.shares[instant]
    rows, axes = np.arange(instant.size), np.arange(normals.shape[1])
    found: list[tuple[Indices, Indices, Tensor]] = []
    ends = ((windows, 1.0 - shares), (windows + 1, shares))
    for step, weight in ends[1:] if np.all(shares == 1.0) else ends:
        chosen = np.flatnonzero(weight > 0.0)
        where = np.repeat(rows[chosen], axes.size)
        outputs = step[chosen, None] * axes.size + axes
        values = weight[chosen, None] * normals[chosen]
        found += [
            (where, (part.position + outputs).ravel(), (-part.sign * values).ravel())
            for part in instants.parts
        ]
    found += [
        _sagitta_entries(part, windows, shares, normals, rows)
        for part in instants.parts
        if part.sagitta.any() and np.any(shares < 1.0)
    ]
    first, second, third = zip(*found, strict=True)
    return np.concatenate(first), np.concatenate(second), np.concatenate(third)


def _sagitta_entries(
    part: Part, windows: Indices, shares: Vector, normals: Matrix, rows: Indices
) -> tuple[Indices, Indices, Vector]:
    """Return the entries of what the mean's parabola deviates from its chord, by the controls."""
    chosen = np.flatnonzero(shares < 1.0)
    depth = 4.0 * shares[chosen] * (1.0 - shares[chosen])
    pull = part.sign * depth[:, None] * (normals[chosen] @ part.sagitta)
    m = pull.shape[1]
    plus = part.controls + windows[chosen, None] * m + np.arange(m)
    outputs = np.concatenate([plus, plus + part.control_bounds.size], axis=1)
    values = np.concatenate([pull, -pull], axis=1)
    return np.repeat(rows[chosen], 2 * m), outputs.ravel(), values.ravel()
