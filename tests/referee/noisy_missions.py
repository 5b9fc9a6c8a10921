"""Missions under all the noise there is, drawn and filtered as textbooks have it, many at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from conditional_missions import Missions, crowded, integral_hits, row_failures
from referee_scenes import make_plan

from radmpc.model.noise.measurement import Measurement
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.vehicle import Vehicle
from radmpc.referee.conditional.conditional import conditionals
from radmpc.referee.conditional.rows import Witnesses

SENSOR = Measurement.of([0, 1], 4, [[0.05, 0.01], [0.01, 0.04]])
DECK = np.array([[0.0, 0.0], [0.6, 0.0], [0.6, 0.6], [0.0, 0.6]])


def noisy(avoidance: str, *changes: dict[str, object], strays: bool = False, **more) -> Plan:
    """Return the crowded scene with vehicles changed one by one, and a ferry that strays."""
    plan = crowded(2, avoidance, **{"noise": 0.2, **more})
    scenario = plan.scenario
    fleet = (
        tuple(replace(v, **change) for v, change in zip(scenario.vehicles, changes, strict=False))
        + (scenario.vehicles[len(changes) :])
    )
    obstacles = scenario.obstacles
    if strays:
        spread = np.array(
            [[0.06, 0.01, 0, 0.01], [0.01, 0.04, 0, 0], [0, 0, 0.01, 0], [0.01, 0, 0, 0.01]]
        )
        ferry = Obstacle.tracked("ferry", DECK, [4.5, 2.9, -0.7, 0.0], spread, 0.01)
        obstacles = (obstacles[0], ferry)
    scenario = replace(scenario, vehicles=fleet, obstacles=obstacles)
    return make_plan(scenario, [t.controls for t in plan.trajectories])


def wind(sign: float = 1.0) -> tuple[SharedDisturbance, ...]:
    """Return a gust that is new at every step."""
    matrix = sign * np.vstack([0.5 * np.eye(2), np.eye(2)])
    return (SharedDisturbance("wind", matrix, [[0.02, 0.005], [0.005, 0.01]]),)


@dataclass(frozen=True)
class ObservedMissions:
    """All missions, and what is known of each vehicle at each step, (T+1, S, n or 2 n)."""

    missions: Missions
    known: list[np.ndarray]


def flown_noisily(witnesses: Witnesses, count: int, seed: int) -> ObservedMissions:
    """Return missions in which feedback gets what it asks for."""
    rng = np.random.default_rng(seed)
    scenario, horizon = witnesses.plan.scenario, witnesses.plan.scenario.horizon
    gusts: dict[str, np.ndarray] = {}
    for part in (part for v in scenario.vehicles for part in v.shared):
        zero = np.zeros(part.size)
        gusts.setdefault(
            part.name, rng.multivariate_normal(zero, part.covariance, (horizon, count))
        )
    states, seen, known = [], [], []
    for i, vehicle in enumerate(scenario.vehicles):
        path, hats, told = _flown(vehicle, gusts, (horizon, count), rng)
        nominal = witnesses.motion.states[i][:, None]
        n = nominal.shape[2]
        told[:, :, :n] += nominal
        states.append(path)
        seen.append(hats)
        memory = vehicle.disturbance_correlation > 0.0 or vehicle.measurement is not None
        known.append(told if memory else told[:, :, :n])
    strays = {}
    for number, obstacle in enumerate(scenario.obstacles):
        if obstacle.spread is None:
            continue
        shape = obstacle.shape
        now = rng.multivariate_normal(np.zeros(4), shape.covariance, count)
        places = [now[:, :2]]
        for _ in range(horizon):
            now = (
                now @ np.block([[np.eye(2), scenario.dt * np.eye(2)], [0 * np.eye(2), np.eye(2)]]).T
            )
            now = now + rng.multivariate_normal(np.zeros(4), shape.disturbance_covariance, count)
            places.append(now[:, :2])
        strays[number] = np.array(places)
    return ObservedMissions(Missions(states, [], strays, seen), known)


def _flown(
    vehicle: Vehicle, gusts: dict[str, np.ndarray], size: tuple[int, int], rng
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return deviations, what feedback acts on, and that with the disturbance that is expected."""
    horizon, count = size
    n, rho = vehicle.system.num_states, vehicle.disturbance_correlation
    zero = np.zeros(n)
    A, B = vehicle.system.A, vehicle.system.B
    K = np.zeros((B.shape[1], n)) if vehicle.gain is None else vehicle.gain
    W = vehicle.disturbance_covariance
    x = rng.multivariate_normal(zero, vehicle.initial_covariance, count)
    w = rng.multivariate_normal(zero, W, count)
    one = np.eye(n)
    F = np.block([[A, one], [0 * one, rho * one]])
    P = np.block([[vehicle.initial_covariance, 0 * one], [0 * one, W]])
    Q = np.block([[0 * one, 0 * one], [0 * one, (1 - rho**2) * W]])
    hat, came = np.zeros((count, 2 * n)), np.zeros((count, n))
    states, seen, known = [], [], []
    for k in range(horizon + 1):
        if vehicle.measurement is None:
            hat[:, :n] = x
            hat[:, n:] = rho * came
        else:
            C = np.hstack([vehicle.measurement.matrix, np.zeros_like(vehicle.measurement.matrix)])
            R = vehicle.measurement.covariance
            y = x @ C[:, :n].T + rng.multivariate_normal(np.zeros(len(R)), R, count)
            L = P @ C.T @ np.linalg.inv(C @ P @ C.T + R)
            hat = hat + (y - hat @ C.T) @ L.T
            P = (np.eye(2 * n) - L @ C) @ P
        states.append(x.copy())
        seen.append(hat[:, :n].copy())
        known.append(hat.copy())
        if k == horizon:
            break
        asked = hat[:, :n] @ K.T @ B.T
        came = w
        x = x @ A.T + asked + w
        for part in vehicle.shared:
            x = x + gusts[part.name][k] @ part.matrix.T
        w = rho * w + np.sqrt(1 - rho**2) * rng.multivariate_normal(zero, W, count)
        hat = hat @ F.T
        hat[:, :n] += asked
        P = F @ P @ F.T + Q
    return np.array(states), np.array(seen), np.array(known)


def check_charges(
    witnesses: Witnesses,
    flown: ObservedMissions,
    steps: tuple[int, ...],
    by: list[np.ndarray] | None = None,
) -> None:
    """Assert that rows fail as often as they are charged for, whatever is known: much or little.

    Missions are told apart by what is charged, or at each step by something else that is known.
    """
    for step in steps:
        _check_charges(witnesses, flown, step, None if by is None else by[step])


def _check_charges(
    witnesses: Witnesses, flown: ObservedMissions, step: int, by: np.ndarray | None
) -> None:
    """Assert it at one step."""
    missions = flown.missions
    found = conditionals(witnesses, step, [known[step] for known in flown.known])
    rows, integrals = witnesses.halfspaces, witnesses.integrals
    failed, hit = row_failures(witnesses, missions), integral_hits(witnesses, missions)
    coming = rows.windows >= step if witnesses.intervals else rows.windows > step
    later = integrals.windows > step
    hidden = witnesses.parties.are_hidden[rows.encounters]
    counts = (rows.before >= 0) & (coming[rows.before] | hidden)
    before = np.where(counts[:, None], failed[rows.before], False)
    happened = (failed & ~before)[coming].sum(axis=0) + hit[later].sum(axis=0)
    above = found.halfspaces.above[coming].sum(axis=0) + found.integrals.above[later].sum(axis=0)
    below = found.halfspaces.below[coming].sum(axis=0) + found.integrals.below[later].sum(axis=0)
    by = above if by is None else by
    level = np.quantile(by, [0.0, 0.5, 0.9, 1.0])
    for low, high in pairwise(level):
        some = (by >= low) & (by <= high)
        for value, sign in ((above, 1.0), (below, -1.0)):
            excess = happened[some] - value[some]
            # Where next to nothing fails it is counts that vary, and a few may be missing.
            count = some.sum()
            error = 4.0 * np.sqrt(max(excess.var(), value[some].mean()) / count) + 4.0 / count
            assert sign * excess.mean() <= error, (
                f"step {step}: {happened[some].mean()} fail, {value[some].mean()} are charged"
            )
