"""Missions in the world as it is measured, flown without the referee, mechanism by mechanism.

A current carries, a gust lasts, a wind blows on all, a receiver errs and a filter makes of it what
it can, a freighter strays, and all noise is stronger or weaker than stated: each is a few lines
that know nothing of joint covariances. Every mission has a filter of its own; wind and what strays
are the same for all vehicles. Slow and plain, as `hunting.flight` is, with whose geometry paths are
looked at in a few moments per step: at most what collides is counted.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.linalg import block_diag

from hunting.flight import MOMENTS, hits_at, places_of, root_of
from radmpc.arrays import Matrix, Vector
from radmpc.model.noise.shared import SharedDisturbance
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
    dice = _Dice(samples, scenario.covariance_samples, seed)
    winds = {part.name: _Wind(part, dice) for v in scenario.vehicles for part in v.shared}
    fleet = [_Craft(vehicle, winds, dice) for vehicle in scenario.vehicles]
    things = [_Stray.of(thing, dice) for thing in scenario.obstacles]
    off = [None if thing is None else thing.place for thing in things]
    hit = hits_at(plan, 0, 0.0, [craft.place for craft in fleet], off)
    shares = [1.0]
    if scenario.avoidance == "intervals":
        shares = [(j + 1) / MOMENTS for j in range(MOMENTS)]
    for k in range(scenario.horizon):
        before = [craft.place for craft in fleet]
        pushes = [
            craft.fly(trajectory.controls[k])
            for craft, trajectory in zip(fleet, plan.trajectories, strict=True)
        ]
        for wind in winds.values():
            wind.blow_on()
        after = [craft.place for craft in fleet]
        moved = [None if thing is None else thing.stray(scenario.dt) for thing in things]
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


class _Dice:
    """Draws for all missions; where covariances are known up to a factor, each has its own."""

    def __init__(self, samples: int, freedom: int | None, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._scale = np.ones((samples, 1))
        if freedom is not None:
            self._scale[:, 0] = np.sqrt(freedom / self._rng.chisquare(freedom, samples))

    def draw(self, covariance: Matrix) -> Matrix:
        """Return noise of a covariance as stated, (S, n)."""
        normals = self._rng.standard_normal((len(self._scale), len(covariance)))
        return np.asarray(self._scale * (normals @ root_of(covariance).T))


class _Wind:
    """What all vehicles meet, in all missions."""

    def __init__(self, part: SharedDisturbance, dice: _Dice) -> None:
        self._part, self._dice = part, dice
        self.now = dice.draw(part.covariance)

    def blow_on(self) -> None:
        """Go on by a step."""
        rho = self._part.correlation
        self.now = rho * self.now + np.sqrt(1.0 - rho**2) * self._dice.draw(self._part.covariance)


class _Craft:
    """A vehicle in all missions."""

    def __init__(self, vehicle: Vehicle, winds: Mapping[str, _Wind], dice: _Dice) -> None:
        self.vehicle, self._winds, self._dice = vehicle, winds, dice
        self.mean = np.array(vehicle.start)
        n = self.mean.size
        self.state = self.mean + dice.draw(vehicle.initial_covariance)
        self.gust = dice.draw(vehicle.disturbance_covariance)
        # All that pushes: its own gust, then what others meet as well.
        own = (np.eye(n), vehicle.disturbance_covariance, vehicle.disturbance_correlation)
        pushes = [own, *((p.matrix, p.covariance, p.correlation) for p in vehicle.shared)]
        sizes = [len(covariance) for _, covariance, _ in pushes]
        lasting = np.repeat([rho for _, _, rho in pushes], sizes)
        # What the filter thinks: the state and all that, and how unsure it is of them.
        q = n + sum(sizes)
        self.guess = np.tile(np.append(self.mean, np.zeros(sum(sizes))), (len(self.state), 1))
        self.doubt = block_diag(vehicle.initial_covariance, *(c for _, c, _ in pushes))
        self._step = np.zeros((q, q))
        self._step[:n] = np.hstack([vehicle.system.A, *(matrix for matrix, _, _ in pushes)])
        self._step[n:, n:] = np.diag(lasting)
        fresh = [(1.0 - rho**2) * covariance for _, covariance, rho in pushes]
        self._fresh = block_diag(np.zeros((n, n)), *fresh)

    @property
    def place(self) -> Matrix:
        """Where it is, (S, d)."""
        return places_of(self.vehicle, self.state)

    def fly(self, nominal: Vector) -> Matrix:
        """Hold a control over a step; return what it shifts the place by where paths are curved."""
        vehicle, system = self.vehicle, self.vehicle.system
        asked = np.tile(nominal, (len(self.state), 1))
        known = self.state if vehicle.measurement is None else self._look()
        if vehicle.gain is not None:
            asked = asked + (known - self.mean) @ vehicle.gain.T
            asked = np.clip(asked, -vehicle.control_limit, vehicle.control_limit)
        drift = np.zeros(self.mean.size) if vehicle.drift is None else vehicle.drift
        blown = self.gust + sum(self._winds[p.name].now @ p.matrix.T for p in vehicle.shared)
        self.state = self.state @ system.A.T + asked @ system.B.T + blown + drift
        self.mean = system.A @ self.mean + system.B @ nominal + drift
        rho = vehicle.disturbance_correlation
        fresh = self._dice.draw(vehicle.disturbance_covariance)
        self.gust = rho * self.gust + np.sqrt(1.0 - rho**2) * fresh
        if vehicle.measurement is not None:
            self._expect(asked @ system.B.T + drift)
        push: Matrix = asked @ system.B[list(system.position)].T
        return push if system.is_double_integrator else np.zeros_like(push)

    def _look(self) -> Matrix:
        """Measure; return what every mission takes its state for."""
        sensor = self.vehicle.measurement
        if sensor is None:
            return self.state
        seen = self.state @ sensor.matrix.T + self._dice.draw(sensor.covariance)
        n = self.mean.size
        wide = np.zeros((len(sensor.matrix), len(self.doubt)))
        wide[:, :n] = sensor.matrix
        expected = wide @ self.doubt @ wide.T + sensor.covariance
        gain = self.doubt @ wide.T @ np.linalg.pinv(expected, 1e-10)
        self.guess = self.guess + (seen - self.guess @ wide.T) @ gain.T
        self.doubt = self.doubt - gain @ wide @ self.doubt
        return self.guess[:, :n]

    def _expect(self, moved: Matrix) -> None:
        """Let what is thought go on by a step in which the state is moved."""
        self.guess = self.guess @ self._step.T
        self.guess[:, : self.mean.size] += moved
        self.doubt = self._step @ self.doubt @ self._step.T + self._fresh


class _Stray:
    """How far an obstacle is from where it is expected, in all missions."""

    def __init__(self, shape: TrackShape, dice: _Dice) -> None:
        self._jolt, self._dice = shape.disturbance_covariance, dice
        self._off = dice.draw(shape.covariance)

    @classmethod
    def of(cls, thing: Obstacle, dice: _Dice) -> _Stray | None:
        """Return what strays; None of what stands or moves as stated."""
        return cls(thing.shape, dice) if isinstance(thing.shape, TrackShape) else None

    @property
    def place(self) -> Matrix:
        """How far its place is off, (S, d)."""
        return self._off[:, : self._off.shape[1] // 2].copy()

    def stray(self, dt: float) -> Matrix:
        """Go on by a step; return how far the place is off."""
        d = self._off.shape[1] // 2
        self._off[:, :d] += dt * self._off[:, d:]
        self._off += self._dice.draw(self._jolt)
        return self.place
