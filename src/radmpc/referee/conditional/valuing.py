"""The conditional value of rows: of many measurements at once, the same noise still to come."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.referee.bound.bivariate import exceeds_alone
from radmpc.referee.bound.bounds import site_risks
from radmpc.referee.bound.mixture import exceeds_alone_mixed
from radmpc.referee.bound.search import NEGLIGIBLE
from radmpc.referee.common import relative
from radmpc.referee.conditional.loops import Loops, Since
from radmpc.referee.conditional.rows import Flags, HalfspaceRows, IntegralRows, Parties
from radmpc.referee.conditional.scales import Scale
from radmpc.referee.conditional.spreads import (
    correlations,
    deviations_before,
    deviations_of,
)
from radmpc.referee.reserve import in_deviations
from radmpc.referee.sites import Sites
from radmpc.referee.tails import exceeding

__all__ = ["Values", "are_sharp", "halfspace_values", "integral_values"]

_LOOSEST = 1.017
"""Largest ratio of what a row charged without the one before it is charged to its probability [-]:
see `radmpc.referee.bound.bivariate`."""

_NOTHING = 1e-15
"""Probability of a half-space below which it is charged as it is, and nothing from below [-]."""

_INTEGRAL_EXCESS = 1e-4
"""Largest share of an integral that is added for its error [-]: 6e-5 was measured at worst."""

_STUDENT_ROUNDING = 1e-12
"""Relative error of a tail that falls slowly [-]: 3e-14 was measured at worst."""

_FLATTEST = 1e-12
"""Ratio of variances below which noise in the plane counts as singular [-]: what is charged then
may be a half-space, which says nothing from below."""


@dataclass(frozen=True, slots=True, eq=False)
class Values:
    """Values of E rows for S measurements.

    Attributes
    ----------
    above : (E, S) array
        Not below their conditional probabilities [-].
    below : (E, S) array
        Not above them, up to rounding [-].
    """

    above: Matrix
    below: Matrix


def halfspace_values(
    rows: HalfspaceRows, parties: Parties, noise: Since, deviations: Tensor, scale: Scale
) -> Values:
    """Return the values of half-spaces; rows of windows before the measurement are 0.

    Parameters
    ----------
    rows : HalfspaceRows
        E of them.
    parties : Parties
        The encounters.
    noise : Since
        Of the steps since the measurement.
    deviations : (S, N, n) array
        Measured deviations from the nominal.
    scale : Scale
        Degrees of freedom of tails, and the factor of covariances.
    """
    spread = deviations_of(rows, parties, noise)
    shift = np.zeros((len(rows.windows), len(deviations)))
    coming = rows.windows >= noise.step
    steps = np.where(coming, rows.windows - noise.step, 0)
    first, other = parties.first[rows.encounters], parties.other[rows.encounters]
    are_pairs = parties.are_pairs[rows.encounters]
    # What is known of every vehicle at every step, (steps, N, n, S): rows pick from it.
    onward = np.einsum("knij,snj->knis", noise.powers, deviations)
    for on_state, vehicles, sign in ((rows.first, first, 1.0), (rows.other, other, -1.0)):
        at = np.flatnonzero(coming if sign > 0.0 else coming & are_pairs)
        for axis in range(on_state.shape[1]):
            reached = onward[steps[at], vehicles[at], axis]
            shift[at] += sign * on_state[at, axis, None] * reached
    larger = np.sqrt(scale.factor)
    levels = in_deviations(rows.margins[:, None] + shift, spread[:, None]) / larger
    above = np.where(coming[:, None], exceeding(levels, scale.samples), 0.0)
    below = above.copy()
    # The row before counts as long as it is not of the past: what it failed with then hit nothing.
    # Where a contact is unknown, the charge of that step covers it.
    ends = coming & (rows.before >= 0) & ~coming[rows.before] & parties.are_hidden[rows.encounters]
    linked = np.flatnonzero(coming & (rows.before >= 0) & (coming[rows.before] | ends))
    if linked.size:
        levels_before, spread_before = levels[rows.before], spread[rows.before]
        if ends.any():
            found = _ended(rows, parties, noise, deviations)
            levels_before[ends], spread_before[ends] = found[0][ends] / larger, found[1][ends]
        rho = correlations(rows, parties, noise, spread, spread_before)
        row, sample = np.nonzero(above[linked] > _NOTHING)
        below[linked] = 0.0
        row = linked[row]
        limits = levels_before[row, sample], levels[row, sample]
        found = _alone(limits, rho[row], rows.nested[row], scale.samples)
        above[row, sample], below[row, sample] = found
    return Values(above, below)


def _alone(
    limits: tuple[Vector, Vector], correlation: Vector, nested: Flags, samples: int | None
) -> tuple[Vector, Vector]:
    """Return bounds on the probability of rows without those before, (E,) each."""
    if samples is None:
        alone = exceeds_alone(*limits, correlation)
        return alone, alone / np.where(nested, 1.0, _LOOSEST)
    above, below = exceeds_alone_mixed(*limits, correlation, samples)
    below /= _LOOSEST
    # Of nested events the difference is exact, but for what cancels: the rounding of both.
    before, own = (exceeding(each[nested], samples) for each in limits)
    rounding = _STUDENT_ROUNDING * own
    above[nested] = (own - before).clip(min=0.0) + rounding
    below[nested] = (own - before - rounding).clip(min=0.0)
    return above, below


def _ended(
    rows: HalfspaceRows, parties: Parties, noise: Since, deviations: Tensor
) -> tuple[Matrix, Vector]:
    """Return levels (E, S) and deviations (E,) of rows before that end at the measurement."""
    first, other = parties.first[rows.encounters], parties.other[rows.encounters]
    spread = deviations_before(rows, parties, noise)
    shift = np.einsum("en,sen->es", rows.link_first, deviations[:, first])
    theirs = np.where(parties.are_pairs[rows.encounters, None], rows.link_other, 0.0)
    shift -= np.einsum("en,sen->es", theirs, deviations[:, other * (theirs.any(axis=1))])
    return in_deviations(rows.margins[rows.before][:, None] + shift, spread[:, None]), spread


def integral_values(
    rows: IntegralRows, parties: Parties, loops: Loops, noise: Since, deviations: Tensor
) -> Values:
    """Return the values of integrals, at steps after the measurement; those before are 0.

    Parameters
    ----------
    rows : IntegralRows
        E of them.
    parties : Parties
        The encounters.
    loops : Loops
        Of the fleet.
    noise : Since
        Of the steps since the measurement.
    deviations : (S, N, n) array
        Measured deviations from the nominal.
    """
    count, num = len(rows.windows), len(deviations)
    above, below = np.zeros((count, num)), np.zeros((count, num))
    coming = np.flatnonzero(rows.windows >= noise.step)
    if not coming.size:
        return Values(above, below)
    if num == 1 and not noise.step and not deviations.any() and not loops.has_spread(noise):
        # Nothing is known that was not when they were bought.
        below = np.where(rows.are_sharp, rows.charged * (1.0 - _INTEGRAL_EXCESS), 0.0)
        return Values(rows.charged[:, None], below[:, None])
    means, covariances = _moments(rows, parties, loops, noise, deviations)
    flat = np.repeat(np.arange(coming.size), num)
    sites = Sites(
        means[coming].reshape(-1, 1, 2),
        covariances[coming][flat][:, None],
        (True,),
        np.zeros((flat.size, 2)),
        rows.radii[coming][flat],
        rows.vertices[coming][flat][:, None],
        np.zeros((flat.size, 1)),
        np.zeros((flat.size, 1, 0, 2, 2)),
    )
    found, certain = _integrated(sites, rows.directions[coming][flat])
    above[coming] = found.reshape(-1, num)
    below[coming] = np.where(certain, found * (1.0 - _INTEGRAL_EXCESS), 0.0).reshape(-1, num)
    return Values(above, below)


def _moments(
    rows: IntegralRows, parties: Parties, loops: Loops, noise: Since, deviations: Tensor
) -> tuple[Tensor, Tensor]:
    """Return conditional means (E, S, 2) and covariances (E, 2, 2) of relative positions."""
    steps = np.maximum(rows.windows - noise.step, 0)
    first, other = parties.first[rows.encounters], parties.other[rows.encounters]
    are_pairs = parties.are_pairs[rows.encounters]
    means = np.repeat(rows.means[:, None], len(deviations), axis=1)
    covariances = rows.strays.copy()
    for vehicles, sign, at in (
        (first, 1.0, np.arange(len(first))),
        (other, -1.0, np.flatnonzero(are_pairs)),
    ):
        who, when = vehicles[at], steps[at]
        onward = loops.picks[who] @ noise.powers[when, who]
        means[at] += sign * np.einsum("edn,sen->esd", onward, deviations[:, who])
        covariances[at] += (
            loops.picks[who] @ noise.covariances[when, who] @ loops.picks[who].transpose(0, 2, 1)
        )
    if noise.crossed is not None:
        pairs = np.flatnonzero(are_pairs)
        crossed = noise.crossed[steps[pairs], rows.encounters[pairs]]
        picked = loops.picks[first[pairs]] @ crossed
        picked = picked @ loops.picks[other[pairs]].transpose(0, 2, 1)
        covariances[pairs] = relative(covariances[pairs], picked)
    return means, covariances


def _integrated(sites: Sites, directions: Tensor) -> tuple[Vector, Flags]:
    """Return the probability of each set, and where it is that and no bound alone.

    Without noise the best half-space is both: it tells whether the mean is in the set.
    """
    found, risks = site_risks(sites, directions)
    return found, are_sharp(sites.covariances[:, 0], risks)


def are_sharp(covariances: Tensor, risks: Vector) -> Flags:
    """Return which integrals are probabilities, and no bounds alone, (E,) bool.

    Parameters
    ----------
    covariances : (E, 2, 2) array
        Of the positions [m²].
    risks : (E,) array
        What they came to [-].
    """
    values = np.linalg.eigvalsh(covariances)
    is_regular = values[:, 0] > _FLATTEST * values[:, 1]
    return np.asarray((is_regular & (risks > NEGLIGIBLE)) | (values[:, 1] <= 0.0))
