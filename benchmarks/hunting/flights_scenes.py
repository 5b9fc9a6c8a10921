"""Small random scenes to be flown, from a seed and an index: every feature of the format is drawn.

Half a dozen of them meet in one scene: noise that lasts, is shared, estimated or known up to a
factor, visits and windows, ranges, obstacles that stray or concern some vehicles only, limits of
norms, currents, goals to choose from. Unlike those of `hunting/scenes.py` most can be planned.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from hunting.flight import solid_distances
from hunting.flights_noise import noisy_vehicles
from hunting.obstacles import random_obstacle
from hunting.scenes import draw_scene
from hunting.vehicles import random_vehicle
from radmpc.arrays import Matrix, Vector
from radmpc.errors import ScenarioError
from radmpc.geometry import hull
from radmpc.model.obstacle import Obstacle
from radmpc.model.relations.concerns import all_but, only_for
from radmpc.model.relations.keep import Keep
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.model.visits import Visit

__all__ = ["draw_flown_scene"]

_MAX_DRAWS = 500
_NASTY = 0.15
"""Share of scenes whose starts, goals and vehicles are those of `hunting/scenes.py`."""

Rng = np.random.Generator


def draw_flown_scene(seed: int, index: int) -> Scenario:
    """Return a scene.

    Parameters
    ----------
    seed, index : int
        Decide everything.

    Returns
    -------
    Scenario
        1 to 6 vehicles over 1 to 10 steps, in the plane or, one time in four, in space.
    """
    rng = np.random.default_rng([seed, index, 7])
    for attempt in range(_MAX_DRAWS):
        try:
            if rng.random() < _NASTY:
                base = replace(draw_scene(seed, index * _MAX_DRAWS + attempt), name="nasty")
            else:
                base = _base(rng)
            made = _with_features(rng, base)
            return replace(made, name=f"flown-{seed}-{index}-{base.name}")
        except ScenarioError:
            continue  # what the door refuses is drawn again
    raise ScenarioError(f"seed {seed} and index {index} give no scene in {_MAX_DRAWS} draws")


def _base(rng: Rng) -> Scenario:
    """Return vehicles with ways that mostly cross, and obstacles beside them."""
    d = 3 if rng.random() < 0.25 else 2
    count = int(rng.choice([1, 2, 3, 6], p=[0.35, 0.4, 0.17, 0.08]))
    horizon = int(
        rng.choice([1, 2, 3, 4, 5, 6, 8, 10], p=[0.1, 0.1, 0.15, 0.2, 0.2, 0.15, 0.06, 0.04])
    )
    dt = float(rng.choice([0.5, 1.0, 1.3]))
    radii = rng.uniform(0.15, 0.5, count)
    side = 1.0 + 1.2 * count
    starts, goals = (_apart(rng, radii, side, d) for _ in range(2))
    vehicles = tuple(
        random_vehicle(
            rng, f"v{i}", (starts[i], goals[i]), float(radii[i]), (dt, horizon), is_close=False
        )
        for i in range(count)
    )
    bound = float(rng.choice([1e-6, 1e-3, 0.01, 0.05, 0.1, 0.2, 0.4]))
    obstacles = []
    for i in range(int(rng.choice([0, 1, 2], p=[0.35, 0.45, 0.2]))):
        chosen = int(rng.integers(count))
        place = starts[chosen] + rng.uniform(0.2, 0.8) * (goals[chosen] - starts[chosen])
        made = _random_obstacle(rng, f"o{i}", place + rng.normal(0.0, 0.8, d), (dt, horizon))
        if all(
            np.all(solid_distances(piece, places) > radii)
            for places, step in ((starts, 0), (goals, horizon))
            for piece in made.laid_out(dt, horizon).at(step)
        ):
            obstacles.append(made)
    return Scenario(
        "made", dt, horizon, bound, vehicles, tuple(obstacles),
        avoidance="steps" if rng.random() < 0.35 else "intervals",
    )  # fmt: skip


def _apart(rng: Rng, radii: Vector, side: float, d: int) -> Matrix:
    """Return places whose hulls do not meet."""
    for _ in range(_MAX_DRAWS):
        places = rng.uniform(0.0, side, (len(radii), d))
        gaps = np.linalg.norm(places[:, None] - places, axis=2) - radii[:, None] - radii
        if np.all(gaps[np.triu_indices(len(radii), 1)] > rng.uniform(0.05, 0.6)):
            return np.asarray(places)
    raise ScenarioError("no room")


def _random_obstacle(rng: Rng, name: str, place: Vector, times: tuple[float, int]) -> Obstacle:
    """Return an obstacle of any kind, one in three on a track, known or not."""
    dt, horizon = times
    if rng.random() < 0.65:
        return random_obstacle(rng, name, place, horizon)
    d = place.size
    outline = hull(rng.normal(0.0, 0.3, (d + 2, d))).vertices
    speed = rng.normal(0.0, 0.3, d)
    begin = np.concatenate([place - speed * dt * horizon * rng.uniform(0.0, 1.0), speed])
    if rng.random() < 0.3:
        return Obstacle.tracked(name, outline, begin)
    sizes = np.repeat([rng.choice([0.0, 0.02, 0.1]), rng.choice([0.0, 0.01, 0.05])], d) ** 2
    grows = np.repeat([rng.choice([0.0, 0.02]), rng.choice([0.0, 0.01, 0.05])], d) ** 2
    return Obstacle.tracked(name, outline, begin, sizes, grows)


def _with_features(rng: Rng, base: Scenario) -> Scenario:
    """Return a scene with some of what the format has beside obstacles and vehicles."""
    vehicles = noisy_vehicles(rng, base)
    windows: list[Callable[[Rng, Vehicle, Scenario], Vehicle]] = [_with_norms]
    if rng.random() < 0.3:
        windows.append(_with_visits)
    if rng.random() < 0.25:
        windows.append(_with_arrival)
    for change in windows:
        vehicles = tuple(change(rng, v, base) if rng.random() < 0.5 else v for v in vehicles)
    names = [v.name for v in vehicles]
    places = np.array([v.start_position for v in vehicles])
    ends = np.array([v.goal.center for v in vehicles])
    made = replace(
        base,
        vehicles=vehicles,
        obstacles=tuple(_concerning(rng, o, names) for o in base.obstacles),
        covariance_samples=int(rng.choice([3, 4, 8, 30, 1000])) if rng.random() < 0.2 else None,
        time_weight=float(rng.choice([0.0, 0.1, 3.0])),
        keep=_kept(rng, names, (places, ends)) if rng.random() < 0.25 else (),
        goals=_choices(rng, vehicles) if rng.random() < 0.15 else (),
    )
    if made.workspace is None and rng.random() < 0.25:
        margin = float(rng.choice([0.3, 1.0, 3.0]))
        box = Workspace(
            np.minimum(places, ends).min(axis=0) - margin,
            np.maximum(places, ends).max(axis=0) + margin,
        )
        made = replace(made, workspace=box)
    return made


def _with_norms(rng: Rng, vehicle: Vehicle, base: Scenario) -> Vehicle:
    """Return a vehicle with limits of norms, now and then."""
    del base
    if rng.random() < 0.6:
        return vehicle
    norm = float(vehicle.control_limit.max() * rng.uniform(1.0, 1.5))
    vehicle = replace(vehicle, control_norm=norm)
    if vehicle.speed_limit is None or rng.random() < 0.5:
        return vehicle
    return replace(vehicle, speed_norm=float(vehicle.speed_limit.max() * rng.uniform(1.0, 1.5)))


def _with_visits(rng: Rng, vehicle: Vehicle, base: Scenario) -> Vehicle:
    """Return a vehicle with one or two visits on its way, some in windows."""
    last = base.horizon
    if last < 3:
        return vehicle
    begin, end = vehicle.start_position, vehicle.goal.center
    made = []
    for share in sorted(rng.uniform(0.2, 0.8, int(rng.integers(1, 3)))):
        place = begin + share * (end - begin) + rng.normal(0.0, 0.2, begin.size)
        window = None
        if rng.random() < 0.5:
            first = int(np.clip(round(share * last) - 1, 1, last))
            window = (first, int(rng.integers(first, last + 1)))
        speed = 1.0 if vehicle.system.velocity is not None and rng.random() < 0.3 else None
        made.append(Visit.at(place, float(rng.choice([0.1, 0.4])), window, speed))
    return replace(vehicle, via=tuple(made))


def _with_arrival(rng: Rng, vehicle: Vehicle, base: Scenario) -> Vehicle:
    """Return a vehicle that may arrive sooner."""
    first = int(rng.integers(1, base.horizon + 1))
    window = (first, int(rng.integers(first, base.horizon + 1)))
    return replace(vehicle, goal=replace(vehicle.goal, within=window))


def _concerning(rng: Rng, obstacle: Obstacle, names: list[str]) -> Obstacle:
    """Return an obstacle that may concern some vehicles only."""
    if rng.random() < 0.75:
        return obstacle
    some = [names[i] for i in rng.permutation(len(names))[: int(rng.integers(1, len(names) + 1))]]
    return only_for(obstacle, some) if rng.random() < 0.5 else all_but(obstacle, some)


def _kept(rng: Rng, names: list[str], ways: tuple[Matrix, Matrix]) -> tuple[Keep, ...]:
    """Return a range or two, wide enough for starts and goals."""
    made: dict[tuple[str, str], Keep] = {}
    for _ in range(int(rng.integers(1, 3)) if len(names) > 1 else 0):
        i, j = sorted(int(k) for k in rng.permutation(len(names))[:2])
        reach = max(float(np.linalg.norm(w[i] - w[j])) for w in ways)
        reach = reach * rng.uniform(1.05, 1.6) + rng.uniform(0.0, 0.6)
        made[names[i], names[j]] = Keep([names[i], names[j]], float(reach))
    return tuple(made.values())


def _choices(rng: Rng, vehicles: tuple[Vehicle, ...]) -> tuple[Goal, ...]:
    """Return the goals to choose from: those that vehicles have, and maybe one more."""
    goals = [v.goal for v in vehicles]
    if rng.random() < 0.4:
        away = rng.normal(0.0, 1.0, goals[0].lower.size)
        goals.append(replace(goals[0], lower=goals[0].lower + away, upper=goals[0].upper + away))
    return tuple(goals)
