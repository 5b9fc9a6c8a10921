"""What RADMPC's subproblems are made from: every vehicle's dynamics, noise and control bounds."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.gaussian import Tail
from radmpc.model.scenario import Scenario
from radmpc.planners.paper.coupling import face_risk
from radmpc.planners.paper.temporal import TemporalObstacle
from radmpc.program.build import prediction_matrices
from radmpc.program.condensed import CondensedModel, PredictionMatrices, bent_covariances, condense
from radmpc.records import dataclass

__all__ = ["FleetModel"]


@dataclass(frozen=True, slots=True, eq=False)
class FleetModel:
    """The fleet over the whole horizon.

    Attributes
    ----------
    scenario : Scenario
        Its vehicles.
    prediction_matrices : tuple of PredictionMatrices
        How each vehicle's states answer to its controls.
    covariances : tuple of (T+1, n, n) array
        Covariance of each vehicle's state.
    bounds : tuple of (T, m) array
        Largest nominal controls of each.
    resets : bool
        Whether a subproblem sees noise as if its vehicle had just been measured.
    """

    scenario: Scenario
    prediction_matrices: tuple[PredictionMatrices, ...]
    covariances: tuple[Tensor, ...]
    bounds: tuple[Matrix, ...]
    resets: bool

    @classmethod
    def of(cls, scenario: Scenario, *, resets: bool) -> FleetModel:
        """Return the model of a scenario's fleet.

        Parameters
        ----------
        scenario : Scenario
            The scenario.
        resets : bool
            Whether a subproblem sees noise as if its vehicle had just been measured.
        """
        covariances = tuple(v.covariances(scenario.horizon) for v in scenario.vehicles)
        bounds = tuple(
            v.control_bounds(c) for v, c in zip(scenario.vehicles, covariances, strict=True)
        )
        return cls(scenario, prediction_matrices(scenario), covariances, bounds, resets)

    def noise(self, k: int, i: int) -> Tensor:
        """Return the covariances from step k on: of the final plan, or as if just measured.

        Parameters
        ----------
        k, i : int
            Step and vehicle.

        Returns
        -------
        (T+1−k, n, n) array
            Covariances of its state.
        """
        whole = self.covariances[i]
        return whole[: len(whole) - k] if self.resets else whole[k:]

    def model(self, k: int, i: int, mean: Vector) -> CondensedModel:
        """Return the condensed model of vehicle i from a mean state at step k on.

        Parameters
        ----------
        k, i : int
            Step and vehicle.
        mean : (n,) array
            Its mean state at that step.
        """
        vehicle = self.scenario.vehicles[i]
        noise, bounds = self.noise(k, i), self.bounds[i][k:]
        first_step = 0 if self.resets else k
        return condense(vehicle, self.prediction_matrices[i], mean, noise, bounds, first_step)

    def planned(self, k: int, i: int, mean: Vector, controls: Matrix) -> Matrix:
        """Return vehicle i's mean states from step k to the horizon, (T+1−k, n).

        Parameters
        ----------
        k, i : int
            Step and vehicle.
        mean : (n,) array
            Its mean state at that step.
        controls : (T, m) array
            Its controls over the whole horizon.
        """
        rest = controls[k:].ravel()
        prediction = self.prediction_matrices[i]
        steps = self.scenario.horizon - k
        pushes = self.scenario.vehicles[i].pushes(self.scenario.horizon)
        if pushes is not None and pushes.ndim > 1:
            pushes = pushes[k:]
        states = prediction.coasting(mean, pushes, steps)
        # A view whose rows overlap: copied, BLAS multiplies it.
        moved = np.ascontiguousarray(prediction.states[: steps + 1, :, : rest.size]) @ rest
        return np.asarray(states + moved)

    def window_risk(
        self,
        k: int,
        i: int,
        means: Matrix,
        controls: Matrix,
        obstacle: TemporalObstacle,
        window: int,
    ) -> float:
        """Return the risk of vehicle i with a temporal obstacle in one window after step k.

        Parameters
        ----------
        k, i, window : int
            Step, vehicle, and window from that step on.
        means : (T+1−k, n) array
            Its mean states from step k on.
        controls : (T, m) array
            Its controls over the whole horizon.
        obstacle : TemporalObstacle
            Of another vehicle.
        """
        vehicle = self.scenario.vehicles[i]
        axes = list(vehicle.system.position)
        noise = self.noise(k, i)
        ends = [(means[s][axes], noise[s][axes][:, axes]) for s in (window, window + 1)]
        tail = Tail(self.scenario.covariance_samples)
        if self.scenario.avoidance != "intervals":
            place = obstacle.at(k + window + 1)
            return face_risk(place, vehicle.radius, ends[1:], tail=tail)
        near = ends[:1]
        first_step = window if self.resets else k + window
        bent = bent_covariances(vehicle, noise[window : window + 2], first_step)
        if bent is not None:
            near.append((ends[0][0], bent[0]))
        sagitta = vehicle.system.sagitta @ controls[k + window]
        return face_risk(obstacle.at(k + window), vehicle.radius, near, ends[1], sagitta, tail)

    def place(self, i: int, mean: Vector) -> tuple[Vector, Vector | None]:
        """Return position and velocity of a state.

        Parameters
        ----------
        i : int
            The vehicle.
        mean : (n,) array
            Its state.

        Returns
        -------
        position : (d,) array
            [m].
        velocity : (d,) array or None
            [m/s]; None where the velocity is the control.
        """
        system = self.scenario.vehicles[i].system
        velocity = None if system.velocity is None else mean[list(system.velocity)]
        return mean[list(system.position)], velocity
