"""The linear program of vehicles on their way from visit to visit, others where they are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.paths import Paths
from radmpc.planners.certified.turned.touring.motion import boxes_of, motion_rows, norm_rows
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.solvers.lp.keyed_lp import Exchanged, KeyedLp
from radmpc.solvers.lp.quiet_highs import BASIC, LOWER

__all__ = ["TourLp"]

_INF = float("inf")

_LITTLE = 1e-9
"""Share or length below which a row is left out [-, m]."""

_Rows = tuple[Indices, Indices, Vector]
"""Of each row its half-space, its end, and the multiple of the sagitta that is kept."""


class TourLp:
    """Least effort of some double integrators, kept warm whatever their visits and half-spaces are.

    Columns: per member ``u+``, ``u-``, the mean positions and what controls add to the mean
    velocities from step 1 on; last, how far half-spaces are missed. Rows: what each step adds to
    both, so that few entries are not 0, and faces of norms. Visits, goals and limits of the speed
    are bounds of columns.

    Parameters
    ----------
    hazards : Hazards
        The fleet; velocities are known.
    members : sequence of int
        The vehicles planned, ascending.
    """

    def __init__(self, hazards: Hazards, members: Sequence[int]) -> None:
        self._intervals = hazards.intervals
        models = [hazards.models[i] for i in members]
        self._models: list[CondensedModel | None] = [None] * len(models)
        self._slots = np.full(hazards.count, -1)
        self._slots[list(members)] = np.arange(len(models))
        self._spans = np.array([model.control_bounds.size for model in models])
        self._widths = np.array([model.control_bounds.shape[1] for model in models])
        # Systems may differ in their number of controls: zeros fill up.
        shape = len(models), hazards.horizon, int(self._widths.max())
        self._bounds = np.zeros(shape)
        self._sagittas = np.zeros((len(models), hazards.dimension, shape[2]))
        for slot, (model, width) in enumerate(zip(models, self._widths.tolist(), strict=True)):
            self._bounds[slot, :, :width] = np.maximum(model.control_bounds, 0.0)
            self._sagittas[slot, :, :width] = model.vehicle.system.sagitta
        self._lp = KeyedLp()
        added = [self._add_member(model) for model in models]
        self._controls = np.array([first for first, _, _ in added])
        # Without controls the motion is given, and nothing is cheaper: all it misses is visits.
        columns, rows = (np.concatenate([each[k] for each in added]) for k in (1, 2))
        self._lp.begin(columns, rows)

    def _add_member(self, model: CondensedModel) -> tuple[int, Indices, Indices]:
        """Add a vehicle's columns and hard rows; return its first column, and a basis of them."""
        span, places = model.control_bounds.size, model.drift_position[1:].size
        most = np.maximum(np.tile(model.control_bounds.ravel(), 2), 0.0)
        cost = np.full(2 * span, model.vehicle.cost_weight)
        first = self._lp.add_columns(cost, np.zeros(2 * span), most)
        free = np.full(2 * places, _INF)
        self._lp.add_columns(np.zeros(2 * places), -free, free)
        motion, right = motion_rows(model)
        self._lp.add_rows(motion, right, right, first)
        faces, upper = norm_rows(model)
        self._lp.add_rows(faces, np.full(upper.size, -_INF), upper, first)
        columns = np.repeat((LOWER, BASIC), (2 * span, 2 * places))
        return first, columns, np.repeat((LOWER, BASIC), (right.size, upper.size))

    def visit(self, models: Sequence[CondensedModel]) -> None:
        """Have members make their visits, and arrive, at other steps.

        Parameters
        ----------
        models : sequence of CondensedModel
            They, due at single steps.
        """
        for slot, model in enumerate(models):
            if model is not self._models[slot]:
                self._models[slot] = model
                first = int(self._controls[slot] + 2 * self._spans[slot])
                self._lp.bound_columns(first, *boxes_of(model))

    @property
    def work(self) -> float:
        """What its solves took, see `ExchangeLp`."""
        return self._lp.work

    def alone(self) -> list[Matrix] | None:
        """Return the controls of least effort with nothing in the way; None if there are none."""
        self._lp.drop()
        values = self._lp.solve()
        return None if values is None else self._controls_of(values)

    def solve(
        self, spaces: HalfSpaces, paths: Paths, clearance: float, penalty: float
    ) -> tuple[list[Matrix], float] | None:
        """Minimize effort between half-spaces, and what keeping less room than asked for costs.

        Parameters
        ----------
        spaces : HalfSpaces
            Turned to the latest paths of the members.
        paths : Paths
            Those paths, and everyone else's.
        clearance : float
            Standard deviations to keep [-].
        penalty : float
            Cost of missing a half-space by a meter.

        Returns
        -------
        list of (T, m) array and float, or None
            Controls of the members, and how far half-spaces are missed [m]; None where HiGHS found
            none, as where a member cannot reach its goal at all.
        """
        first = self._lp.num_stay
        rights = spaces.offsets + clearance * spaces.deviations
        self._lp.exchange(self._exchanged(spaces, paths, rights, penalty))
        values = self._lp.solve()
        if values is None:
            return None
        return self._controls_of(values), float(values[first:].sum())

    def _controls_of(self, values: Vector) -> list[Matrix]:
        """Return the members' controls from all columns."""
        found = []
        for begin, span, width in zip(self._controls, self._spans, self._widths, strict=True):
            both = values[begin : begin + 2 * span]
            found.append((both[:span] - both[span:]).reshape(-1, width))
        return found

    def _exchanged(
        self, spaces: HalfSpaces, paths: Paths, rights: Matrix, penalty: float
    ) -> Exchanged:
        """Return the rows of half-spaces, and columns of what is missed at each end."""
        rows = self._rows(spaces, paths)
        where, ends, reserves = rows
        lower = rights[where, ends]
        columns, values = self._members(spaces, paths, rows, lower)
        # What is missed at an end is the same for its chord and its curve.
        blocks, is_used = 2 * where + ends, np.zeros(2 * spaces.count, dtype=bool)
        is_used[blocks] = True
        missed = self._lp.num_stay + np.cumsum(is_used)[blocks] - 1
        entries = np.hstack([*values, np.ones((where.size, 1))])
        kept, used = entries != 0.0, np.flatnonzero(is_used)
        return Exchanged(
            cost=np.full(used.size, penalty),
            column_keys=2 * spaces.keys[used // 2] + used % 2,
            starts=np.append(0, np.cumsum(kept.sum(axis=1)))[:-1],
            columns=np.hstack([*columns, missed[:, None]])[kept],
            values=entries[kept],
            lower=lower,
            row_keys=4 * spaces.keys[where] + 2 * ends + (reserves > 0.0),
        )

    def _members(
        self, spaces: HalfSpaces, paths: Paths, rows: _Rows, lower: Vector
    ) -> tuple[list[Indices], list[Matrix]]:
        """Return columns and entries of members in rows; what all others do goes into bounds."""
        where, ends, reserves = rows
        windows, normals = spaces.windows[where], spaces.normals[where]
        columns, values = [], []
        for sign, everyone in ((1.0, spaces.first), (-1.0, spaces.second)):
            who = everyone[where]
            slots = np.where(who >= 0, self._slots[who], -1)
            still = np.flatnonzero((who >= 0) & (slots < 0))
            if still.size:
                at, when = who[still], windows[still]
                fixed = paths.means[at, when + ends[still]]
                fixed -= reserves[still, None] * paths.sagittas[at, when]
                lower[still] -= sign * np.einsum("wd,wd->w", normals[still], fixed)
            mine = slots >= 0
            if mine.any():
                turned = np.where(mine[:, None], sign * normals, 0.0)
                given = mine & (windows + ends == 0)
                lower[given] -= np.einsum("wd,wd->w", turned[given], paths.means[who[given], 0])
                moved = self._moved(slots, turned, (windows, ends, reserves))
                columns.append(moved[0])
                values.append(moved[1])
        return columns, values

    def _moved(self, slots: Indices, turned: Matrix, rows: _Rows) -> tuple[Indices, Matrix]:
        """Return columns and entries of members in rows by their windows, 0 where there is none."""
        windows, ends, reserves = rows
        d, at = turned.shape[1], windows + ends
        pulls = reserves[:, None] * np.einsum("wd,wdm->wm", turned, self._sagittas[slots])
        plus = (self._controls[slots] + windows * self._widths[slots])[:, None]
        plus = plus + np.arange(pulls.shape[1])
        spans = self._spans[slots]
        place = (self._controls[slots] + 2 * spans + d * (at - 1))[:, None] + np.arange(d)
        moving = turned * (at > 0)[:, None]
        return np.hstack([plus, plus + spans[:, None], place]), np.hstack([-pulls, pulls, moving])

    def _rows(self, spaces: HalfSpaces, paths: Paths) -> _Rows:
        """Choose the rows: at each end the chord, and where the curve comes closer, its reserve.

        With s the sagitta toward the half-space and θ its share, the curve keeps what the chord's
        start keeps less ``4θ²s`` and its end less ``4(1 - θ)²s``.
        """
        every = np.arange(spaces.count)
        if not self._intervals:
            return every, np.ones(spaces.count, dtype=np.int64), np.zeros(spaces.count)
        share, bends = spaces.shares, self._can_bend(spaces, paths)
        plain = every[spaces.windows > 0]  # the first position is given
        bent = [every[bends & (kept > _LITTLE)] for kept in (share, 1.0 - share)]
        where = np.concatenate([plain, bent[0], every, bent[1]])
        reserves = np.zeros(where.size)
        reserves[plain.size : plain.size + bent[0].size] = 4.0 * np.square(share[bent[0]])
        reserves[where.size - bent[1].size :] = 4.0 * np.square(1.0 - share[bent[1]])
        ends = np.repeat((0, 1), (plain.size + bent[0].size, every.size + bent[1].size))
        return where, ends, reserves

    def _can_bend(self, spaces: HalfSpaces, paths: Paths) -> np.ndarray:
        """Return whether any controls of the members bring the curve closer than its chord."""
        most = np.zeros(spaces.count)
        for sign, who in ((1.0, spaces.first), (-1.0, spaces.second)):
            slots = np.where(who >= 0, self._slots[who], -1)
            mine, still = np.flatnonzero(slots >= 0), np.flatnonzero((who >= 0) & (slots < 0))
            if mine.size:
                at = slots[mine]
                pulls = np.abs(np.einsum("wd,wdm->wm", spaces.normals[mine], self._sagittas[at]))
                most[mine] += (pulls * self._bounds[at, spaces.windows[mine]]).sum(axis=1)
            if still.size:
                hang = paths.sagittas[who[still], spaces.windows[still]]
                most[still] += sign * np.einsum("wd,wd->w", spaces.normals[still], hang)
        return np.asarray(most > _LITTLE)
