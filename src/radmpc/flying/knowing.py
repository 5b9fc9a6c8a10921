"""What is known of vehicles under way: their states, and what will go on of their disturbances.

Of a vehicle whose disturbances last, or that measures its state with noise, what is known is longer
than its state: the state (or the filter's estimate), and the means over the step that follows of
its own disturbance and of those it shares and that last, n + n + s numbers. The covariance of what
is not known goes with the step alone. It is called *known* in what follows; of all other vehicles
it is the measured state.

Where vehicles share disturbances and any of these or of their own last, all of them are learned of
together (`radmpc.model.noise.fleet`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.noise.filtering import Learning, learning_of
from radmpc.model.noise.fleet import FleetLearning, fleet_learning
from radmpc.model.noise.known import Known
from radmpc.model.noise.shared import lasting_parts
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass

__all__ = [
    "Observer",
    "expected_anew",
    "expected_start",
    "known_after",
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
        The vehicle.
    """
    if vehicle.disturbance_correlation > 0.0 or vehicle.measurement is not None:
        return True
    return bool(vehicle.shared and lasting_parts(vehicle.shared))


def expected_start(vehicle: Vehicle) -> Vector:
    """Return what is known of a vehicle before anything is measured.

    Parameters
    ----------
    vehicle : Vehicle
        At the first step of a scenario.
    """
    if not remembers(vehicle):
        return vehicle.start
    own = np.zeros(vehicle.start.size)
    shared = np.zeros(sum(part.size for part in lasting_parts(vehicle.shared)))
    if vehicle.known is not None:
        own = vehicle.known.disturbance
        shared = shared if vehicle.known.lasting is None else vehicle.known.lasting
    return np.concatenate([vehicle.start, own, shared])


def expected_anew(scenario: Scenario, expected: Sequence[Vector]) -> tuple[Vector, ...]:
    """Return what is expected where another scenario begins under way.

    Parameters
    ----------
    scenario : Scenario
        Of the steps that are left.
    expected : sequence of (n,) or (2 n + s,) array
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
    for part in lasting_parts(vehicle.shared):
        acts = np.vstack([part.matrix, np.zeros((len(longer) - len(A), part.size))])
        keeps = part.correlation * np.eye(part.size)
        longer = np.block([[longer, acts], [np.zeros_like(acts.T), keeps]])
    more = len(longer) - len(A)
    held = None if gain is None else np.pad(gain, ((0, 0), (0, more)))
    return longer, np.pad(B, ((0, more), (0, 0))), held


def moved(vehicle: Vehicle, known: Vector, control: Vector) -> Vector:
    """Return what is expected to be known a step later.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    known : (n,) or (2 n + s,) array
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
        Whose disturbances last, or that measures with noise; of which no others tell.
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


def known_after(
    scenario: Scenario, passed: int, known: Sequence[Vector]
) -> tuple[Known | None, ...]:
    """Return what plans begin with once a step was measured; None is the state, exactly.

    Parameters
    ----------
    scenario : Scenario
        Of all steps.
    passed : int
        Steps from its first.
    known : sequence of (n,) or (2 n + s,) array
        What is known there.
    """
    vehicles = scenario.vehicles
    fleet = fleet_learning(vehicles, scenario.horizon)
    found: list[Known | None] = [None] * len(vehicles)
    if fleet is not None:
        noises, means = (
            [vehicles[i].noise for i in fleet.members],
            [known[i] for i in fleet.members],
        )
        for i, each in zip(fleet.members, fleet.known(passed, noises, means), strict=True):
            found[i] = each if remembers(vehicles[i]) else None
    for i, vehicle in enumerate(vehicles):
        if remembers(vehicle) and found[i] is None:
            n = vehicle.start.size
            found[i] = Known(known[i][n:], unknown_after(vehicle, passed))
    return tuple(found)


@dataclass(frozen=True, slots=True, eq=False)
class Observer:
    """Makes of measured states, or estimates, what is known of vehicles.

    Attributes
    ----------
    began : int
        The mission's step at which its scenario begins.
    learning : tuple of Learning or None
        Of each vehicle that remembers, and of which no others tell; None of all others.
    fleet : FleetLearning or None
        Of the vehicles that tell of each other; None where none do.
    """

    began: int
    learning: tuple[Learning | None, ...]
    fleet: FleetLearning | None = None

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
        fleet = fleet_learning(scenario.vehicles, scenario.horizon)
        tied = () if fleet is None else fleet.members
        alone = (
            learning_of(v.system, v.noise, scenario.horizon)
            if remembers(v) and i not in tied
            else None
            for i, v in enumerate(scenario.vehicles)
        )
        return cls(began, tuple(alone), fleet)

    def known(
        self, step: int, expected: Sequence[Vector], states: Sequence[Vector]
    ) -> tuple[Vector, ...]:
        """Return what is known after a measurement.

        Parameters
        ----------
        step : int
            Of the mission.
        expected : sequence of (n,) or (2 n + s,) array
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
        if self.fleet is not None:
            tied = self.fleet.members
            seen = [states[i] - expected[i][: states[i].size] for i in tied]
            for i, change in zip(tied, self.fleet.learned(step - self.began, seen), strict=True):
                n = states[i].size
                rest = expected[i][n:]
                made[i] = np.concatenate([states[i], rest + change[n : n + rest.size]])
        return tuple(made)

    def told(self, step: int) -> tuple[Matrix | None, ...]:
        """Return by how much estimates move at a step, (n, n) each; None where states are told.

        Parameters
        ----------
        step : int
            Of the mission.
        """
        at = step - self.began
        found = [None if one is None else one.told[at] for one in self.learning]
        if self.fleet is not None:
            for i, each in zip(self.fleet.members, self.fleet.told_of(at), strict=True):
                found[i] = each
        return tuple(found)

    def told_together(self, step: int) -> Matrix | None:
        """Return by how much the states of all who tell of each other were to move; None of none.

        Parameters
        ----------
        step : int
            Of the mission.
        """
        return None if self.fleet is None else self.fleet.told[step - self.began]
