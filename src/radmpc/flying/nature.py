"""What a model draws beside new noise on every state: what lasts, what is shared, what strays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.flying.knowing import expected_start, moved
from radmpc.model.noise.filtering import Learning, learning_of
from radmpc.model.obstacle import TrackShape
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass, field

__all__ = ["Estimator", "Nature", "root_of"]


def root_of(covariance: Matrix) -> Matrix:
    """Return a factor ``L Lᵀ`` of a covariance that may be singular.

    Parameters
    ----------
    covariance : (n, n) array
        The covariance.
    """
    diagonal = np.diag(covariance)
    if np.array_equal(covariance, np.diag(diagonal)):
        return np.diag(np.sqrt(diagonal.clip(min=0.0)))
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(values.clip(min=0.0)))


@dataclass(slots=True, eq=False)
class Estimator:
    """The Kalman filter of a vehicle that measures its state with noise.

    Attributes
    ----------
    vehicle : Vehicle
        The vehicle.
    learning : Learning
        Its gains.
    step : int
        The next one at which something is measured.
    estimate : (2 n + s,) array
        What is expected then: of the state, and of the disturbances over the step that follows.
    """

    vehicle: Vehicle
    learning: Learning
    step: int = 0
    estimate: Vector = field(default_factory=lambda: np.zeros(0))

    @classmethod
    def of(cls, vehicle: Vehicle, horizon: int) -> Estimator:
        """Return the filter of a vehicle, before anything is measured.

        Parameters
        ----------
        vehicle : Vehicle
            With a measurement.
        horizon : int
            Number of steps T.
        """
        learning = learning_of(vehicle.system, vehicle.noise, horizon)
        return cls(vehicle, learning, 0, expected_start(vehicle)[: len(learning.gains[0])])

    def measured(self, measurement: Vector) -> Vector:
        """Return the estimate of the state after a measurement, (n,).

        Parameters
        ----------
        measurement : (p,) array
            What is measured.
        """
        sensor, n = self.vehicle.measurement, self.vehicle.start.size
        if sensor is not None:
            surprise = measurement - sensor.matrix @ self.estimate[:n]
            self.estimate = self.estimate + self.learning.gains[self.step] @ surprise
        return self.estimate[:n]

    def flown(self, control: Vector) -> None:
        """Expect what a control leads to.

        Parameters
        ----------
        control : (m,) array
            What was flown over the step.
        """
        self.estimate, self.step = moved(self.vehicle, self.estimate, control), self.step + 1


class Nature:
    """Draws lasting and shared disturbances, tracks of obstacles and errors of sensors.

    Parameters
    ----------
    scenario : Scenario
        What is flown.
    rng : Generator
        Source of the noise.
    """

    def __init__(self, scenario: Scenario, rng: np.random.Generator) -> None:
        self._scenario, self._rng = scenario, rng
        self._larger = 1.0
        self._lasting: dict[int, Vector] = {}
        self._filters: dict[int, Estimator] = {}
        self._places: dict[int, Vector] = {}
        self._sources = {
            part.name: (root_of(part.covariance), part.correlation)
            for v in scenario.vehicles
            for part in v.shared
        }
        self._blowing: dict[str, Vector] = {}
        self._tracks = {
            i: o.shape
            for i, o in enumerate(scenario.obstacles)
            if isinstance(o.shape, TrackShape) and o.shape.is_uncertain
        }

    def begin(self) -> float:
        """Draw by how much all deviations are larger than stated, what lasts, where obstacles are.

        Returns
        -------
        float
            That factor; 1 where covariances are known.
        """
        samples = self._scenario.covariance_samples
        if samples is not None:
            self._larger = float(np.sqrt(samples / self._rng.chisquare(samples)))
        for i, vehicle in enumerate(self._scenario.vehicles):
            if vehicle.disturbance_correlation > 0.0:
                self._lasting[i] = self._drawn(vehicle.disturbance_covariance)
            if vehicle.measurement is not None:
                self._filters[i] = Estimator.of(vehicle, self._scenario.horizon)
        self._blowing = {
            name: self._larger * (root @ self._rng.standard_normal(len(root)))
            for name, (root, rho) in self._sources.items()
            if rho > 0.0
        }
        self._places = {i: self._drawn(shape.covariance) for i, shape in self._tracks.items()}
        return self._larger

    def disturbed(self, fresh: Sequence[Vector]) -> list[Vector]:
        """Return what is added to all states over a step, and move obstacles.

        Parameters
        ----------
        fresh : sequence of (n,) array
            Of the covariance of every vehicle's own disturbance, drawn anew.
        """
        added = list(fresh)
        for i, now in self._lasting.items():
            rho = self._scenario.vehicles[i].disturbance_correlation
            added[i], self._lasting[i] = now, rho * now + np.sqrt(1.0 - rho * rho) * fresh[i]
        drawn = {
            name: self._larger * (root @ self._rng.standard_normal(len(root)))
            for name, (root, _) in self._sources.items()
        }
        for name, now in self._blowing.items():
            rho = self._sources[name][1]
            self._blowing[name] = rho * now + np.sqrt(1.0 - rho * rho) * drawn[name]
            drawn[name] = now
        for i, vehicle in enumerate(self._scenario.vehicles):
            for part in vehicle.shared:
                added[i] = added[i] + part.matrix @ drawn[part.name]
        for i, shape in self._tracks.items():
            place, speed = np.split(self._places[i], 2)
            onward = np.concatenate([place + self._scenario.dt * speed, speed])
            self._places[i] = onward + self._drawn(shape.disturbance_covariance)
        return added

    def estimated(
        self, states: Sequence[Vector], controls: Sequence[Vector] | None
    ) -> tuple[Vector, ...]:
        """Return states as they are known: for vehicles with a measurement, the estimates.

        Parameters
        ----------
        states : sequence of (n,) array
            As they are.
        controls : sequence of (m,) array or None
            What was flown until now; None at the beginning.
        """
        known = list(states)
        for i, estimator in self._filters.items():
            if controls is not None:
                estimator.flown(controls[i])
            sensor = estimator.vehicle.measurement
            if sensor is not None:
                noise = self._drawn(sensor.covariance)
                known[i] = estimator.measured(sensor.matrix @ states[i] + noise)
        return tuple(known)

    def stray(self, obstacle: int) -> Vector | None:
        """Return how far an obstacle is from where it is expected, (d,); None where it is known.

        Parameters
        ----------
        obstacle : int
            Its number.
        """
        place = self._places.get(obstacle)
        return None if place is None else np.split(place, 2)[0]

    def _drawn(self, covariance: Matrix) -> Vector:
        """Return noise of a covariance as stated, as large as it is in this mission."""
        normals = self._rng.standard_normal(len(covariance))
        return np.asarray(self._larger * (root_of(covariance) @ normals))
