"""The linear program of one vehicle that keeps clearances, in compiled code.

First plans solve it for every vehicle, sweep after sweep. Of hundreds of half-spaces few hold
a vehicle: those that its latest path is near to become rows, over its controls alone, and the dual
simplex method goes on as others enter.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.planners.certified.turned.linear.bending import can_bend
from radmpc.planners.certified.turned.linear.given import Layout, Places
from radmpc.planners.certified.turned.linear.group_plan import GroupPlan
from radmpc.planners.certified.turned.linear.margins import Margins
from radmpc.planners.certified.turned.linear.parts import Rows, rows_of
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.least_effort import alone_in_space
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.lp.quiet_highs import FEASIBILITY_TOL

__all__ = ["plan_alone"]

_NEAR = 0.1
"""Room beyond what is asked for up to which a half-space is a row from the first [standard
deviations]: with 0 and 0.5 programs of a map of 32 x 32 cells take as long."""

_MOST_ENTERING = 48
"""Rows that enter at once, those that miss most [-]: programs of a map of 32 x 32 cells have 290
rows in the end, 150 of them hard; 390, after a quarter more time, if all that miss any enter."""


@dataclass(frozen=True, slots=True, eq=False)
class _Asked:
    """What half-spaces ask of a vehicle, r rows ``turned @ (position - reserve * sagitta)``.

    Attributes
    ----------
    rows : Rows
        Which half-space and end each belongs to.
    turned : (r, d) array
        Normals, toward where the vehicle is to be.
    windows, steps : (r,) int array
        In which window, and at which step.
    lower : (r,) array
        What each comes to at least [m].
    """

    rows: Rows
    turned: Matrix
    windows: Indices
    steps: Indices
    lower: Vector

    def missing(self, path: Matrix, sagittas: Matrix) -> Vector:
        """Return what each lacks on a path, (T+1, d) and (T, d) [m]; negative where it has more."""
        at = path[self.steps] - self.rows.reserves[:, None] * sagittas[self.windows]
        return np.asarray(self.lower - np.einsum("rd,rd->r", self.turned, at))


def plan_alone(
    hazards: Layout, vehicle: int, spaces: HalfSpaces, paths: Places, margins: Margins
) -> GroupPlan | None:
    """Minimize a vehicle's effort between half-spaces, and what it misses of them at a price.

    Parameters
    ----------
    hazards : Layout
        The fleet.
    vehicle : int
        Its number.
    spaces : HalfSpaces
        Turned to its latest path.
    paths : Places
        That path, and everyone else's.
    margins : Margins
        The same clearance everywhere, see `fixed_margins`.

    Returns
    -------
    GroupPlan or None
        None where the vehicle cannot reach its goal at all.
    """
    model = hazards.models[vehicle]
    asked = _asked(hazards, vehicle, spaces, paths, margins)
    room = _NEAR * spaces.deviations[asked.rows.spaces, asked.rows.ends]
    missing = asked.missing(paths.means[vehicle], paths.sagittas[vehicle]) + room
    program = _Program(model, asked, margins.penalty)
    while True:
        program.enter(missing)
        if program.lp.solve()[0] is not LpOutcome.OPTIMAL:
            return None
        controls = program.controls()
        sagittas = controls @ model.vehicle.system.sagitta.T
        missing = asked.missing(model.path(controls), sagittas)
        missing[program.is_in] = 0.0
        if not (missing > FEASIBILITY_TOL).any():
            return GroupPlan((controls,), program.missed(), 0.0)


def _asked(
    hazards: Layout, vehicle: int, spaces: HalfSpaces, paths: Places, margins: Margins
) -> _Asked:
    """Return what half-spaces ask of the vehicle, all others where they are."""
    slots = np.full(hazards.count, -1)
    slots[vehicle] = 0
    models = [hazards.models[vehicle]]
    rows = rows_of(spaces, can_bend(models, slots, spaces, paths) if hazards.intervals else None)
    normals, windows = spaces.normals[rows.spaces], spaces.windows[rows.spaces]
    steps = windows + rows.ends
    lower = (spaces.offsets + margins.distances)[rows.spaces, rows.ends]
    signs = np.zeros(rows.count)
    for sign, everyone in ((1.0, spaces.first[rows.spaces]), (-1.0, spaces.second[rows.spaces])):
        signs[everyone == vehicle] = sign
        still = np.flatnonzero((everyone >= 0) & (everyone != vehicle))
        hang = paths.sagittas[everyone[still], windows[still]]
        at = paths.means[everyone[still], steps[still]] - rows.reserves[still, None] * hang
        lower[still] -= sign * np.einsum("rd,rd->r", normals[still], at)
    return _Asked(rows, signs[:, None] * normals, windows, steps, lower)


class _Program:
    """A vehicle's controls, and the half-spaces that are rows so far; it lives for one plan.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    asked : _Asked
        What may become a row.
    penalty : float
        Cost of a meter that an end of a half-space misses.
    """

    def __init__(self, model: CondensedModel, asked: _Asked, penalty: float) -> None:
        self._model, self._asked, self._penalty = model, asked, penalty
        # All rows of one end miss the same.
        self._ends = 2 * asked.rows.spaces + asked.rows.ends
        self.is_in = np.zeros(asked.rows.count, dtype=np.bool_)
        self.lp = alone_in_space(model)
        self._span = model.control_bounds.size
        far = np.maximum(np.abs(model.reach_lower), np.abs(model.reach_upper)).sum(axis=1).max()
        # More than any end can miss: the method wants bounds.
        self._most = 4.0 * float(far + np.abs(asked.lower).max(initial=1.0))

    def enter(self, missing: Vector) -> None:
        """Make rows of the half-spaces that miss most, (r,) array [m], all of an end together."""
        chosen = missing > FEASIBILITY_TOL
        if np.count_nonzero(chosen) > _MOST_ENTERING:
            chosen &= missing >= np.partition(missing, -_MOST_ENTERING)[-_MOST_ENTERING]
        is_chosen = np.zeros(self._ends.max(initial=0) + 1, dtype=np.bool_)
        is_chosen[self._ends[chosen]] = True
        entering = is_chosen[self._ends]
        self.is_in |= entering
        some = np.flatnonzero(entering)
        # By ends, so that what each misses stands in rows one after the other.
        some = some[np.argsort(self._ends[some], kind="stable")]
        if some.size:
            first = self._add(some)
            begins = np.flatnonzero(np.diff(self._ends[some], prepend=-1))
            numbers = np.arange(first, first + some.size, dtype=np.int32)
            for rows in np.split(numbers, begins[1:]):
                self.lp.add_column(self._penalty, self._most, rows, np.ones(rows.size))

    def _add(self, some: Indices) -> int:
        """Add rows over the controls; return the number of the first."""
        asked, model = self._asked, self._model
        turned, steps = asked.turned[some], asked.steps[some]
        pulls = np.zeros((some.size, self._span))
        for axis, parts in enumerate(turned.T):
            pulls += parts[:, None] * model.position[steps, axis]
        pull = asked.rows.reserves[some, None] * (turned @ model.vehicle.system.sagitta)
        width = pull.shape[1]
        columns = (asked.windows[some] * width)[:, None] + np.arange(width)
        pulls[np.arange(some.size)[:, None], columns] -= pull
        lower = asked.lower[some] - np.einsum("rd,rd->r", turned, model.drift_position[steps])
        every = np.tile(np.arange(2 * self._span, dtype=np.int32), (some.size, 1))
        return self.lp.add_dense_rows(every, np.hstack([pulls, -pulls]), lower)

    def controls(self) -> Matrix:
        """Return the controls of the last solve, (T, m)."""
        point = self.lp.point()
        plus, minus = point[: self._span], point[self._span : 2 * self._span]
        return (plus - minus).reshape(self._model.control_bounds.shape)

    def missed(self) -> float:
        """Return what ends miss in all [m]."""
        return float(self.lp.point()[2 * self._span :].sum())
