"""Many missions of one plan at once, and what its rows come to along the way."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from referee_scenes import make_plan, straight_controls

from radmpc.geometry import hull
from radmpc.model.dynamics import double_integrator, lqr_gain
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.referee.conditional.conditional import conditionals
from radmpc.referee.conditional.rows import Witnesses
from radmpc.referee.conditional.scales import Scale
from radmpc.referee.contact import solid_distances, solid_of
from sampling import IS_THOROUGH

MISSIONS = 20_000 if IS_THOROUGH else 5_000
"""The fewer show a mistake as well."""

STEPS = (2, 3)
"""At which missions are looked at."""


def crowded(
    dimension: int,
    avoidance: str,
    *,
    gain: bool = True,
    noise: float = 0.12,
    horizon: int = 4,
) -> Plan:
    """Return two vehicles that pass each other, a block and something that moves; all too close."""
    d = dimension
    system = double_integrator(1.0, d)
    feedback = lqr_gain(system, np.eye(2 * d), 2.0 * np.eye(d)) if gain else None
    fleet = []
    for i, (begin, end) in enumerate(
        [((0.0, 0.0, 0.0), (8.0, 0.0, 0.0)), ((8.0, 1.9, 0.3), (0.0, 1.9, 0.3))]
    ):
        fleet.append(
            Vehicle(
                name=f"v{i}",
                system=system,
                start=begin[:d],
                goal=Goal.at(end[:d], 0.5, 0.5),
                radius=0.5,
                control_limit=1e3,
                initial_covariance=[0.06**2] * d + [0.02**2] * d,
                disturbance_covariance=[noise**2] * d + [(0.5 * noise) ** 2] * d,
                gain=feedback,
            )
        )
    lower, upper = np.array([3.0, -2.0, -1.0]), np.array([4.5, -1.05, 1.0])
    moving = [
        np.array([x, y, z])[:d] + np.array([4.5 - 0.7 * k, 3.0, 0.0])[:d]
        for k in range(horizon + 1)
        for x in (0.0, 0.6)
        for y in (0.0, 0.6)
        for z in ((0.0,) if d == 2 else (-1.0, 1.0))
    ]
    per_step = len(moving) // (horizon + 1)
    outlines = [moving[k * per_step : (k + 1) * per_step] for k in range(horizon + 1)]
    scenario = Scenario(
        "crowded",
        1.0,
        horizon,
        0.05,
        tuple(fleet),
        (Obstacle.box("block", lower[:d], upper[:d]), Obstacle.moving("ferry", outlines)),
        avoidance=avoidance,
        workspace=Workspace(np.array([-1.2, -3.0, -1.4])[:d], np.array([9.2, 4.5, 1.6])[:d]),
    )
    return make_plan(scenario, [straight_controls(v, horizon) for v in fleet])


@dataclass(frozen=True)
class Missions:
    """Deviations of all missions.

    states : per vehicle (T+1, S, n), fresh : per vehicle (T, S, n), strays : how far obstacles are
    from where they are expected, (T+1, S, d) by number; seen : what feedback acts on, as states;
    empty where those are; scales : at each step what is known of the factor of covariances; empty
    where they are known
    """

    states: list[np.ndarray]
    fresh: list[np.ndarray]
    strays: dict[int, np.ndarray] = field(default_factory=dict)
    seen: list[np.ndarray] = field(default_factory=list)
    scales: list[Scale] = field(default_factory=list)


def flown(witnesses: Witnesses, count: int, seed: int) -> Missions:
    """Return missions in which feedback gets what it asks for."""
    rng = np.random.default_rng(seed)
    scenario = witnesses.plan.scenario
    states, fresh = [], []
    for vehicle in scenario.vehicles:
        n = vehicle.system.num_states
        A, B = vehicle.system.A, vehicle.system.B
        loop = A if vehicle.gain is None else A + B @ vehicle.gain
        path = [rng.multivariate_normal(np.zeros(n), vehicle.initial_covariance, count)]
        drawn = rng.multivariate_normal(
            np.zeros(n), vehicle.disturbance_covariance, (scenario.horizon, count)
        )
        for k in range(scenario.horizon):
            path.append(path[-1] @ loop.T + drawn[k])
        states.append(np.array(path))
        fresh.append(drawn)
    return Missions(states, fresh)


def row_failures(witnesses: Witnesses, missions: Missions) -> np.ndarray:
    """Return which half-spaces are left in which missions, (E, S)."""
    rows, parties = witnesses.halfspaces, witnesses.parties
    vehicles = witnesses.plan.scenario.vehicles
    failed = np.zeros((len(rows.windows), missions.states[0].shape[1]), dtype=bool)
    for e in range(len(rows.windows)):
        k, s, bend = int(rows.windows[e]), rows.shares[e], rows.bends[e]
        y = 0.0
        encounter = rows.encounters[e]
        involved = [(parties.first[encounter], 1.0)]
        if parties.causes[encounter] in {"pair", "range"}:
            involved.append((parties.other[encounter], -1.0))
        for i, sign in involved:
            vehicle, path = vehicles[i], missions.states[i]
            axes = list(vehicle.system.position)
            near = path[k][:, axes]
            y = y + sign * near
            if s:
                y = y + sign * s * (path[k + 1][:, axes] - near)
            if vehicle.gain is not None and vehicle.system.is_double_integrator:
                acted_on = missions.seen[i][k] if missions.seen else path[k]
                asked = acted_on @ vehicle.gain.T @ vehicle.system.B[axes].T
                y = y - sign * (s * (1.0 - s) + bend) * asked
        if parties.causes[encounter] == "obstacle" and parties.other[encounter] in missions.strays:
            stray = missions.strays[parties.other[encounter]]
            y = y - stray[k] - (s * (stray[k + 1] - stray[k]) if s else 0.0)
        failed[e] = y @ rows.normals[e] < -rows.margins[e]
    return failed


def integral_hits(witnesses: Witnesses, missions: Missions) -> np.ndarray:
    """Return which grown sets are entered in which missions, (E, S)."""
    rows, parties = witnesses.integrals, witnesses.parties
    vehicles = witnesses.plan.scenario.vehicles
    hit = np.zeros((len(rows.windows), missions.states[0].shape[1]), dtype=bool)
    for e in range(len(rows.windows)):
        encounter, k = rows.encounters[e], int(rows.windows[e])
        i = parties.first[encounter]
        place = rows.means[e] + missions.states[i][k][:, list(vehicles[i].system.position)]
        if parties.causes[encounter] == "pair":
            j = parties.other[encounter]
            place = place - missions.states[j][k][:, list(vehicles[j].system.position)]
            hit[e] = np.linalg.norm(place, axis=1) < rows.radii[e]
        else:
            place = (
                place - missions.strays.get(parties.other[encounter], np.zeros(k + 1)[:, None])[k]
            )
            solid = solid_of(hull(rows.vertices[e]))
            hit[e] = solid_distances(place, place, solid) < rows.radii[e]
    return hit


@dataclass(frozen=True)
class Course:
    """What one step's measurement makes of all that was charged, mission by mission.

    above, below : (S,) array
        Rows of the past as they came out, and rows to come, rounded up and down.
    total : (S,) array
        The conditional value of what is left.
    failed : (S,) bool array
        Whether any row of the past was left so far.
    """

    above: np.ndarray
    below: np.ndarray
    total: np.ndarray
    failed: np.ndarray


def course(witnesses: Witnesses, missions: Missions, step: int) -> Course:
    """Return the martingale and the value at a step."""
    nominal = witnesses.motion.states
    states = [nominal[i][step] + path[step] for i, path in enumerate(missions.states)]
    scale = missions.scales[step] if missions.scales else None
    found = conditionals(witnesses, step, states, scale)
    failed, hit = row_failures(witnesses, missions), integral_hits(witnesses, missions)
    rows, integrals = witnesses.halfspaces, witnesses.integrals
    known = rows.windows < step if witnesses.intervals else rows.windows <= step
    before = np.where((rows.before >= 0)[:, None], failed[rows.before], False)
    happened = failed & ~before
    over = (rows.before >= 0) & known[rows.before]
    left = np.where((~known & over)[:, None] & before, 0.0, 1.0)
    past = happened[known].sum(axis=0) + hit[integrals.windows <= step].sum(axis=0)
    coming = integrals.windows > step
    above = past + (left * found.halfspaces.above)[~known].sum(axis=0)
    below = past + (left * found.halfspaces.below)[~known].sum(axis=0)
    above = above + found.integrals.above[coming].sum(axis=0)
    below = below + found.integrals.below[coming].sum(axis=0)
    any_failed = failed[known].any(axis=0) | hit[integrals.windows <= step].any(axis=0)
    return Course(above, below, found.total, any_failed)


def check_martingale(
    witnesses: Witnesses, missions: Missions, steps: tuple[int, ...] = STEPS
) -> list[Course]:
    """Assert that on average nothing is made and nothing is lost; return how missions stand."""
    start = conditionals(witnesses, 0, None)
    above, below = (
        float(getattr(start.halfspaces, side).sum() + getattr(start.integrals, side).sum())
        for side in ("above", "below")
    )
    courses = []
    for step in steps:
        now = course(witnesses, missions, step)
        courses.append(now)
        error = 4.0 * now.above.std() / np.sqrt(len(now.above))
        assert now.above.mean() + error >= below, f"step {step}: {now.above.mean()} < {below}"
        assert now.below.mean() - error <= above, f"step {step}: {now.below.mean()} > {above}"
    return courses
