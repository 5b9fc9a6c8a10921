"""Missions in gusts that last and that vehicles share: many at once, what is known by brute force.

Everything that was added to states is stacked, with all that lasts of the step that follows, and
the one is conditioned on the other: no filter, and no step is taken from the one before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from conditional_missions import Missions
from noisy_missions import ObservedMissions
from physical_scenes import DI, craft, pd, still, wall

from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.plan import Plan
from radmpc.model.vehicle import Vehicle
from radmpc.referee.conditional.rows import Witnesses

GUST = np.vstack([0.5 * np.eye(2), np.eye(2)])
TURNED = GUST @ np.array([[0.6, 0.8], [-0.8, 0.6]])
SWELL = np.array([[0.3], [0.6], [0.0], [1.0]])


def wind(rho: float = 0.9, matrix: np.ndarray = GUST) -> SharedDisturbance:
    return SharedDisturbance("wind", matrix, [[0.02, 0.005], [0.005, 0.03]], rho)


def swell(rho: float = 0.0) -> SharedDisturbance:
    return SharedDisturbance("swell", SWELL, 0.01, rho)


def shaken(vehicle: Vehicle, noise: float) -> Vehicle:
    """Return a vehicle with so much noise of its own, along positions and velocities."""
    own = noise**2 * np.diag([0.5, 0.4, 1.0, 0.8])
    return replace(vehicle, disturbance_covariance=own)


def side_by_side(kind: str, *changes: dict[str, object], noise: float = 0.05) -> Plan:
    """Return two that hover side by side, one at a wall, and one that meets nothing of theirs."""
    a = shaken(craft("a", DI, [0, 0], gain=pd(0.3, 0.9)), noise)
    b = shaken(craft("b", DI, [-1.7, 0.2]), 0.5 * noise)
    fleet = [replace(v, **more) for v, more in zip((a, b), changes, strict=True)]
    alone = craft("c", DI, [0.2, -1.9], noise=2.0 * noise)
    alone = replace(alone, disturbance_correlation=0.4)
    return still(*fleet, alone, horizon=4, avoidance=kind, obstacles=(wall(1.0),))


def lasting(kind: str) -> Plan:
    """One wind that lasts, and noise of one's own that does not."""
    return side_by_side(
        kind, {"shared": (wind(),)}, {"shared": (wind(matrix=-0.7 * TURNED), swell(0.0))}
    )


def all_lasting(kind: str) -> Plan:
    """Two sources, one of each kind, and noise of one's own that lasts, too."""
    return side_by_side(
        kind,
        {"shared": (swell(0.6), wind()), "disturbance_correlation": 0.7},
        {"shared": (wind(matrix=-0.7 * TURNED), swell(0.6)), "disturbance_correlation": 0.5},
    )


def own_lasting(kind: str) -> Plan:
    """A wind that is new at every step, and noise of one's own that lasts."""
    return side_by_side(
        kind,
        {"shared": (wind(0.0),), "disturbance_correlation": 0.8},
        {"shared": (wind(0.0, -TURNED),)},
    )


def singular(kind: str) -> Plan:
    """Nothing but one wind, which two see exactly."""
    nothing = {"disturbance_covariance": np.zeros((4, 4)), "shared": (wind(),)}
    return side_by_side(kind, nothing, {**nothing, "shared": (wind(matrix=-0.7 * TURNED),)})


def seen_by_another(kind: str) -> Plan:
    """One that is shaken so much that it sees nothing of the wind, at a wall; another sees it."""
    blind = shaken(craft("a", DI, [0, 0]), 0.3)
    quiet = shaken(craft("b", DI, [-50.0, 0.2]), 0.01)
    fleet = (replace(v, shared=(wind(0.95),)) for v in (blind, quiet))
    return still(*fleet, horizon=4, avoidance=kind, obstacles=(wall(1.7),))


def blind(kind: str) -> Plan:
    """Two that see little of the wind that blows them at each other."""
    fleet = [
        replace(shaken(craft(name, DI, place, radius=3.0), 0.12), shared=(wind(0.95, matrix),))
        for name, place, matrix in (("a", [0, 0], GUST), ("b", [-8.5, 0.2], -0.7 * GUST))
    ]
    return still(*fleet, horizon=4, avoidance=kind)


SCENES = {
    "blind": blind,
    "lasting": lasting,
    "all lasting": all_lasting,
    "own lasting": own_lasting,
    "singular": singular,
}


def lags(rho: float, count: int, covariance: np.ndarray) -> np.ndarray:
    """Return the covariance of so many values in a row, stacked."""
    apart = np.abs(np.subtract.outer(np.arange(count), np.arange(count)))
    return np.kron(rho**apart if rho else np.eye(count), covariance)


def sources_of(fleet: Sequence[Vehicle]) -> list[tuple[np.ndarray, float, np.ndarray]]:
    """Return every source: what it adds to all states, its correlation and its covariance."""
    sizes = [v.start.size for v in fleet]
    ends = np.cumsum([0, *sizes])
    found = []
    for i, v in enumerate(fleet):
        acts = np.zeros((ends[-1], sizes[i]))
        acts[ends[i] : ends[i + 1]] = np.eye(sizes[i])
        found.append((acts, v.disturbance_correlation, v.disturbance_covariance))
    for name in sorted({part.name for v in fleet for part in v.shared}):
        parts = {i: part for i, v in enumerate(fleet) for part in v.shared if part.name == name}
        one = next(iter(parts.values()))
        acts = np.zeros((ends[-1], one.size))
        for i, part in parts.items():
            acts[ends[i] : ends[i + 1]] = part.matrix
        found.append((acts, one.correlation, one.covariance))
    return found


def conditioned(fleet: Sequence[Vehicle], step: int) -> tuple[np.ndarray, np.ndarray]:
    """Return what is added over a step, source by source, given what was added over all before.

    Returns
    -------
    (q, p step) and (q, q) array
        What its mean takes from all that was added, stacked; and its covariance.
    """
    sources = sources_of(fleet)
    q = sum(len(cov) for _, _, cov in sources)
    p = len(sources[0][0])
    total, crossed, own = np.zeros((p * step, p * step)), np.zeros((q, p * step)), np.zeros((q, q))
    row = 0
    for acts, rho, covariance in sources:
        mine = slice(row, row + len(covariance))
        row = mine.stop
        own[mine, mine] = covariance
        all_acts = np.kron(np.eye(step), acts)
        total += all_acts @ lags(rho, step, covariance) @ all_acts.T
        apart = step - np.arange(step)
        blocks = [(rho**j if rho else 0.0) * covariance @ acts.T for j in apart]
        crossed[mine] = np.hstack(blocks) if step else np.zeros((len(covariance), 0))
    takes = crossed @ np.linalg.pinv(total, 1e-10, hermitian=True)
    return takes, own - takes @ crossed.T


def known_of(fleet: Sequence[Vehicle], added: np.ndarray) -> list[np.ndarray]:
    """Return what is expected of own disturbances and shared ones that last, (S, n + s) each.

    Parameters
    ----------
    fleet : sequence of Vehicle
        All of it.
    added : (k, S, p) array
        What was added to all states, stacked, over each step until now.
    """
    step, count = len(added), added.shape[1]
    takes, _ = conditioned(fleet, step)
    means = added.transpose(1, 0, 2).reshape(count, -1) @ takes.T
    return [means[:, rows] for rows in rows_of(fleet)]


def rows_of(fleet: Sequence[Vehicle]) -> list[np.ndarray]:
    """Return where among the sources those of each vehicle that are *known* stand."""
    names = sorted({part.name for v in fleet for part in v.shared})
    sizes = {part.name: part.size for v in fleet for part in v.shared}
    ends = np.cumsum([0, *(v.start.size for v in fleet), *(sizes[name] for name in names)])
    found = []
    for i, v in enumerate(fleet):
        rows = [np.arange(ends[i], ends[i + 1])]
        for part in v.shared:
            if part.correlation > 0.0:
                start = ends[len(fleet) + names.index(part.name)]
                rows.append(np.arange(start, start + part.size))
        found.append(np.concatenate(rows))
    return found


def remembers(vehicle: Vehicle) -> bool:
    lasting_shared = any(part.correlation > 0.0 for part in vehicle.shared)
    return vehicle.disturbance_correlation > 0.0 or lasting_shared


def flown_gustily(
    witnesses: Witnesses, count: int, seed: int, *, alone: bool = False
) -> ObservedMissions:
    """Return missions in which feedback gets what it asks for.

    Where vehicles are `alone` each knows what its own measurements tell, and no more.
    """
    rng = np.random.default_rng(seed)
    scenario = witnesses.plan.scenario
    fleet, horizon = scenario.vehicles, scenario.horizon
    added = drawn(fleet, horizon, count, rng)
    states: list[list[np.ndarray]] = [[] for _ in fleet]
    ends = np.cumsum([0, *(v.start.size for v in fleet)])
    for i, v in enumerate(fleet):
        now = rng.multivariate_normal(np.zeros(v.start.size), v.initial_covariance, count)
        states[i].append(now)
        loop = v.system.A if v.gain is None else v.system.A + v.system.B @ v.gain
        for k in range(horizon):
            now = now @ loop.T + added[k][:, ends[i] : ends[i + 1]]
            states[i].append(now)
    known: list[list[np.ndarray]] = [[] for _ in fleet]
    for k in range(horizon + 1):
        told = known_of(fleet, added[:k])
        if alone:
            told = [
                known_of([v], added[:k, :, ends[i] : ends[i + 1]])[0] for i, v in enumerate(fleet)
            ]
        for i, v in enumerate(fleet):
            place = witnesses.motion.states[i][k] + states[i][k]
            rest = told[i] if remembers(v) else told[i][:, :0]
            known[i].append(np.hstack([place, rest]))
    paths = [np.array(path) for path in states]
    return ObservedMissions(Missions(paths, []), known)  # type: ignore[arg-type] # a list of arrays will do


def drawn(fleet: Sequence[Vehicle], horizon: int, count: int, rng) -> np.ndarray:
    """Return what is added to all states over every step, (T, S, p)."""
    total = 0.0
    for acts, rho, covariance in sources_of(fleet):
        zero = np.zeros(len(covariance))
        now = rng.multivariate_normal(zero, covariance, count)
        path = [now]
        for _ in range(horizon - 1):
            fresh = rng.multivariate_normal(zero, covariance, count)
            now = rho * now + np.sqrt(1.0 - rho**2) * fresh
            path.append(now)
        total = total + np.array(path) @ acts.T
    return np.asarray(total)
