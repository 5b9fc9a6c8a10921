"""The steps that are left of a mission as planners see them, cut from those of all steps.

From a measured state noise begins anew: over the steps that are left covariances, reserves for
feedback and prediction matrices are the first of those over all steps.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.flying.knowing import expected_start, known_after
from radmpc.flying.remainder import changed
from radmpc.gaussian import Tail
from radmpc.geometry import inner_faces
from radmpc.model.goal import Goal
from radmpc.model.noise.belief import Belief
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.program.build import condensed_models, prediction_matrices
from radmpc.program.condensed import CondensedModel, PredictionMatrices
from radmpc.program.hazards import Hazards, Shapes
from radmpc.records import dataclass, replace
from radmpc.referee.conditional.scales import Scale

__all__ = ["Ahead"]


@dataclass(frozen=True, slots=True, eq=False)
class Ahead:
    """What planners need of a mission, over all of its steps.

    Attributes
    ----------
    whole : Hazards
        The fleet from states known at step 0.
    predictions : tuple of PredictionMatrices
        Of every vehicle.
    """

    whole: Hazards
    predictions: tuple[PredictionMatrices, ...]

    @classmethod
    def of(cls, scenario: Scenario) -> Ahead:
        """Lay out a mission.

        Parameters
        ----------
        scenario : Scenario
            Of all its steps.
        """
        means = [0.0 * expected_start(v) for v in scenario.vehicles]
        known = known_after(scenario, scenario.horizon, means)
        begun = tuple(_begun(v, one) for v, one in zip(scenario.vehicles, known, strict=True))
        scenario = replace(scenario, vehicles=begun)
        return cls(Hazards.of(scenario, condensed_models(scenario)), prediction_matrices(scenario))

    def left(
        self,
        passed: int,
        vehicles: Sequence[Vehicle],
        goals: Sequence[Goal],
        scale: Scale | None = None,
    ) -> Hazards:
        """Return the fleet over the steps that are left.

        Parameters
        ----------
        passed : int
            Steps that have been flown.
        vehicles : sequence of Vehicle
            As they begin them.
        goals : sequence of Goal
            Where they are to end.
        scale : Scale or None
            What is known by now of the factor of covariances; None where they are known.
        """
        whole = self.whole
        last = whole.horizon - passed
        models = tuple(
            _cut(model, prediction, (last, vehicle, goal))
            for model, prediction, vehicle, goal in zip(
                whole.models, self.predictions, vehicles, goals, strict=True
            )
        )
        shapes = whole.shapes
        left = replace(
            whole,
            models=models,
            covariances=whole.covariances[:, : last + 1],
            variances=whole.variances[:, :last],
            bent=None if whole.bent is None else whole.bent[:, :last],
            shapes=Shapes(
                shapes.vertices[:, passed:],
                shapes.faces[:, passed:],
                shapes.lower[:, passed:],
                shapes.upper[:, passed:],
                None if shapes.covariances is None else shapes.covariances[:, passed:],
                shapes.variances[:, passed:],
            ),
        )
        return left if scale is None or scale.samples is None else _scaled(left, scale)


def _scaled(hazards: Hazards, scale: Scale) -> Hazards:
    """Return the fleet with what is known by now of its covariances."""
    times = float(scale.factor)
    root, shapes = np.sqrt(times), hazards.shapes
    return replace(
        hazards,
        models=tuple(_scaled_model(model, times) for model in hazards.models),
        covariances=times * hazards.covariances,
        variances=times * hazards.variances,
        bent=None if hazards.bent is None else times * hazards.bent,
        common=None if hazards.common is None else root * hazards.common,
        common_bent=None if hazards.common_bent is None else root * hazards.common_bent,
        shapes=replace(
            shapes,
            covariances=None if shapes.covariances is None else times * shapes.covariances,
            variances=times * shapes.variances,
        ),
        tail=Tail(scale.samples),
    )


def _scaled_model(model: CondensedModel, times: float) -> CondensedModel:
    """Return a vehicle whose feedback is left as much room as it may need by now."""
    limit, bent, faces = model.vehicle.control_limit, model.bent_covariances, model.face_bounds
    if faces is not None:
        _, share = inner_faces(model.control_bounds.shape[1])
        most = share * (model.vehicle.control_norm or 0.0)
        faces = most - np.sqrt(times) * (most - faces)
    return replace(
        model,
        control_bounds=limit - np.sqrt(times) * (limit - model.control_bounds),
        face_bounds=faces,
        position_covariances=times * model.position_covariances,
        bent_covariances=None if bent is None else times * bent,
    )


def _begun(vehicle: Vehicle, known: Belief | None) -> Vehicle:
    """Return a vehicle of which all is known that is under way.

    A filter knows about as much at every step as at the last one.
    """
    if known is None:
        return replace(vehicle, initial_covariance=0.0 * vehicle.initial_covariance)
    n = vehicle.start.size
    return replace(vehicle, initial_covariance=known.covariance[:n, :n], belief=known)


def _cut(
    model: CondensedModel, prediction: PredictionMatrices, left: tuple[int, Vehicle, Goal]
) -> CondensedModel:
    """Return a vehicle over the steps it begins; its reachable box is that of all steps."""
    last, begun, goal = left
    vehicle = model.vehicle
    span = last * model.control_bounds.shape[1]
    coasting = prediction.coasting(begun.start, begun.pushes(last), last)
    velocity, axes = model.velocity, vehicle.system.velocity
    return changed(
        model,
        vehicle=vehicle if goal is vehicle.goal else changed(vehicle, goal=goal),
        horizon=last,
        control_bounds=model.control_bounds[:last],
        face_bounds=None if model.face_bounds is None else model.face_bounds[:last],
        position_covariances=model.position_covariances[: last + 1],
        bent_covariances=None if model.bent_covariances is None else model.bent_covariances[:last],
        position=model.position[: last + 1, :, :span],
        velocity=None if velocity is None else velocity[: last + 1, :, :span],
        drift_position=coasting[:, list(vehicle.system.position)],
        drift_velocity=None if axes is None else coasting[:, list(axes)],
        reach_lower=model.reach_lower[: last + 1],
        reach_upper=model.reach_upper[: last + 1],
    )
