"""What is known of vehicles under way: their states, and what will go on of their disturbances.

Of a vehicle whose disturbances last, or that measures its state with noise, what is known is longer
than its state: the state (or the filter's estimate), and the means over the step that follows of
its own disturbance and of those it shares and that last, n + n + s numbers. The covariance of what
is not known goes with the step alone. It is called *known* in what follows; of all other vehicles
it is the measured state.

Where vehicles share disturbances and any of these or of their own last, or one of them measures
with noise, all of them are learned of together (`radmpc.model.noise.fleet`). Of one that measures
with noise and shares three such vectors are known, one after the other: the estimate of its own
filter, which is all that it reports; that of the filter on which the leg in the air acts, and which
began with that leg; and the estimate from everything that was measured.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.errors import ScenarioError
from radmpc.model.noise.belief import Belief
from radmpc.model.noise.filtering import Learning, learning_of
from radmpc.model.noise.fleet import fleet_learning
from radmpc.model.noise.shared import lasting_parts
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle

__all__ = [
    "acted_on",
    "best_of",
    "estimates_together",
    "expected_anew",
    "expected_start",
    "kept_learning",
    "known_after",
    "known_loop",
    "moved",
    "remembers",
    "renewed",
    "starting",
    "unknown_after",
]


def remembers(vehicle: Vehicle) -> bool:
    """Whether more than a vehicle's measured state predicts what is to come.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    """
    if vehicle.disturbance_correlation > 0.0 or vehicle.measurement is not None:
        return True
    return bool(vehicle.shared and lasting_parts(vehicle.shared))


def estimates_together(vehicle: Vehicle) -> bool:
    """Whether the others' measurements are informative about the error of a vehicle's own estimate.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    """
    return bool(vehicle.shared) and vehicle.measurement is not None


def _copies(vehicle: Vehicle) -> int:
    """Return how many vectors are known of a vehicle."""
    return 3 if estimates_together(vehicle) else 1


def acted_on(vehicle: Vehicle, known: Vector) -> Vector:
    """Return the state that feedback acts on, (n,).

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    known : (n,) or (2 n + s,) or (3 (2 n + s),) array
        What is known of it.
    """
    begins = known.size // 3 if estimates_together(vehicle) else 0
    return known[begins : begins + vehicle.start.size]


def best_of(vehicle: Vehicle, known: Vector) -> Vector:
    """Return the estimate from everything that was measured, (n,) or (2 n + s,).

    Parameters
    ----------
    vehicle, known
        As in `acted_on`.
    """
    return known[2 * known.size // 3 :] if estimates_together(vehicle) else known


def renewed(vehicles: Sequence[Vehicle], known: Sequence[Vector]) -> tuple[Vector, ...]:
    """Return what is known where another leg begins: its filters know what all tell.

    Parameters
    ----------
    vehicles : sequence of Vehicle
        The fleet.
    known : sequence of (n,), (2 n + s,) or (3 (2 n + s),) array
        What is known.
    """
    found = []
    for vehicle, each in zip(vehicles, known, strict=True):
        if estimates_together(vehicle):
            own, _, best = np.split(each, 3)
            found.append(np.concatenate([own, best, best]))
        else:
            found.append(each)
    return tuple(found)


def starting(vehicle: Vehicle, known: Vector, start: Vector) -> Vector:
    """Return what is known with another state, that at which a leg begins.

    Parameters
    ----------
    vehicle, known
        As in `acted_on`.
    start : (n,) array
        The state.
    """
    found = known.copy()
    best_of(vehicle, found)[: start.size] = start
    return found


@lru_cache(maxsize=128)
def kept_learning(vehicle: Vehicle, horizon: int) -> Learning:
    """Return what a vehicle's own measurements tell, the same again for the same value.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    horizon : int
        Number of steps T.
    """
    return learning_of(vehicle.system, vehicle.noise, horizon)


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
    if vehicle.belief is not None:
        own = vehicle.belief.disturbance
        shared = shared if vehicle.belief.lasting is None else vehicle.belief.lasting
    return np.concatenate([vehicle.start, own, shared] * _copies(vehicle))


def expected_anew(scenario: Scenario, expected: Sequence[Vector]) -> tuple[Vector, ...]:
    """Return what is expected where another scenario begins under way.

    Parameters
    ----------
    scenario : Scenario
        Of the steps that are left.
    expected : sequence of (n,) or (2 n + s,) array
        What was.

    Raises
    ------
    ScenarioError
        If a vehicle that shares disturbances measures its state with noise: what its own filter
        tells goes on from where it began.
    """
    if any(estimates_together(vehicle) for vehicle in scenario.vehicles):
        message = "vehicles learn of each other's states: plan the mission's remainder(states)"
        raise ScenarioError(message, ("vehicles",))
    pairs = zip(scenario.vehicles, expected, strict=True)
    return tuple(expected_start(v) if remembers(v) else x for v, x in pairs)


def known_loop(vehicle: Vehicle) -> tuple[Matrix, Matrix, Matrix | None]:
    """Return A, B and K of what is known of a vehicle.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    """
    A, B, gain = _own_loop(vehicle)
    if not estimates_together(vehicle):
        return A, B, gain
    held = None if gain is None else np.pad(gain, ((0, 0), (len(A), len(A))))
    return np.asarray(np.kron(np.eye(3), A), float), np.vstack([B, B, B]), held


def _own_loop(vehicle: Vehicle) -> tuple[Matrix, Matrix, Matrix | None]:
    """Return that of one of the vectors that are known."""
    A, B, gain = vehicle.system.A, vehicle.system.B, vehicle.gain
    if not remembers(vehicle):
        return A, B, gain
    one, none = np.eye(len(A)), np.zeros_like(A)
    longer = np.block([[A, one], [none, vehicle.disturbance_correlation * one]])
    for part in lasting_parts(vehicle.shared):
        acts = np.vstack([part.matrix, np.zeros((len(longer) - len(A), part.size))])
        keeps = part.correlation * np.eye(part.size)
        longer = np.block([[longer, acts], [np.zeros_like(acts.T), keeps]])
    none = np.zeros((len(longer) - len(A), B.shape[1]))
    held = None if gain is None else np.hstack([gain, none.T])
    return longer, np.vstack([B, none]), held


def moved(vehicle: Vehicle, known: Vector, control: Vector) -> Vector:
    """Return what is expected to be known a step later.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    known : (n,), (2 n + s,) or (3 (2 n + s),) array
        What is known; for a vehicle that estimates together with others, one of its parts will do.
    control : (m,) array
        What is flown over the step.
    """
    A, B, _ = _own_loop(vehicle)
    parts = [A @ part + B @ control for part in known.reshape(-1, len(A))]
    if vehicle.drift is not None:
        for part in parts:
            part[: vehicle.drift.size] += vehicle.drift
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


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
    elif vehicle.belief is not None:
        result[n:, n:] = vehicle.belief.covariance[n:, n:]
    return result


def known_after(
    scenario: Scenario, passed: int, known: Sequence[Vector]
) -> tuple[Belief | None, ...]:
    """Return what plans begin with once a step was measured; None is the state, exactly.

    Parameters
    ----------
    scenario : Scenario
        Of all steps.
    passed : int
        Steps from its first.
    known : sequence of (n,), (2 n + s,) or (3 (2 n + s),) array
        What is known there.
    """
    vehicles = scenario.vehicles
    known = [best_of(v, each) for v, each in zip(vehicles, known, strict=True)]
    fleet = fleet_learning(vehicles, scenario.horizon)
    found: list[Belief | None] = [None] * len(vehicles)
    if fleet is not None:
        noises, means = (
            [vehicles[i].noise for i in fleet.members],
            [known[i] for i in fleet.members],
        )
        for i, each in zip(fleet.members, fleet.beliefs(passed, noises, means), strict=True):
            found[i] = each
    for i, vehicle in enumerate(vehicles):
        if remembers(vehicle) and found[i] is None:
            n = vehicle.start.size
            found[i] = Belief(known[i][n:], unknown_after(vehicle, passed))
    return tuple(found)
