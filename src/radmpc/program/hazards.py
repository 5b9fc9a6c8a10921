"""What every vehicle of a fleet keeps clear of, laid out as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.scenario import Scenario
from radmpc.program.condensed import CondensedModel
from radmpc.program.keepout import KeepOut, obstacle_keepouts

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
    """

    vertices: Tensor
    faces: Tensor
    lower: Tensor
    upper: Tensor

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
        return cls(
            vertices,
            faces,
            np.minimum(*(end.min(axis=2) for end in ends)),
            np.maximum(*(end.max(axis=2) for end in ends)),
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
    moves : (N,) array
        How far each vehicle gets in a step, along an axis, at most [m].
    """

    models: tuple[CondensedModel, ...]
    radii: Vector
    covariances: Tensor
    variances: Matrix
    bent: Tensor | None
    intervals: bool
    shapes: Shapes
    workspace: tuple[Vector, Vector] | None
    moves: Vector

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
        bent = None
        if any(model.bent_covariances is not None for model in models):
            bent = np.array([_bent(model) for model in models])
        workspace = scenario.workspace
        reaches = [(model.reach_lower, model.reach_upper) for model in models]
        covariances = np.array([model.position_covariances for model in models])
        return cls(
            tuple(models),
            np.array([model.vehicle.radius for model in models]),
            covariances,
            np.maximum(np.trace(covariances[:, 1:], axis1=2, axis2=3), 0.0),
            bent,
            scenario.avoidance == "intervals",
            Shapes.of(scenario),
            None if workspace is None else (workspace.lower, workspace.upper),
            np.array([max(np.abs(np.diff(r, axis=0)).max() for r in both) for both in reaches]),
        )

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
