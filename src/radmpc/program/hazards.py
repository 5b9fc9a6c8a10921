"""What every vehicle of a fleet keeps clear of, laid out as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.gaussian import GAUSSIAN, Tail
from radmpc.model.noise.positions import PositionResponse, side_by_side, without_common
from radmpc.model.relations.concerns import concerned
from radmpc.model.scenario import Scenario
from radmpc.program.condensed import CondensedModel
from radmpc.program.keepout import KeepOut, obstacle_keepouts
from radmpc.program.relative import are_isotropic
from radmpc.records import dataclass, replace

__all__ = ["Hazards", "Shapes"]


@dataclass(frozen=True, slots=True, eq=False)
class Shapes:
    """The convex pieces of all obstacles; O of them.

    Attributes
    ----------
    vertices : (O, T+1, v, d) array
        Corners at every step, the last repeated where a piece has fewer [m].
    faces : (O, T, f, d) array
        Outward normals at every window; zeros where a piece has fewer.
    lower, upper : (O, T, d) array
        Boxes around the pieces during each window [m].
    covariances : (O, T+1, d, d) array or None
        How far the pieces are from there [m²]; None where all are known exactly.
    variances : (O, T) array
        No less than the largest of it along any direction, from step 1 on: the trace [m²].
    """

    vertices: Tensor
    faces: Tensor
    lower: Tensor
    upper: Tensor
    covariances: Tensor | None
    variances: Matrix

    @classmethod
    def of(cls, scenario: Scenario) -> Shapes:
        """Lay out the obstacles of a scenario."""
        horizon, d = scenario.horizon, scenario.dimension
        intervals = scenario.avoidance == "intervals"
        keepouts = [
            keepout
            for obstacle in scenario.obstacles
            for keepout in obstacle_keepouts(obstacle, 0, horizon, intervals=intervals)
        ]
        corners = max((len(s.vertices) for k in keepouts for s in k.shapes), default=1)
        most = max((k.normals.shape[1] for k in keepouts), default=1)
        vertices = np.empty((len(keepouts), horizon + 1, corners, d))
        faces = np.zeros((len(keepouts), horizon, most, d))
        for number, keepout in enumerate(keepouts):
            vertices[number] = _corners(keepout, horizon, corners)
            faces[number, :, : keepout.normals.shape[1]] = keepout.normals
        first = 0 if intervals else 1
        ends = (vertices[:, first : horizon + first], vertices[:, 1:])
        covariances = None
        variances = np.zeros((len(keepouts), horizon))
        if any(keepout.spread is not None for keepout in keepouts):
            covariances = np.zeros((len(keepouts), horizon + 1, d, d))
            for number, keepout in enumerate(keepouts):
                if keepout.spread is not None:
                    covariances[number] = keepout.spread.positions
            variances = np.maximum(np.trace(covariances[:, 1:], axis1=2, axis2=3), 0.0)
        return cls(
            vertices,
            faces,
            np.minimum(*(end.min(axis=2) for end in ends)),
            np.maximum(*(end.max(axis=2) for end in ends)),
            covariances,
            variances,
        )

    @property
    def count(self) -> int:
        """Number of pieces."""
        return len(self.vertices)


@dataclass(frozen=True, slots=True, eq=False)
class Hazards:
    """A fleet of N vehicles and what they keep clear of; T steps, d dimensions.

    Attributes
    ----------
    models : tuple of CondensedModel
        The vehicles.
    radii : (N,) array
        Their radii [m].
    covariances : (N, T+1, d, d) array
        Of their positions [m²].
    variances : (N, T) array
        No less than the largest along any direction, from step 1 on: their traces [m²].
    bent : (N, T, d, d) array or None
        What feedback held over a step makes of them [m²]; None where no path bends by it.
    intervals : bool
        Whether collisions count between steps.
    shapes : Shapes
        The obstacles.
    workspace : tuple of (d,) array or None
        Lower and upper bounds of where centers may be [m].
    reaches : (N,) array
        How far each vehicle gets in a step, along an axis, at most [m].
    common, common_bent : (N, T+1, d, E) and (N, T, d, E) array, or None
        What normals behind shared disturbances make of positions, and what feedback held over a
        step makes of that [m]; None where nothing is shared.
    tail : Tail
        Of what everything deviates by.
    ranges : tuple of (int, int, float)
        Who stays within a range of whom [m].
    concerned : (N, O) bool array or None
        Which pieces concern whom; None where all concern everybody.
    is_isotropic : bool
        Whether everything deviates alike in all directions.
    """

    models: tuple[CondensedModel, ...]
    radii: Vector
    covariances: Tensor
    variances: Matrix
    bent: Tensor | None
    intervals: bool
    shapes: Shapes
    workspace: tuple[Vector, Vector] | None
    reaches: Vector
    common: Tensor | None = None
    common_bent: Tensor | None = None
    tail: Tail = GAUSSIAN
    ranges: tuple[tuple[int, int, float], ...] = ()
    concerned: npt.NDArray[np.bool_] | None = None
    is_isotropic: bool = False

    @classmethod
    def of(cls, scenario: Scenario, models: Sequence[CondensedModel]) -> Hazards:
        """Lay out a scenario.

        Parameters
        ----------
        scenario : Scenario
            The fleet.
        models : sequence of CondensedModel
            Its vehicles over the whole horizon.
        """
        is_bent = any(model.bent_covariances is not None for model in models)
        workspace = scenario.workspace
        reaches = [(model.reach_lower, model.reach_upper) for model in models]
        covariances = np.array([model.position_covariances for model in models])
        variances = np.maximum(np.trace(covariances[:, 1:], axis1=2, axis2=3), 0.0)
        shared = [] if not scenario.has_shared else [m.common for m in models]
        shapes = Shapes.of(scenario)
        return cls(
            tuple(models),
            np.array([model.vehicle.radius for model in models]),
            covariances,
            # Of a pair at most (σ_1 + σ_2)² ≤ 2 σ_1² + 2 σ_2², however it is correlated.
            2.0 * variances if shared else variances,
            np.array([_bent(model) for model in models]) if is_bent else None,
            scenario.avoidance == "intervals",
            shapes,
            None if workspace is None else (workspace.lower, workspace.upper),
            np.array([max(np.abs(np.diff(r, axis=0)).max() for r in both) for both in reaches]),
            _responses(shared, "positions"),
            _responses(shared, "bent"),
            Tail(scenario.covariance_samples),
            _ranges(scenario) if scenario.keep else (),
            _concerned(scenario),
            not shared and all(are_isotropic(c) for c in (covariances, shapes.covariances)),
        )

    def joint(self, steps: Indices, first: Indices, second: Indices | None) -> Tensor:
        """Return the covariances of (relative) positions at some steps, (w, d, d) [m²].

        Parameters
        ----------
        steps : (w,) int array
            The steps.
        first, second : (w,) int array, or None
            Vehicles; None is no second one.
        """
        return _joint(self.covariances, self.common, steps, (first, second))

    def joint_bent(self, steps: Indices, first: Indices, second: Indices | None) -> Tensor | None:
        """Return the same for what feedback makes of them, None where no path bends.

        Parameters
        ----------
        steps, first, second
            As in `joint`.
        """
        if self.bent is None:
            return None
        return _joint(self.bent, self.common_bent, steps, (first, second))

    def visiting(self, controls: Sequence[Matrix]) -> Hazards:
        """Return the fleet with visits and arrivals at the steps of given controls.

        Parameters
        ----------
        controls : sequence of (T, m) array
            Nominal controls of every vehicle.

        Returns
        -------
        Hazards
            The fleet itself where there is nothing to choose.
        """
        if not any(model.vehicle.via or model.time_cost for model in self.models):
            return self
        from radmpc.program.visits.steps import at_steps_of  # noqa: PLC0415 - few visit anything

        pairs = zip(self.models, controls, strict=True)
        return replace(self, models=tuple(at_steps_of(model, each) for model, each in pairs))

    @property
    def count(self) -> int:
        """Number of vehicles N."""
        return len(self.models)

    @property
    def horizon(self) -> int:
        """Number of steps T."""
        return self.models[0].horizon

    @property
    def dimension(self) -> int:
        """Number of coordinates d."""
        return int(self.covariances.shape[-1])


def _concerned(scenario: Scenario) -> npt.NDArray[np.bool_] | None:
    """Return which pieces concern whom, in the order of `Shapes`."""
    found = concerned(scenario.obstacles, [vehicle.name for vehicle in scenario.vehicles])
    if found is None:
        return None
    return np.repeat(found, [len(obstacle.at(0)) for obstacle in scenario.obstacles], axis=1)


def _ranges(scenario: Scenario) -> tuple[tuple[int, int, float], ...]:
    """Return who stays within a range of whom."""
    from radmpc.model.relations.keep import keep_pairs  # noqa: PLC0415 - few keep a range

    return keep_pairs(scenario.keep, [vehicle.name for vehicle in scenario.vehicles])


def _corners(keepout: KeepOut, horizon: int, count: int) -> Tensor:
    """Return a piece's corners at every step, the last repeated up to a count, (T+1, v, d)."""
    shapes = keepout.shapes
    steps = [
        np.concatenate([s.vertices, np.repeat(s.vertices[-1:], count - len(s.vertices), axis=0)])
        for s in shapes
    ]
    return np.array(steps if len(steps) > 1 else steps * (horizon + 1))


def _bent(model: CondensedModel) -> Tensor:
    """Return what feedback makes of a vehicle's covariances, its own where nothing."""
    bent = model.bent_covariances
    return model.position_covariances[:-1] if bent is None else bent


def _joint(
    covariances: Tensor,
    common: Tensor | None,
    steps: Indices,
    who: tuple[Indices, Indices | None],
) -> Tensor:
    """Return the covariances of one vehicle, or of one relative to another, (w, d, d)."""
    first, second = who
    mine: Tensor = covariances[first, steps]
    if second is None:
        return mine
    total = mine + covariances[second, steps]
    if common is None:
        return total
    return without_common(total, common[first, steps], common[second, steps])


def _responses(
    shared: Sequence[PositionResponse | None], kind: Literal["positions", "bent"]
) -> Tensor | None:
    """Return what shared disturbances make of everybody, zeros where nothing, (N, …, E)."""
    found = side_by_side(
        [None if one is None else one.columns for one in shared],
        [None if one is None else getattr(one, kind) for one in shared],
    )
    shapes = [one for one in found if one is not None]
    if not shapes:
        return None
    return np.array([np.zeros_like(shapes[0]) if one is None else one for one in found])
