r"""What is left of a certificate, given what has been measured.

For a *leg*, what is flown from some step on, and states measured at step t without error under
noise that is new at every step, the deviation :math:`e_t = x_t - \bar x_t` is known and

.. math:: x_k \mid x_t \sim \mathcal N\Bigl(\bar x_k + F^{k-t} e_t,\
          \sum_{j=t}^{k-1} F^{k-1-j} W (F^{k-1-j})^\top\Bigr), \qquad F = A + B K .

The rows stay those that the certificate charged; under ``intervals`` the first row of each
encounter that speaks of what is still to be flown is charged whole, whatever the row before it came
to.

With a disturbance that lasts, or a filter, the same holds of the longer state ζ of the closed loop:
given all that was measured it is Gaussian about what is expected of it, with a covariance
:math:`S_t` that is known beforehand, and :math:`F^{k-t} S_t (F^{k-t})^\top` comes on top. Of
obstacles nothing is measured, so their places keep the covariances they had. Where this leaves open
whether anything was hit, every row stays charged without the one before it, also the first one:
what has been spent on the steps that were flown, and what is left, are then a martingale by
themselves.

Of covariances that are known up to a factor measurements tell more: rows fail with the tails of
`radmpc.referee.conditional.scales`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Tensor, Vector, as_array, as_vector
from radmpc.errors import ArgumentError, ScenarioError
from radmpc.records import dataclass
from radmpc.referee.conditional.buying import unseen_of, witnesses_of
from radmpc.referee.conditional.far import closer_of, is_surprised
from radmpc.referee.conditional.loops import since, together
from radmpc.referee.conditional.rows import HalfspaceRows, IntegralRows, Witnesses
from radmpc.referee.conditional.scales import Scale
from radmpc.referee.conditional.valuing import Values, halfspace_values, integral_values
from radmpc.referee.motion import FleetMotion
from radmpc.referee.tails import cutoff_of

__all__ = ["Conditional", "Conditionals", "conditional", "conditionals", "witnesses_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Conditional:
    """The value of what is left of a leg.

    Attributes
    ----------
    step : int
        At which states were measured, counted from the leg's own first.
    total : float
        Upper bound on the probability that what is left collides, given what was measured and that
        nothing has been hit [-]; the value of the rows, rounded up.
    least : float
        The same, rounded down: not above the conditional probability of the rows [-].
    next_step : float
        Share of `total` that is run until the next step [-].
    witnesses : Witnesses
        The rows it was valued by.
    """

    step: int
    total: float
    least: float
    next_step: float
    witnesses: Witnesses


@dataclass(frozen=True, slots=True, eq=False)
class Conditionals:
    """Values for many measurements at one step; see `Conditional`.

    Attributes
    ----------
    total, least, next_step : (S,) array
        As there.
    halfspaces, integrals : Values
        Values of single rows, (E, S) each.
    """

    total: Vector
    least: Vector
    next_step: Vector
    halfspaces: Values
    integrals: Values


def conditional(
    witnesses: Witnesses,
    step: int,
    states: Sequence[npt.ArrayLike] | None,
    scale: Scale | None = None,
) -> Conditional:
    """Return the value of what is left of a leg.

    Parameters
    ----------
    witnesses : Witnesses
        Of the leg, by `witnesses_of`.
    step : int
        Of the leg, 0..T.
    states : sequence of (n,) or (2 n + s,) or (3 (2 n + s),) array or None
        What is known of all vehicles, in the scenario's order: measured states; of those whose
        disturbances last or who measure with noise the expected state and the expected
        disturbances over the step that follows, their own and shared ones that last; of those who
        measure with noise and share, that by its own filter, by the leg's, and by all that was
        measured. None before anything is measured at step 0.
    scale : Scale or None
        What all that was measured tells of the factor up to which the leg's covariances are known;
        None where they are known, or before anything is measured.

    Returns
    -------
    Conditional
        Valued by the rows that the leg's certificate charged. Under ``steps`` what may be hit at
        the step itself is left out, since it is known by then; before anything is measured it
        is not.

    Raises
    ------
    ArgumentError
        If there is no such step, there are no states after step 0, or the scale is missing.
    ScenarioError
        If states do not fit the vehicles, or are not finite.
    """
    measured = None
    if states is not None:
        sizes = _sizes(witnesses)
        if len(states) != len(sizes):
            raise ScenarioError(f"must be {len(sizes)} states, got {len(states)}", ("states",))
        measured = [
            as_vector(x, size, ("states", i))[None]
            for i, (x, size) in enumerate(zip(states, sizes, strict=True))
        ]
    found = conditionals(witnesses, step, measured, scale)
    return Conditional(
        step,
        float(found.total[0]),
        float(found.least[0]),
        float(found.next_step[0]),
        witnesses,
    )


def conditionals(
    witnesses: Witnesses,
    step: int,
    states: Sequence[npt.ArrayLike] | None,
    scale: Scale | None = None,
) -> Conditionals:
    """Return the values of what is left of a leg for many measurements at one step.

    Parameters
    ----------
    witnesses : Witnesses
        Of the leg.
    step : int
        Of the leg, 0..T.
    states : sequence of (S, n), (S, 2 n + s) or (S, 3 (2 n + s)) array or None
        What is known of each vehicle, as in `conditional`; None before anything is measured at
        step 0.
    scale : Scale or None
        As there; its factor may differ from measurement to measurement.

    Returns
    -------
    Conditionals
        One value per measurement.

    Raises
    ------
    ArgumentError
        If there is no such step, there are no states after step 0, or the scale is missing.
    ScenarioError
        If states do not fit the vehicles, or are not finite.
    """
    motion, intervals = witnesses.motion, witnesses.intervals
    scenario, is_measured = witnesses.plan.scenario, states is not None
    parties, loops = witnesses.parties, witnesses.loops
    law = _law(motion, scale, is_measured=is_measured)
    noise = since(loops, scenario.horizon, step, is_measured=is_measured)
    noise = together(noise, loops, parties.first, parties.others)
    deviations = _deviations(witnesses, step, states, loops.initial.shape[1])
    half = halfspace_values(witnesses.halfspaces, parties, noise, deviations, law)
    exact = integral_values(witnesses.integrals, parties, loops, noise, deviations)
    # At steps, what is measured tells what was hit there; an interval's near end tells what is not
    # yet to be hit.
    past = step if is_measured and not intervals else step - 1
    total, least, soon = _sums(witnesses, past, (half, exact), is_measured=is_measured)
    far = witnesses.far
    if is_measured and is_surprised(far, scenario, motion, (loops, noise, law), deviations):
        unseen = conditionals(unseen_of(witnesses), step, states, scale)
        total, least = total + unseen.total, least + unseen.least
        soon = soon + unseen.next_step
    else:
        left = (scenario.horizon if intervals else scenario.horizon + 1) - past - 1
        each = closer_of(law.samples)[1] if is_measured else cutoff_of(law.samples)[1]
        total = total + far.charge(left, each, intervals=intervals)
        soon = soon + far.charge(min(left, 1), each, intervals=intervals)
    # Summed in another order the least may come out above by rounding.
    return Conditionals(total, np.minimum(least, total), soon, half, exact)


def _law(motion: FleetMotion, scale: Scale | None, *, is_measured: bool) -> Scale:
    """Return the degrees of freedom of tails, and the factor of covariances."""
    if scale is None and is_measured and motion.samples is not None:
        raise ArgumentError(
            "scale must tell what was measured of covariances known up to a factor, got None"
        )
    return Scale(motion.samples) if scale is None or not is_measured else scale


def _sums(
    witnesses: Witnesses, past: int, values: tuple[Values, Values], *, is_measured: bool
) -> tuple[Vector, Vector, Vector]:
    """Return what rows after a window come to from above and below, and those of the next one."""
    rows: tuple[HalfspaceRows | IntegralRows, ...] = witnesses.halfspaces, witnesses.integrals
    shape = (len(witnesses.parties.causes), values[0].above.shape[1])
    above, below, soon = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    for table, found in zip(rows, values, strict=True):
        left = np.flatnonzero(table.windows > past)
        np.add.at(above, table.encounters[left], found.above[left])
        np.add.at(below, table.encounters[left], found.below[left])
        following = left[table.windows[left] == past + 1]
        np.add.at(soon, table.encounters[following], found.above[following])
    # What surely happens once need not be charged for more; as the certificate has it. Under way
    # that takes knowing what happened: else what was spent, and what is left, are a sum.
    capped = witnesses.parties.are_capped
    if is_measured:
        capped = capped & ~witnesses.parties.are_hidden
    cap = np.where(capped, 1.0, np.inf)[:, None]
    scale = np.minimum(cap / np.maximum(above, 1e-300), 1.0)
    sums = (above * scale, np.minimum(below, cap), soon * scale)
    total, least, next_step = (each.sum(axis=0) for each in sums)
    return total, least, next_step


def _deviations(
    witnesses: Witnesses, step: int, states: Sequence[npt.ArrayLike] | None, size: int
) -> Tensor:
    """Return measured deviations from the nominal, (S, N, n); zeros before anything is measured."""
    nominal = witnesses.motion.states
    if states is None:
        return np.zeros((1, len(nominal), size))
    if len(states) != len(nominal):
        raise ScenarioError(f"must be {len(nominal)} states, got {len(states)}", ("states",))
    given: list[Matrix] = [
        as_array(x, (None, length), ("states", i))
        for i, (x, length) in enumerate(zip(states, _sizes(witnesses), strict=True))
    ]
    if len({len(x) for x in given}) > 1:
        raise ArgumentError(f"states must be equally many each, got {[len(x) for x in given]}")
    result = np.zeros((len(given[0]), len(nominal), size))
    motion = witnesses.motion
    for i, (measured, path) in enumerate(zip(given, nominal, strict=True)):
        n, seen = path.shape[1], motion.seen_rows[i]
        lasting = motion.lasting[i]
        result[:, i, :n] = measured[:, :n] - path[step]
        if measured.shape[1] == n:
            continue
        begins = n if witnesses.plan.scenario.vehicles[i].disturbance_correlation > 0.0 else 2 * n
        expected = 0.0 if lasting is None else lasting[step][begins - n :]
        shares = seen and bool(witnesses.plan.scenario.vehicles[i].shared)
        size = measured.shape[1] // (3 if shares else 1)
        # Its own filter's, that of the leg, and what all know: the last is what there is.
        acted, best = measured[:, size : 2 * size], measured[:, -size:]
        for row, told in ((0, best), (seen, acted if shares else best)):
            result[:, i, row : row + n] = told[:, :n] - path[step]
            rest = told[:, begins:] - expected
            result[:, i, row + n : row + n + rest.shape[1]] = rest
    return result


def _sizes(witnesses: Witnesses) -> list[int]:
    """Return how many numbers tell what is known of each vehicle."""
    sizes = []
    for vehicle in witnesses.plan.scenario.vehicles:
        shared = [part.size for part in vehicle.shared if part.correlation > 0.0]
        lasts = vehicle.disturbance_correlation > 0.0 or vehicle.measurement is not None or shared
        copies = 3 if vehicle.shared and vehicle.measurement is not None else 1
        sizes.append(copies * (vehicle.start.size * (2 if lasts else 1) + sum(shared)))
    return sizes
