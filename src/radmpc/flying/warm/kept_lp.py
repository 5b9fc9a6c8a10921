"""The linear program of a group, built once for a mission and moved along with it.

What position k owes to the control of step j depends on k - j alone. So the program of the steps
that are left is the one of all steps, with controls of the past at 0: bounds alone change from tick
to tick, and the last basis is a start.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.turned.linear.given import Places
from radmpc.planners.certified.turned.linear.group_lp import NEVER, GroupLp
from radmpc.planners.certified.turned.linear.group_plan import GroupPlan
from radmpc.planners.certified.turned.linear.margins import Margins
from radmpc.planners.certified.turned.linear.member import Member
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.program.limits.norms import norm_rows
from radmpc.solvers.solution import Limits
from radmpc.sparse_rows import sparse_block

__all__ = ["KeptLp"]

_INF = float("inf")


class KeptLp(GroupLp):
    """Least effort of a group over the steps that are left, from where its vehicles are.

    Parameters
    ----------
    hazards : Hazards
        The fleet over all steps.
    members : sequence of int
        The vehicles planned, ascending.
    miss_price : float or None
        Effort that ending beside a goal costs per meter and axis [1/m]; None is not allowed.

    Attributes
    ----------
    has_failed : bool
        Whether the last solve found nothing.
    """

    keeps_basis = False

    def __init__(
        self, hazards: Hazards, members: Sequence[int], miss_price: float | None = None
    ) -> None:
        self.has_failed = False
        self._miss_price = miss_price
        self._steps = hazards.horizon
        super().__init__(hazards, members)
        self._rows_kept = self._lp.num_rows
        self._first_controls, self._first_positions = self._controls, self._positions
        spans = [
            np.arange(first, first + 2 * span)
            for first, span in zip(self._controls, self._spans, strict=True)
        ]
        self._columns_kept = np.concatenate(spans)

    def _member(self, model: CondensedModel) -> Member:
        """Return a vehicle's columns and rows of all steps, without bounds yet."""
        span, positions = model.control_bounds.size, model.position[1:]
        count = positions.shape[0] * positions.shape[1]
        # What the goal is missed by along either direction of each axis, where that is allowed.
        dimension = model.vehicle.system.dimension
        size = 0 if self._miss_price is None else 2 * dimension
        rows = [model.position[-1]]
        if model.velocity is not None:
            rows.append(model.velocity[1:].reshape(-1, span))
        rows += [faces for faces, _ in norm_rows(model)]
        hard = np.vstack(rows)
        # The goal's rows are the first ones.
        beside = np.hstack([np.eye(len(hard), dimension), -np.eye(len(hard), dimension)])[:, :size]
        prediction = positions.reshape(count, span)
        matrix = np.vstack(
            [
                np.hstack([hard, -hard, np.zeros((len(hard), count)), beside]),
                np.hstack([-prediction, prediction, np.eye(count), np.zeros((count, size))]),
            ]
        )
        effort = np.full(2 * span, model.vehicle.cost_weight)
        open_, free = np.full(count, _INF), np.full(len(matrix), _INF)
        return Member(
            cost=np.concatenate([effort, np.zeros(count), np.full(size, self._miss_price or 0.0)]),
            lower=np.concatenate([np.zeros(2 * span), -open_, np.zeros(size)]),
            upper=np.concatenate([np.zeros(2 * span), open_, np.full(size, _INF)]),
            rows=sparse_block(matrix),
            row_lower=-free,
            row_upper=free,
        )

    def move(self, hazards: Hazards) -> None:
        """Begin where the vehicles are now.

        Parameters
        ----------
        hazards : Hazards
            The fleet over the steps that are left.
        """
        passed = self._steps - hazards.horizon
        self._hazards = hazards
        self._models = [hazards.models[i] for i in self.members]
        self._controls = self._first_controls + passed * self._widths
        self._positions = self._first_positions + passed * hazards.dimension
        self._lp.drop()
        limits, lower, upper = [], [], []
        for model in self._models:
            bounds = np.zeros((self._steps, model.control_bounds.shape[1]))
            bounds[passed:] = np.maximum(model.control_bounds, 0.0)
            limits += [bounds.ravel()] * 2
            low, high = _bounds(model, passed)
            lower.append(low)
            upper.append(high)
        self._lp.change_uppers(self._columns_kept, np.concatenate(limits))
        # Rows that stay are its members', one after another.
        numbers = np.arange(self._rows_kept)
        self._lp.change_rows(numbers, np.concatenate(lower), np.concatenate(upper))

    def solve(
        self, spaces: HalfSpaces, paths: Places, margins: Margins, limits: Limits = NEVER
    ) -> GroupPlan | None:
        """Solve as `GroupLp` does; take note of whether there was anything.

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
        """
        plan = super().solve(spaces, paths, margins, limits)
        self.has_failed = plan is None
        return plan

    def _controls_of(self, values: Vector) -> tuple[Matrix, ...]:
        """Return the members' controls of the steps that are left from all columns."""
        found = []
        for slot, model in enumerate(self._models):
            first, span = int(self._controls[slot]), int(self._spans[slot])
            size = model.control_bounds.size
            plus, minus = values[first : first + size], values[first + span : first + span + size]
            found.append((plus - minus).reshape(model.control_bounds.shape))
        return tuple(found)


def _bounds(model: CondensedModel, passed: int) -> tuple[Vector, Vector]:
    """Return the bounds of a member's rows: goal, speeds from step 1 on, norms, what moves it."""
    vehicle, last = model.vehicle, model.horizon
    lower = [vehicle.goal.lower - model.drift_position[last]]
    upper = [vehicle.goal.upper - model.drift_position[last]]
    d = vehicle.system.dimension
    if model.drift_velocity is not None:
        limits = np.full((passed + last, d), _INF)
        if vehicle.speed_limit is not None:
            limits[passed:] = vehicle.speed_limit
        if vehicle.goal.speed is not None:
            limits[-1] = np.minimum(limits[-1], vehicle.goal.speed)
        idle = np.zeros((passed + last, d))
        idle[passed:] = model.drift_velocity[1:]
        lower.append((-limits - idle).ravel())
        upper.append((limits - idle).ravel())
    for _, most in norm_rows(model):
        upper.append(np.vstack([np.full((passed, most.shape[1]), _INF), most]).ravel())
        lower.append(np.full(upper[-1].size, -_INF))
    gone = np.repeat(model.drift_position[:1], passed, axis=0)
    moved = np.concatenate([gone, model.drift_position[1:]]).ravel()
    return np.concatenate([*lower, moved]), np.concatenate([*upper, moved])
