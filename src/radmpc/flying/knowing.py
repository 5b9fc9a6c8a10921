"""What is known of vehicles under way: their states, and what will go on of their disturbances.

Of a vehicle whose disturbances last, or that measures its state with noise, what is known is longer
than its state: the state (or the filter's estimate), and the mean of the disturbance over the step
that follows. The covariance of what is not known goes with the step alone. It is called *known* in
what follows; of all other vehicles it is the measured state.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.noise.filtering import Learning, learning_of
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass

__all__ = [
    "Observer",
    "expected_anew",
    "expected_start",
    "known_loop",
    "moved",
    "remembers",
    "unknown_after",
]


def remembers(vehicle: Vehicle) -> bool:
    """Whether more than a vehicle's measured state tells what is to come.

    Parameters
    ----------
    vehicle : Vehicle
        That shares no noise that lasts.
    """
    return vehicle.disturbance_correlation > 0.0 or vehicle.measurement is not None


def expected_start(vehicle: Vehicle) -> Vector:
    """Return what is known of a vehicle before anything is measured.

    Parameters
    ----------
    vehicle : Vehicle
        At the first step of a scenario.
    """
    if not remembers(vehicle):
        return vehicle.start
    lasting = np.zeros(vehicle.start.size)
    if vehicle.known is not None:
        lasting = vehicle.known.disturbance
    return np.concatenate([vehicle.start, lasting])


def expected_anew(scenario: Scenario, expected: Sequence[Vector]) -> tuple[Vector, ...]:
    """Return what is expected where another scenario begins under way.

    Parameters
    ----------
    scenario : Scenario
        Of the steps that are left.
    expected : sequence of (n,) or (2 n,) array
        What was.
    """
    pairs = zip(scenario.vehicles, expected, strict=True)
    return tuple(expected_start(v) if remembers(v) else x for v, x in pairs)


def known_loop(vehicle: Vehicle) -> tuple[Matrix, Matrix, Matrix | None]:
    """Return A, B and K of what is known of a vehicle.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    """
    A, B, gain = vehicle.system.A, vehicle.system.B, vehicle.gain
    if not remembers(vehicle):
        return A, B, gain
    one, none = np.eye(len(A)), np.zeros_like(A)
    longer = np.block([[A, one], [none, vehicle.disturbance_correlation * one]])
    held = None if gain is None else np.hstack([gain, np.zeros_like(gain)])
    return longer, np.vstack([B, np.zeros_like(B)]), held


def moved(vehicle: Vehicle, known: Vector, control: Vector) -> Vector:
    """Return what is expected to be known a step later.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    known : (n,) or (2 n,) array
        What is known.
    control : (m,) array
        What is flown over the step.
    """
    A, B, _ = known_loop(vehicle)
    later = np.asarray(A @ known + B @ control)
    if vehicle.drift is not None:
        later[: vehicle.drift.size] += vehicle.drift
    return later


def unknown_after(vehicle: Vehicle, passed: int) -> Matrix:
    """Return the covariance of what is not known once a step was measured, (2 n, 2 n).

    Parameters
    ----------
    vehicle : Vehicle
        Whose disturbances last, or that measures with noise.
    passed : int
        Steps from its scenario's first.
    """
    if vehicle.measurement is not None:
        return learning_of(vehicle.system, vehicle.noise, passed).unknown[passed]
    n, rho = vehicle.start.size, vehicle.disturbance_correlation
    result = np.zeros((2 * n, 2 * n))
    result[n:, n:] = vehicle.disturbance_covariance
    if passed:
        # The state told what came in; what is new in the next one it cannot tell.
        result[n:, n:] *= 1.0 - rho * rho
    elif vehicle.known is not None:
        result[n:, n:] = vehicle.known.covariance[n:, n:]
    return result


@dataclass(frozen=True, slots=True, eq=False)
class Observer:
    """Makes of measured states, or estimates, what is known of vehicles.

    Attributes
    ----------
    began : int
        The mission's step at which its scenario begins.
    learning : tuple of Learning or None
        Of each vehicle that remembers; None of all others.
    """

    began: int
    learning: tuple[Learning | None, ...]

    @classmethod
    def of(cls, scenario: Scenario, began: int = 0) -> Observer:
        """Return the observer of a mission.

        Parameters
        ----------
        scenario : Scenario
            Of the steps from one on.
        began : int
            The mission's step at which it begins.
        """
        return cls(
            began,
            tuple(
                learning_of(v.system, v.noise, scenario.horizon) if remembers(v) else None
                for v in scenario.vehicles
            ),
        )

    def known(
        self, step: int, expected: Sequence[Vector], states: Sequence[Vector]
    ) -> tuple[Vector, ...]:
        """Return what is known after a measurement.

        Parameters
        ----------
        step : int
            Of the mission.
        expected : sequence of (n,) or (2 n,) array
            What was expected to be known.
        states : sequence of (n,) array
            Measured states, or estimates.
        """
        made = []
        for learning, hoped, state in zip(self.learning, expected, states, strict=True):
            if learning is None:
                made.append(state)
                continue
            before, lasting = np.split(hoped, 2)
            carried = learning.carried(step - self.began, state - before)
            made.append(np.concatenate([state, lasting + carried]))
        return tuple(made)

    def told(self, step: int) -> tuple[Matrix | None, ...]:
        """Return by how much estimates move at a step, (n, n) each; None where states are told.

        Parameters
        ----------
        step : int
            Of the mission.
        """
        at = step - self.began
        return tuple(None if one is None else one.told[at] for one in self.learning)
