"""The linear program of a group of vehicles between given half-spaces, others where they are."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.planners.certified.turned.linear.bending import can_bend
from radmpc.planners.certified.turned.linear.given import Layout, Places
from radmpc.planners.certified.turned.linear.group_plan import GroupPlan
from radmpc.planners.certified.turned.linear.kept_basis import Bounds, KeptBasis
from radmpc.planners.certified.turned.linear.margins import Margins
from radmpc.planners.certified.turned.linear.member import Member, member_of
from radmpc.planners.certified.turned.linear.parts import (
    Entered,
    Rows,
    are_few,
    near_first,
    rows_of,
)
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.program.condensed import CondensedModel
from radmpc.solvers.lp.exchange_lp import ExchangeLp
from radmpc.solvers.lp.quiet_highs import FEASIBILITY_TOL
from radmpc.solvers.solution import Limits
from radmpc.sparse_rows import diagonal_rows, rows_of_entries

__all__ = ["NEVER", "UNASKED", "GroupLp"]

_INF = float("inf")

NEVER = Limits()
"""Nothing is given up."""

UNASKED = 1e-7
"""Share of the value of a program that the risk at a half-space may be worth that is left out of it
[-]: of `paper(8)` those beyond five standard deviations."""


class GroupLp:
    """Least effort of some vehicles to their goals; half-spaces are exchanged at every solve.

    Columns: per member ``u+``, then ``u-``, then the mean positions from step 1 on; last, how far
    each half-space is missed.

    Parameters
    ----------
    hazards : Layout
        The fleet.
    members : sequence of int
        The vehicles planned, ascending.
    """

    keeps_basis = True
    """Whether a solve begins where the last one ended."""

    def __init__(self, hazards: Layout, members: Sequence[int]) -> None:
        self._hazards = hazards
        self.members = tuple(members)
        self._models = [hazards.models[i] for i in members]
        self._slots = np.full(hazards.count, -1)
        self._slots[list(members)] = np.arange(len(self.members))
        # Systems may differ in their number of controls: zeros fill up.
        most = max(model.control_bounds.shape[1] for model in self._models)
        self._sagittas = np.zeros((len(self._models), hazards.dimension, most))
        for slot, model in enumerate(self._models):
            sagitta = model.vehicle.system.sagitta
            self._sagittas[slot, :, : sagitta.shape[1]] = sagitta
        # At steps nothing is asked for where windows begin.
        self._num_ends = 2 if hazards.intervals else 1
        self._lp = ExchangeLp()
        self._controls = self._add_members()
        self._stay = self._lp.num_columns, self._lp.num_rows
        self._bounds: tuple[Bounds, Bounds] | None = None
        self._kept: KeptBasis | None = None
        self._spans = np.array([model.control_bounds.size for model in self._models])
        self._positions = self._controls + 2 * self._spans
        self._widths = np.array([model.control_bounds.shape[1] for model in self._models])

    def _add_members(self) -> Indices:
        """Add the vehicles' columns and hard rows; return the first column of each."""
        members = [self._member(model) for model in self._models]
        widths = [one.rows.width for one in members]
        self._lp.add_columns(*_joined((one.cost, one.lower, one.upper) for one in members))
        least, most = _joined((one.row_lower, one.row_upper) for one in members)
        self._lp.add_rows(diagonal_rows([one.rows for one in members]), least, most)
        return np.cumsum([0, *widths[:-1]])

    def _member(self, model: CondensedModel) -> Member:
        """Return what a vehicle contributes."""
        return member_of(model)

    @property
    def work(self) -> float:
        """What its solves took, see `ExchangeLp`."""
        return self._lp.work

    def alone(self) -> tuple[Matrix, ...] | None:
        """Return the controls of least effort with nothing in the way; None if there are none."""
        self._lp.drop()
        values = self._lp.solve()
        return None if values is None else self._controls_of(values)

    def solve(
        self, spaces: HalfSpaces, paths: Places, margins: Margins, limits: Limits = NEVER
    ) -> GroupPlan | None:
        """Minimize effort between half-spaces, and what keeping less room than asked for costs.

        Parameters
        ----------
        spaces : HalfSpaces
            Turned to the latest paths of this group.
        paths : Places
            Those paths, and everyone else's.
        margins : Margins
            What the half-spaces ask for.
        limits : Limits
            When to give up.

        Returns
        -------
        GroupPlan or None
            None where HiGHS found none, as where a vehicle cannot reach its goal at all.

        Notes
        -----
        Of many half-spaces, those near the latest paths are in the program first; others enter
        until it is the solution of all, but for risk that is worth next to nothing.
        """
        self._lp.drop()
        is_in = np.zeros(spaces.count, dtype=bool)
        added, parts = near_first(spaces, margins), list[Entered]()
        while True:
            entering = (spaces, margins) if added.all() else (spaces.of(added), margins.of(added))
            parts.append(self._add(*entering, paths))
            if self._kept is not None and len(parts) == 1 and margins.num_columns > 1:
                self._lp.begin_with(*self._kept.in_program(parts[0].offered(self._num_ends)))
            values = self._lp.solve(limits.seconds_left)
            if values is None:
                return None
            is_in |= added
            added = ~is_in & self._missed(spaces, paths, margins, values)
            if not added.any():
                break
        if self.keeps_basis and margins.num_columns > 1:
            self._keep(parts, values)
        given_up = [one.margins.given_up(values[one.first :], self._num_ends) for one in parts]
        missed, risk = np.sum(given_up, axis=0).tolist()
        return GroupPlan(self._controls_of(values), missed, risk)

    def _keep(self, parts: Sequence[Entered], values: Vector) -> None:
        """Keep where this solve ended."""
        columns, rows = self._lp.basic()
        (num_columns, num_rows), active, basic = self._stay, [], []
        if self._bounds is None:
            # Of what stays, which is never changed.
            self._bounds = self._lp.bounds(num_columns, num_rows)
        first_row = num_rows
        for part in parts:
            offered = part.offered(self._num_ends)
            active.append(offered.row_keys[~rows[first_row : first_row + part.rows.count]])
            first_row += part.rows.count
            shape = (*offered.end_keys.shape, part.margins.num_columns)
            given_up = columns[part.first : part.first + math.prod(shape)].reshape(shape)
            basic.append(offered.end_keys[given_up.any(axis=2)])
        self._kept = KeptBasis.of(
            (columns[:num_columns], rows[:num_rows]),
            (values[:num_columns], self._lp.activities()[:num_rows]),
            self._bounds,
            (np.concatenate(active), np.concatenate(basic)),
        )

    def _add(self, spaces: HalfSpaces, margins: Margins, paths: Places) -> Entered:
        """Add half-spaces to the program, with what may be given up of them."""
        lengths = np.full((spaces.count, 2, margins.num_columns), _INF)
        lengths[:, :, :-1] = margins.lengths
        prices = np.full(lengths.shape, margins.penalty)
        prices[:, :, :-1] = margins.prices
        used = slice(2 - self._num_ends, 2)
        first = self._lp.extend_columns(prices[:, used].ravel(), lengths[:, used].ravel())
        rights = spaces.offsets + margins.distances
        rows = self._rows(spaces, paths)
        self._lp.extend_rows(*self._entries(spaces, paths, rights, (rows, first)))
        return Entered(spaces, margins, rows, first)

    def _missed(
        self, spaces: HalfSpaces, paths: Places, margins: Margins, values: Vector
    ) -> npt.NDArray[np.bool_]:
        """Return which half-spaces a solution leaves less room than they ask for, (w,) array."""
        if are_few(spaces, margins):
            return np.zeros(spaces.count, dtype=bool)
        rows = self._rows(spaces, paths)
        rights = spaces.offsets + margins.distances
        matrix, lower = self._entries(spaces, paths, rights, (rows, self._lp.num_columns))
        missing = lower - matrix @ values
        is_missed = missing > FEASIBILITY_TOL
        if margins.num_columns > 1:
            some = np.flatnonzero(is_missed)
            costs = margins.costs(rows.spaces[some], rows.ends[some], missing[some])
            is_missed[some] = costs > UNASKED * abs(self._lp.objective)
        return np.bincount(rows.spaces, is_missed, spaces.count) > 0

    def _controls_of(self, values: Vector) -> tuple[Matrix, ...]:
        """Return the members' controls from all columns."""
        found = []
        for first, model in zip(self._controls.tolist(), self._models, strict=True):
            span = model.control_bounds.size
            plus, minus = values[first : first + span], values[first + span : first + 2 * span]
            found.append((plus - minus).reshape(model.control_bounds.shape))
        return tuple(found)

    def _rows(self, spaces: HalfSpaces, paths: Places) -> Rows:
        """Choose the rows of half-spaces."""
        if not self._hazards.intervals:
            return rows_of(spaces, None)
        return rows_of(spaces, can_bend(self._models, self._slots, spaces, paths))

    def _entries(
        self, spaces: HalfSpaces, paths: Places, rights: Matrix, laid_out: tuple[Rows, int]
    ) -> tuple[csr_array, Vector]:
        """Return rows over all columns, and their lower bounds."""
        rows, first = laid_out
        chosen, ends = rows.spaces, rows.ends
        normals, windows = spaces.normals[chosen], spaces.windows[chosen]
        lower = rights[chosen, ends].copy()
        per_end = (self._lp.num_columns - first) // max(self._num_ends * spaces.count, 1)
        block = self._num_ends * chosen + ends - (2 - self._num_ends)
        given_up = first + block[:, None] * per_end + np.arange(per_end)
        where, columns = [np.repeat(np.arange(rows.count), per_end)], [given_up.ravel()]
        values = [np.ones(given_up.size)]
        # Of the point that keeps clear: its own end of the window, the other if it is in between.
        parts = (rows.weights, windows + ends), (1.0 - rows.weights, windows + 1 - ends)
        for sign, everyone in ((1.0, spaces.first[chosen]), (-1.0, spaces.second[chosen])):
            slots = np.where(everyone >= 0, self._slots[everyone], -1)
            mine = np.flatnonzero(slots >= 0)
            still = np.flatnonzero((everyone >= 0) & (slots < 0))
            if still.size:
                who = everyone[still]
                at = sum(w[still, None] * paths.means[who, steps[still]] for w, steps in parts)
                fixed = at - rows.reserves[still, None] * paths.sagittas[who, windows[still]]
                lower[still] -= sign * np.einsum("wd,wd->w", normals[still], fixed)
            if not mine.size:
                continue
            for weights, steps in parts:
                some = mine[weights[mine] > 0.0]
                pulls = sign * weights[some, None] * normals[some]
                given = np.flatnonzero(steps[some] == 0)
                starts = paths.means[everyone[some[given]], 0]
                lower[some[given]] -= np.einsum("wd,wd->w", pulls[given], starts)
                pulls[given] = 0.0
                where.append(np.repeat(some, pulls.shape[1]))
                columns.append(self._columns_of(slots[some], steps[some], pulls.shape[1]).ravel())
                values.append(pulls.ravel())
            slots = slots[mine]
            for at, column, pull in self._bends(rows, normals, windows, (sign, mine, slots)):
                where.append(at)
                columns.append(column)
                values.append(pull)
        shape = (rows.count, self._lp.num_columns)
        entries = np.concatenate(where), np.concatenate(columns), np.concatenate(values)
        return rows_of_entries(*entries, shape), lower

    def _columns_of(self, slots: Indices, steps: Indices, dimension: int) -> Indices:
        """Return the columns of members' positions at steps, (r, d); those of step 1 for step 0."""
        first = self._positions[slots] + dimension * np.maximum(steps - 1, 0)
        return np.asarray(first[:, None] + np.arange(dimension))

    def _bends(
        self, rows: Rows, normals: Matrix, windows: Indices, member: tuple[float, Indices, Indices]
    ) -> Iterator[tuple[Indices, Indices, Vector]]:
        """Yield rows, columns and values of what controls bend paths by where reserves are kept.

        Members are given by their sign in half-spaces, the rows that they are in, and their slots.
        """
        sign, mine, slots = member
        if not rows.reserves.any():
            return
        pulls = np.einsum("wd,wdm->wm", normals[mine], self._sagittas[slots])
        pulls *= sign * rows.reserves[mine, None]
        axes = np.arange(pulls.shape[1])
        plus = (self._controls[slots] + windows[mine] * self._widths[slots])[:, None] + axes
        for half, turn in ((0, -1.0), (1, 1.0)):
            columns = plus + half * self._spans[slots][:, None]
            yield np.repeat(mine, axes.size), columns.ravel(), (turn * pulls).ravel()


def _joined(parts: Iterable[tuple[Vector, ...]]) -> Iterator[Vector]:
    """Return the arrays of all members one after the other, kind by kind."""
    return map(np.concatenate, zip(*parts, strict=True))
