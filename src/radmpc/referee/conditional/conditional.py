r"""What is left of a certificate, given what has been measured.

For a *leg*, what is flown from some step on, and states measured at step t without error, the
deviation :math:`e_t = x_t - \bar x_t` is known and

.. math:: x_k \mid x_t \sim \mathcal N\Bigl(\bar x_k + F^{k-t} e_t,\
          \sum_{j=t}^{k-1} F^{k-1-j} W (F^{k-1-j})^\top\Bigr), \qquad F = A + B K .

The rows stay those that the certificate charged; under ``intervals`` the first row of each
encounter that speaks of what is still to be flown is charged whole, whatever the row before it came
to.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Tensor, Vector, as_array, as_vector
from radmpc.errors import ArgumentError, ScenarioError
from radmpc.referee.conditional.buying import unseen_of, witnesses_of
from radmpc.referee.conditional.far import is_surprised
from radmpc.referee.conditional.loops import loops_of, since
from radmpc.referee.conditional.rows import HalfspaceRows, IntegralRows, Witnesses
from radmpc.referee.conditional.valuing import Values, halfspace_values, integral_values

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
    witnesses: Witnesses, step: int, states: Sequence[npt.ArrayLike] | None
) -> Conditional:
    """Return the value of what is left of a leg.

    Parameters
    ----------
    witnesses : Witnesses
        Of the leg, by `witnesses_of`.
    step : int
        Of the leg, 0..T.
    states : sequence of (n,) array or None
        Measured states of all vehicles, in the scenario's order; None before anything is measured
        at step 0.

    Returns
    -------
    Conditional
        Valued by the rows that the leg's certificate charged. Under ``steps`` what may be hit at
        the step itself is left out, since it is known by then; before anything is measured it
        is not.

    Raises
    ------
    ArgumentError
        If there is no such step, or there are no states after step 0.
    ScenarioError
        If states do not fit the vehicles, or are not finite.
    """
    measured = None
    if states is not None:
        vehicles = witnesses.plan.scenario.vehicles
        if len(states) != len(vehicles):
            raise ScenarioError(f"must be {len(vehicles)} states, got {len(states)}", ("states",))
        measured = [
            as_vector(x, v.system.num_states, ("states", i))[None]
            for i, (x, v) in enumerate(zip(states, vehicles, strict=True))
        ]
    found = conditionals(witnesses, step, measured)
    return Conditional(
        step,
        float(found.total[0]),
        float(found.least[0]),
        float(found.next_step[0]),
        witnesses,
    )


def conditionals(
    witnesses: Witnesses, step: int, states: Sequence[npt.ArrayLike] | None
) -> Conditionals:
    """Return the values of what is left of a leg for many measurements at one step.

    Parameters
    ----------
    witnesses : Witnesses
        Of the leg.
    step : int
        Of the leg, 0..T.
    states : sequence of (S, n) array or None
        Measured states of each vehicle; None before anything is measured at step 0.

    Returns
    -------
    Conditionals
        One value per measurement.

    Raises
    ------
    ArgumentError
        If there is no such step, or there are no states after step 0.
    ScenarioError
        If states do not fit the vehicles, or are not finite.
    """
    motion, intervals = witnesses.motion, witnesses.intervals
    scenario, is_measured = witnesses.plan.scenario, states is not None
    loops = loops_of(motion)
    noise = since(loops, scenario.horizon, step, is_measured=is_measured)
    deviations = _deviations(witnesses, step, states, loops.transitions.shape[1])
    half = halfspace_values(witnesses.halfspaces, witnesses.parties, noise, deviations)
    exact = integral_values(witnesses.integrals, witnesses.parties, loops, noise, deviations)
    # At steps, what is measured tells what was hit there; an interval's near end tells what is not
    # yet to be hit.
    past = step if is_measured and not intervals else step - 1
    total, least, soon = _sums(witnesses, past, (half, exact))
    far = witnesses.far
    if is_measured and is_surprised(far, scenario, motion, (loops, noise), deviations):
        unseen = conditionals(unseen_of(witnesses), step, states)
        total, least = total + unseen.total, least + unseen.least
        soon = soon + unseen.next_step
    else:
        left = (scenario.horizon if intervals else scenario.horizon + 1) - past - 1
        total = total + far.charge(left, intervals=intervals, is_measured=is_measured)
        one = min(left, 1)
        soon = soon + far.charge(one, intervals=intervals, is_measured=is_measured)
    return Conditionals(total, least, soon, half, exact)


def _sums(
    witnesses: Witnesses, past: int, values: tuple[Values, Values]
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
    # What surely happens once need not be charged for more; as the certificate has it.
    cap = np.where(witnesses.parties.are_capped, 1.0, np.inf)[:, None]
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
        as_array(x, (None, path.shape[1]), ("states", i))
        for i, (x, path) in enumerate(zip(states, nominal, strict=True))
    ]
    if len({len(x) for x in given}) > 1:
        raise ArgumentError(f"states must be equally many each, got {[len(x) for x in given]}")
    result = np.zeros((len(given[0]), len(nominal), size))
    for i, (measured, path) in enumerate(zip(given, nominal, strict=True)):
        result[:, i, : path.shape[1]] = measured - path[step]
    return result
