"""The world missions are flown in, written anew: noise, filters, tracks of obstacles, contacts.

Nothing of `radmpc.flying` or the referee draws or judges here. Paths are looked at in a few moments
per step, and contact begins a hair inside of the hulls: what is counted is never more than what
collides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from hunting.flight import MOMENTS, between, root_of, solid_distances
from radmpc.arrays import Matrix, Vector
from radmpc.flying.tick import Contact, Segment
from radmpc.model.obstacle import Obstacle
from radmpc.model.obstacle_track import TrackShape
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle

__all__ = ["World", "contacts_of"]

_INSIDE = 1e-6
"""Overlap from which on a contact counts, and what a range may be exceeded by [m]."""

Rng = np.random.Generator
States = tuple[Vector, ...]


@dataclass(slots=True, eq=False)
class Filter:
    """A vehicle's Kalman filter over its state, its own disturbance and those it shares.

    Attributes
    ----------
    vehicle : Vehicle
        Whose.
    mean, spread : (q,) and (q, q) array
        Of all of them, given what was measured.
    moves, pushes, stirs : array
        By what they go on from step to step, with controls, with covariance of what is new.
    """

    vehicle: Vehicle
    mean: Vector
    spread: Matrix
    moves: Matrix
    pushes: Matrix
    stirs: Matrix

    @classmethod
    def of(cls, vehicle: Vehicle) -> Filter:
        """Return it before the first measurement."""
        n, m = vehicle.system.B.shape
        parts = [(np.eye(n), vehicle.disturbance_covariance, vehicle.disturbance_correlation)]
        parts += [(p.matrix, p.covariance, p.correlation) for p in vehicle.shared]
        size = n + sum(matrix.shape[1] for matrix, _, _ in parts)
        moves, spread, stirs = (
            np.zeros((size, size)),
            np.zeros((size, size)),
            np.zeros((size, size)),
        )
        moves[:n, :n], spread[:n, :n] = vehicle.system.A, vehicle.initial_covariance
        at = n
        for matrix, covariance, lasts in parts:
            here = slice(at, at + matrix.shape[1])
            moves[:n, here] = matrix
            moves[here, here] = lasts * np.eye(matrix.shape[1])
            spread[here, here] = covariance
            stirs[here, here] = (1.0 - lasts**2) * covariance
            at = here.stop
        pushes = np.vstack([vehicle.system.B, np.zeros((size - n, m))])
        mean = np.concatenate([vehicle.start, np.zeros(size - n)])
        return cls(vehicle, mean, spread, moves, pushes, stirs)

    def told(self, found: Vector) -> Vector:
        """Take a measurement; return the estimate of the state."""
        sensor, n = self.vehicle.measurement, self.vehicle.start.size
        assert sensor is not None
        seen = np.hstack([sensor.matrix, np.zeros((len(sensor.matrix), self.mean.size - n))])
        surprise = seen @ self.spread @ seen.T + sensor.covariance
        gain = self.spread @ seen.T @ np.linalg.pinv(surprise, rcond=1e-12, hermitian=True)
        self.mean = self.mean + gain @ (found - seen @ self.mean)
        rest = np.eye(self.mean.size) - gain @ seen
        self.spread = rest @ self.spread @ rest.T + gain @ sensor.covariance @ gain.T
        return self.mean[:n].copy()

    def flown(self, control: Vector) -> None:
        """Go on by a step."""
        self.mean = self.moves @ self.mean + self.pushes @ control
        if self.vehicle.drift is not None:
            self.mean[: self.vehicle.start.size] += self.vehicle.drift
        self.spread = self.moves @ self.spread @ self.moves.T + self.stirs


class World:
    """Something to fly in, with `reset` and `advance` as `radmpc.Model` has them.

    Parameters
    ----------
    scenario : Scenario
        What is flown.
    seed : int or sequence of int
        Of all noise.
    """

    def __init__(self, scenario: Scenario, seed: int | Sequence[int]) -> None:
        self._scenario, self._rng = scenario, np.random.default_rng(seed)
        self._filters = [Filter.of(v) for v in scenario.vehicles]
        self._winds = {p.name: p for v in scenario.vehicles for p in v.shared}
        self._step, self._larger = 0, 1.0
        self._states: States = ()
        self._blowing: dict[str, Vector] = {}
        self._own: list[Vector] = []
        self._strays: dict[int, Vector] = {}

    def reset(self) -> tuple[States, tuple[Contact, ...]]:
        """Begin; return what is told of vehicles, and what is hit."""
        scenario = self._scenario
        if scenario.covariance_samples is not None:
            samples = scenario.covariance_samples
            self._larger = float(np.sqrt(samples / self._rng.chisquare(samples)))
        vehicles = scenario.vehicles
        self._states = tuple(v.start + self._drawn(v.initial_covariance) for v in vehicles)
        self._own = [self._drawn(v.disturbance_covariance) for v in vehicles]
        self._blowing = {name: self._drawn(p.covariance) for name, p in self._winds.items()}
        for i, obstacle in enumerate(scenario.obstacles):
            if isinstance(obstacle.shape, TrackShape):
                self._strays[i] = self._drawn(obstacle.shape.covariance)
        hits = ()
        if scenario.avoidance == "steps":
            hits = contacts_of(scenario, 0, self._states, self._states, None, self._where())
        return self._told(), hits

    def advance(self, segments: Sequence[Segment]) -> tuple[States, tuple[Contact, ...]]:
        """Fly a step; return what is told of vehicles, and what is hit on the way."""
        scenario, controls = self._scenario, [s.control for s in segments]
        before, after = self._states, []
        for i, vehicle in enumerate(scenario.vehicles):
            state = vehicle.system.A @ before[i] + vehicle.system.B @ controls[i] + self._own[i]
            if vehicle.drift is not None:
                state = state + vehicle.drift
            for part in vehicle.shared:
                state = state + part.matrix @ self._blowing[part.name]
            after.append(state)
            self._own[i] = self._next(
                self._own[i], vehicle.disturbance_covariance, vehicle.disturbance_correlation
            )
        self._states = tuple(after)
        for name, part in self._winds.items():
            self._blowing[name] = self._next(self._blowing[name], part.covariance, part.correlation)
        were = self._where()
        self._stray()
        for each, control in zip(self._filters, controls, strict=True):
            each.flown(control)
        self._step += 1
        told = self._told()
        if scenario.avoidance == "steps":
            now = self._states, self._states, None, self._where()
            return told, contacts_of(scenario, self._step, *now)
        now = before, self._states, controls, self._where(), were
        return told, contacts_of(scenario, self._step, *now)

    def _next(self, now: Vector, covariance: Matrix, lasts: float) -> Vector:
        """Return a disturbance a step later."""
        return np.asarray(lasts * now + np.sqrt(1.0 - lasts**2) * self._drawn(covariance))

    def _drawn(self, covariance: Matrix) -> Vector:
        """Return noise as large as it is in this mission."""
        return np.asarray(
            self._larger * (root_of(covariance) @ self._rng.standard_normal(len(covariance)))
        )

    def _stray(self) -> None:
        """Move obstacles by a step."""
        for i, place in self._strays.items():
            shape, d = self._scenario.obstacles[i].shape, self._scenario.dimension
            assert isinstance(shape, TrackShape)
            moved = place.copy()
            moved[:d] += self._scenario.dt * place[d:]
            self._strays[i] = moved + self._drawn(shape.disturbance_covariance)

    def _where(self) -> dict[int, Vector]:
        """Return how far obstacles are from where they are expected."""
        return {i: place[: self._scenario.dimension] for i, place in self._strays.items()}

    def _told(self) -> States:
        """Return states, or estimates of those who measure."""
        known = []
        for vehicle, state, each in zip(
            self._scenario.vehicles, self._states, self._filters, strict=True
        ):
            sensor = vehicle.measurement
            if sensor is None:
                known.append(state.copy())
            else:
                known.append(each.told(sensor.matrix @ state + self._drawn(sensor.covariance)))
        return tuple(known)


def contacts_of(
    scenario: Scenario,
    step: int,
    before: Sequence[Vector],
    after: Sequence[Vector],
    controls: Sequence[Vector] | None,
    now: dict[int, Vector] | None = None,
    then: dict[int, Vector] | None = None,
) -> tuple[Contact, ...]:
    """Return what is hit until a step.

    Parameters
    ----------
    scenario : Scenario
        Radii, obstacles, ranges, workspace.
    step : int
        At which it ends.
    before, after : sequence of (n,) array
        States at both ends.
    controls : sequence of (m,) array or None
        What was flown; None looks at the end alone.
    now, then : dict of (d,) array or None
        How far obstacles stray at the end and at the beginning [m], by number.
    """
    found: dict[tuple[str, str, str | None], None] = {}
    shares = [1.0] if controls is None else [j / MOMENTS for j in range(MOMENTS + 1)]
    now = now or {}
    then = then or now
    for s in shares:
        places = []
        for i, vehicle in enumerate(scenario.vehicles):
            axes = list(vehicle.system.position)
            place = (1.0 - s) * before[i][axes] + s * after[i][axes]
            if controls is not None and vehicle.system.is_double_integrator:
                place = place - s * (1.0 - s) * (vehicle.system.B[axes] @ controls[i])
            places.append(place)
        strays = {i: (1.0 - s) * then[i] + s * now[i] for i in now}
        _look(scenario, (step, s), places, strays, found)
    return tuple(Contact(step, *key) for key in found)  # type: ignore[arg-type] # as its key was made


def _look(
    scenario: Scenario,
    when: tuple[int, float],
    places: Sequence[Vector],
    strays: dict[int, Vector],
    found: dict[tuple[str, str, str | None], None],
) -> None:
    """Note what is hit at a moment."""
    vehicles, box = scenario.vehicles, scenario.workspace
    names = [v.name for v in vehicles]
    for i, j in combinations(range(len(vehicles)), 2):
        apart = float(np.linalg.norm(places[i] - places[j]))
        if apart < vehicles[i].radius + vehicles[j].radius - _INSIDE:
            found["pair", names[i], names[j]] = None
        for keep in scenario.keep:
            if {*keep.vehicles} == {names[i], names[j]} and apart > keep.within + _INSIDE:
                found["range", names[i], names[j]] = None
    for vehicle, place in zip(vehicles, places, strict=True):
        if box is not None and np.any(
            (place < box.lower - _INSIDE) | (place > box.upper + _INSIDE)
        ):
            found["workspace", vehicle.name, None] = None
        for number, obstacle in enumerate(scenario.obstacles):
            if _touches(obstacle, vehicle, place - strays.get(number, 0.0), when):
                found["obstacle", vehicle.name, obstacle.name] = None


def _touches(obstacle: Obstacle, vehicle: Vehicle, place: Vector, when: tuple[int, float]) -> bool:
    """Whether a vehicle touches an obstacle that concerns it."""
    concerns, (step, share) = obstacle.concerns, when
    if concerns is not None and (vehicle.name in concerns.names) == concerns.are_exempt:
        return False
    for number, piece in enumerate(obstacle.at(step)):
        solid = piece
        if obstacle.is_moving and share < 1.0:
            solid = between(obstacle.at(step - 1)[number], piece, share)
        if solid_distances(solid, place[None])[0] < vehicle.radius - _INSIDE:
            return True
    return False
