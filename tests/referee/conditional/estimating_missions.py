"""Missions of vehicles that share disturbances and estimate their states; known by brute force.

All that is drawn, initial deviations, what is added over every step, and errors of sensors, is one
long Gaussian vector. What is measured and what is to be told are rows on it: the one is conditioned
on the other, at each step anew. Each vehicle's own filter is the textbook's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from conditional_missions import Missions
from gusty_missions import lags, remembers, rows_of, sources_of
from noisy_missions import ObservedMissions
from scipy.linalg import block_diag

from radmpc.flying.knowing import expected_start
from radmpc.flying.leg import leg_of
from radmpc.flying.remainder import left_of
from radmpc.model.plan import Plan
from radmpc.model.vehicle import Vehicle
from radmpc.referee.conditional.rows import Witnesses


@dataclass(frozen=True)
class World:
    """Rows on all that is drawn.

    deviations : per step (p, V); added : per step (q, V), every source; measured : per step
    (r, V); covariance : (V, V)
    """

    deviations: list[np.ndarray]
    added: list[np.ndarray]
    measured: list[np.ndarray]
    covariance: np.ndarray


def begun_with(fleet: Sequence[Vehicle]) -> np.ndarray | None:
    """Return the covariance of deviations and all sources as a leg begins with it, if it does."""
    if all(v.belief is None for v in fleet):
        return None
    sources = sources_of(fleet)
    covariance = block_diag(*(v.initial_covariance for v in fleet), *(own for _, _, own in sources))
    rows = wanted_rows(fleet)
    root = np.zeros((len(covariance), 0))
    for v, at in zip(fleet, rows, strict=True):
        if v.belief is None:
            continue
        n = v.start.size
        mine = at[: 2 * n]
        covariance[np.ix_(mine, mine)] = v.belief.covariance
        if v.belief.common is not None:
            if not root.shape[1]:
                root = np.zeros((len(covariance), v.belief.common.shape[1]))
            covariance[at[2 * n :]] = covariance[:, at[2 * n :]] = 0.0
            root[at] = v.belief.common
    return covariance + root @ root.T


def world_of(fleet: Sequence[Vehicle], horizon: int) -> World:
    """Return what becomes of a fleet without control."""
    sources = sources_of(fleet)
    p, q = len(sources[0][0]), sum(len(covariance) for _, _, covariance in sources)
    sensors = [v.measurement for v in fleet]
    r = sum(
        v.start.size if s is None else len(s.matrix) for v, s in zip(fleet, sensors, strict=True)
    )
    A = block_diag(*(v.system.A for v in fleet))
    acts = np.hstack([one for one, _, _ in sources])
    sees = block_diag(
        *(
            np.eye(v.start.size) if s is None else s.matrix
            for v, s in zip(fleet, sensors, strict=True)
        )
    )
    error = block_diag(
        *(
            np.zeros(2 * (v.start.size,)) if s is None else s.covariance
            for v, s in zip(fleet, sensors, strict=True)
        )
    )
    size = p + (q + r) * (horizon + 1)
    covariance = np.zeros((size, size))
    # What is known of the beginning, and what becomes of it; all else is new.
    begun = begun_with(fleet)
    first = block_diag(*(v.initial_covariance for v in fleet), *(own for _, _, own in sources))
    onward = np.zeros((size, p + q))
    onward[:p, :p] = np.eye(p)
    row, at = p, p
    places = []
    for _, rho, own in sources:
        count, one = len(own) * (horizon + 1), np.eye(len(own))
        fades = rho ** np.arange(horizon + 1) if rho else np.eye(horizon + 1)[0]
        mine = slice(row, row + count)
        onward[mine, at : at + len(own)] = np.kron(fades[:, None], one)
        new = lags(rho, horizon + 1, own) - np.kron(np.outer(fades, fades), own)
        covariance[mine, mine] = new
        places.append(row)
        row, at = row + count, at + len(own)
    covariance += onward @ (first if begun is None else begun) @ onward.T
    now, deviations, added, measured = np.eye(p, size), [], [], []
    blank = 0 if begun is None else 1
    for k in range(horizon + 1):
        taken = np.zeros((q, size))
        at = 0
        for place, (_, _, own) in zip(places, sources, strict=True):
            r_own = len(own)
            taken[at : at + r_own, place + k * r_own : place + (k + 1) * r_own] = np.eye(r_own)
            at += r_own
        seen = sees @ now
        seen[:, row : row + r] = np.eye(r)
        if k < blank:
            # It has been measured already, and is in what is known.
            seen = 0.0 * seen
        covariance[row : row + r, row : row + r] = error
        row += r
        deviations.append(now)
        added.append(taken)
        measured.append(seen)
        now = A @ now + acts @ taken
    return World(deviations, added, measured, covariance)


def told_at(world: World, step: int) -> tuple[np.ndarray, np.ndarray]:
    """Return what deviations and sources are expected to be by all measured, and what it leaves."""
    seen = np.vstack(world.measured[: step + 1])
    wanted = np.vstack([world.deviations[step], world.added[step]])
    crossed = wanted @ world.covariance @ seen.T
    scale = np.sqrt(np.maximum(np.diag(seen @ world.covariance @ seen.T), 1e-30))
    total = (seen @ world.covariance @ seen.T) / np.outer(scale, scale)
    takes = (crossed / scale) @ np.linalg.pinv(total, 1e-11, hermitian=True) / scale
    return takes, wanted @ world.covariance @ wanted.T - takes @ crossed.T


def wanted_rows(fleet: Sequence[Vehicle]) -> list[np.ndarray]:
    """Return where in that each vehicle's deviation and its own and shared disturbances stand."""
    ends = np.cumsum([0, *(v.start.size for v in fleet)])
    return [
        np.concatenate([np.arange(a, b), ends[-1] + rows])
        for a, b, rows in zip(ends[:-1], ends[1:], rows_of(fleet), strict=True)
    ]


class Filter:
    """A vehicle's own Kalman filter, which hears of no others."""

    def __init__(self, vehicle: Vehicle) -> None:
        n = vehicle.start.size
        parts = [part for part in vehicle.shared if part.correlation > 0.0]
        sizes = [n, *(part.size for part in parts)]
        rho = np.repeat([vehicle.disturbance_correlation, *(p.correlation for p in parts)], sizes)
        source = block_diag(vehicle.disturbance_covariance, *(p.covariance for p in parts))
        new = sum(
            (p.matrix @ p.covariance @ p.matrix.T for p in vehicle.shared if not p.correlation),
            np.zeros((n, n)),
        )
        effects = np.hstack([np.eye(n), *(p.matrix for p in parts)])
        none = np.zeros((len(source), n))
        self.vehicle, self.n = vehicle, n
        self.F = np.block([[vehicle.system.A, effects], [none, np.diag(rho)]])
        self.P = block_diag(vehicle.initial_covariance, source)
        self.is_told = vehicle.belief is None
        if vehicle.belief is not None:
            self.P = vehicle.belief.common @ vehicle.belief.common.T
            self.P[: 2 * n, : 2 * n] += vehicle.belief.covariance
        self.Q = block_diag(new, source * (1.0 - np.outer(rho, rho)))

    def gain(self) -> np.ndarray:
        """Return the gain of the next step."""
        C, R = self.vehicle.measurement.matrix, self.vehicle.measurement.covariance
        C = np.hstack([C, np.zeros((len(C), len(self.P) - self.n))])
        L = self.P @ C.T @ np.linalg.inv(C @ self.P @ C.T + R)
        if not self.is_told:
            L, self.is_told = 0.0 * L, True
        P = self.P - L @ C @ self.P
        self.P = self.F @ P @ self.F.T + self.Q
        return L


def flown_estimating(witnesses: Witnesses, count: int, seed: int) -> ObservedMissions:
    """Return missions in which feedback acts on each one's own estimate."""
    rng = np.random.default_rng(seed)
    fleet, horizon = witnesses.plan.scenario.vehicles, witnesses.plan.scenario.horizon
    world = world_of(fleet, horizon)
    drawn = rng.multivariate_normal(
        np.zeros(len(world.covariance)), world.covariance, count, method="eigh"
    )
    free = [drawn @ rows.T for rows in world.deviations]
    seen = [drawn @ rows.T for rows in world.measured]
    rows = wanted_rows(fleet)
    best = []
    for k in range(horizon + 1):
        takes, _ = told_at(world, k)
        best.append(np.hstack(seen[: k + 1]) @ takes.T)
    ends = np.cumsum([0, *(v.start.size for v in fleet)])
    states, acted, known, row = [], [], [], 0
    for i, v in enumerate(fleet):
        n, sensor = v.start.size, v.measurement
        p = n if sensor is None else len(sensor.matrix)
        ys, row = [each[:, row : row + p] for each in seen], row + p
        nominal = witnesses.motion.states[i]
        path, hats, told = _steered(v, ([x[:, ends[i] : ends[i + 1]] for x in free], ys, nominal))
        for k in range(horizon + 1):
            mine = best[k][:, rows[i]].copy()
            mine[:, :n] += path[k] - free[k][:, ends[i] : ends[i + 1]] + nominal[k]
            if sensor is not None and v.shared:
                mine = np.hstack([told[k], told[k], mine])
            known.append(mine if remembers(v) or sensor is not None else mine[:, :n])
        states.append(np.array(path))
        acted.append(np.array(hats))
    by_vehicle = [known[i * (horizon + 1) : (i + 1) * (horizon + 1)] for i in range(len(fleet))]
    return ObservedMissions(Missions(states, [], {}, acted), by_vehicle)  # type: ignore[arg-type] # lists will do


def _steered(
    vehicle: Vehicle, given: tuple[list[np.ndarray], list[np.ndarray], np.ndarray]
) -> tuple[list[np.ndarray], list[np.ndarray], list[np.ndarray]]:
    """Return deviations under feedback, what it acts on, and what the vehicle's filter says."""
    free, ys, nominal = given
    A, B = vehicle.system.A, vehicle.system.B
    K = np.zeros((B.shape[1], len(A))) if vehicle.gain is None else vehicle.gain
    pushed = np.zeros_like(free[0])
    own = None if vehicle.measurement is None else Filter(vehicle)
    hat = None if own is None else np.zeros((len(pushed), len(own.F)))
    path, hats, told = [], [], []
    for k, (x, y) in enumerate(zip(free, ys, strict=True)):
        path.append(x + pushed)
        if own is None:
            acts = path[-1]
            told.append(path[-1] + nominal[k])
        else:
            C = vehicle.measurement.matrix
            hat = hat + (y + pushed @ C.T - hat[:, : own.n] @ C.T) @ own.gain().T
            acts = hat[:, : own.n].copy()
            full = hat.copy()
            full[:, : own.n] += nominal[k]
            told.append(full)
        hats.append(acts)
        asked = acts @ K.T @ B.T
        pushed = pushed @ A.T + asked
        if own is not None:
            hat = hat @ own.F.T
            hat[:, : own.n] += asked
    return path, hats, told


def left_after(plan: Plan, passed: int) -> Plan:
    """Return a leg that begins under way, with what is known then."""
    scenario = plan.scenario
    means = [expected_start(v) for v in scenario.vehicles]
    rest = left_of(scenario, passed, means, 0.49)
    controls = [path.controls[passed:] for path in plan.trajectories]
    return leg_of(rest, controls, passed).plan
