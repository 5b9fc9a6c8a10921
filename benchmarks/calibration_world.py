"""Missions in the world as it is measured, flown without the referee, mechanism by mechanism.

A current carries, a gust lasts, a receiver errs and a filter makes of it what it can, a freighter
strays: each is a few lines that know nothing of joint covariances. Every mission has a filter of
its own, and what strays does so for all vehicles alike. Slow and plain, as `hunt_flight` is, with
whose geometry paths are looked at in a few moments per step: at most what collides is counted.
"""

from __future__ import annotations

import numpy as np

from hunt_flight import MOMENTS, hits_at, places_of, root_of
from radmpc.arrays import Matrix, Vector
from radmpc.model.obstacle import Obstacle, TrackShape
from radmpc.model.plan import Plan
from radmpc.model.vehicle import Vehicle

__all__ = ["world_collisions"]


def world_collisions(plan: Plan, samples: int, seed: int) -> int:
    """Return in how many missions anything collides.

    Parameters
    ----------
    plan : Plan
        Judged by its scenario and controls.
    samples : int
        Missions.
    seed : int
        Of all noise.
    """
    scenario = plan.scenario
    rng = np.random.default_rng(seed)
    fleet = [_Craft(vehicle, samples, rng) for vehicle in scenario.vehicles]
    things = [_Stray.of(thing, samples, rng) for thing in scenario.obstacles]
    off = [None if thing is None else thing.place for thing in things]
    hit = hits_at(plan, 0, 0.0, [craft.place for craft in fleet], off)
    shares = [1.0]
    if scenario.avoidance == "intervals":
        shares = [(j + 1) / MOMENTS for j in range(MOMENTS)]
    for k in range(scenario.horizon):
        before = [craft.place for craft in fleet]
        pushes = [
            craft.fly(trajectory.controls[k], rng)
            for craft, trajectory in zip(fleet, plan.trajectories, strict=True)
        ]
        after = [craft.place for craft in fleet]
        moved = [None if thing is None else thing.stray(scenario.dt, rng) for thing in things]
        for s in shares:
            places = [
                (1.0 - s) * here + s * there - s * (1.0 - s) * push
                for here, there, push in zip(before, after, pushes, strict=True)
            ]
            strays = [
                None if here is None or there is None else (1.0 - s) * here + s * there
                for here, there in zip(off, moved, strict=True)
            ]
            hit |= hits_at(plan, k, s, places, strays)
        off = moved
    return int(hit.sum())


class _Craft:
    """A vehicle in all missions."""

    def __init__(self, vehicle: Vehicle, samples: int, rng: np.random.Generator) -> None:
        self.vehicle = vehicle
        self.mean = np.array(vehicle.start)
        n = self.mean.size
        self.state = (
            self.mean + rng.standard_normal((samples, n)) @ root_of(vehicle.initial_covariance).T
        )
        self.gust = self._new(samples, rng)
        # What the filter thinks: state and gust, and how unsure it is of both.
        self.guess = np.hstack([np.tile(self.mean, (samples, 1)), np.zeros((samples, n))])
        self.doubt = np.zeros((2 * n, 2 * n))
        self.doubt[:n, :n] = vehicle.initial_covariance
        self.doubt[n:, n:] = vehicle.disturbance_covariance

    @property
    def place(self) -> Matrix:
        """Where it is, (S, d)."""
        return places_of(self.vehicle, self.state)

    def fly(self, nominal: Vector, rng: np.random.Generator) -> Matrix:
        """Hold a control over a step; return what it shifts the place by where paths are curved."""
        vehicle, system = self.vehicle, self.vehicle.system
        asked = np.tile(nominal, (len(self.state), 1))
        known = self.state if vehicle.measurement is None else self._look(rng)
        if vehicle.gain is not None:
            asked = asked + (known - self.mean) @ vehicle.gain.T
            asked = np.clip(asked, -vehicle.control_limit, vehicle.control_limit)
        drift = np.zeros(self.mean.size) if vehicle.drift is None else vehicle.drift
        self.state = self.state @ system.A.T + asked @ system.B.T + self.gust + drift
        self.mean = system.A @ self.mean + system.B @ nominal + drift
        rho = vehicle.disturbance_correlation
        self.gust = rho * self.gust + np.sqrt(1.0 - rho**2) * self._new(len(self.state), rng)
        if vehicle.measurement is not None:
            self._expect(asked @ system.B.T + drift)
        push: Matrix = asked @ system.B[list(system.position)].T
        return push if system.is_double_integrator else np.zeros_like(push)

    def _new(self, samples: int, rng: np.random.Generator) -> Matrix:
        """Draw a disturbance per mission."""
        root = root_of(self.vehicle.disturbance_covariance)
        return np.asarray(rng.standard_normal((samples, len(root))) @ root.T)

    def _look(self, rng: np.random.Generator) -> Matrix:
        """Measure; return what every mission takes its state for."""
        sensor = self.vehicle.measurement
        if sensor is None:
            return self.state
        noise = rng.standard_normal((len(self.state), len(sensor.matrix)))
        seen = self.state @ sensor.matrix.T + noise @ root_of(sensor.covariance).T
        n = self.mean.size
        wide = np.hstack([sensor.matrix, np.zeros_like(sensor.matrix)])
        expected = wide @ self.doubt @ wide.T + sensor.covariance
        gain = self.doubt @ wide.T @ np.linalg.pinv(expected, 1e-10)
        self.guess = self.guess + (seen - self.guess @ wide.T) @ gain.T
        self.doubt = self.doubt - gain @ wide @ self.doubt
        return self.guess[:, :n]

    def _expect(self, moved: Matrix) -> None:
        """Let what is thought go on by a step in which the state is moved."""
        n, rho = self.mean.size, self.vehicle.disturbance_correlation
        step = np.block([[self.vehicle.system.A, np.eye(n)], [np.zeros((n, n)), rho * np.eye(n)]])
        self.guess = self.guess @ step.T
        self.guess[:, :n] += moved
        self.doubt = step @ self.doubt @ step.T
        self.doubt[n:, n:] += (1.0 - rho**2) * self.vehicle.disturbance_covariance


class _Stray:
    """How far an obstacle is from where it is expected, in all missions."""

    def __init__(self, shape: TrackShape, samples: int, rng: np.random.Generator) -> None:
        self._jolt = root_of(shape.disturbance_covariance)
        noise = rng.standard_normal((samples, shape.start.size))
        self._off = noise @ root_of(shape.covariance).T

    @classmethod
    def of(cls, thing: Obstacle, samples: int, rng: np.random.Generator) -> _Stray | None:
        """Return what strays; None of what stands or moves as stated."""
        return cls(thing.shape, samples, rng) if isinstance(thing.shape, TrackShape) else None

    @property
    def place(self) -> Matrix:
        """How far its place is off, (S, d)."""
        return self._off[:, : self._off.shape[1] // 2].copy()

    def stray(self, dt: float, rng: np.random.Generator) -> Matrix:
        """Go on by a step; return how far the place is off."""
        d = self._off.shape[1] // 2
        self._off[:, :d] += dt * self._off[:, d:]
        self._off += rng.standard_normal(self._off.shape) @ self._jolt.T
        return self.place
