"""Samples as trails: drawn and tested as `radmpc.simulate` does, and remembered.

What is flown and what counts as a collision is the simulation's own exact geometry, which shares
nothing with the bounds of the certificate.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from scipy.special import betaincinv

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.geometry.polytope import Polytope
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.relations.keep import keep_pairs
from radmpc.model.scenario import Scenario, Workspace
from radmpc.records import dataclass, field
from radmpc.referee.simulation.flight import Chunk
from radmpc.referee.simulation.preparation import prepare
from radmpc.referee.simulation.watch import OBSTACLE, PAIR, RANGE, Watch
from radmpc.serving.protocol import Collision, Trail, TrailsView
from radmpc.serving.views.numbers import Rounding, extent_of
from radmpc.serving.work.control import Control

__all__ = ["trails_of"]

_AT_ONCE = 2000
"""Missions in the air together [-]."""

_MOST_TRAILS, _MOST_POINTS = 60, 60_000
"""Trails that are told, and points of all of them [-]: more would hide each other."""

_MOST_COLLIDING = 30
"""Of these, trails that collide [-]."""

_INSTANTS = np.linspace(0.0, 1.0, 33)
"""Where in a step a collision is looked for [steps]."""


@dataclass(frozen=True, slots=True)
class _Hit:
    """The first collision of a mission: in which window, of whom, with what."""

    window: int
    kind: int
    first: int
    other: int


@dataclass(slots=True, eq=False)
class _Remembered(Chunk):
    """Missions in the air whose paths and first collisions are kept."""

    window: int = 0
    states: list[Matrix] = field(default_factory=list)
    met: dict[int, _Hit] = field(default_factory=dict)

    def fly(self, rng: np.random.Generator) -> None:
        """Draw all missions step by step, keep them, and test each window."""
        horizon = self.flight.scenario.horizon
        intervals = self.flight.scenario.avoidance == "intervals"
        for k, here in enumerate(
            self.flight.sampler.draw(horizon, self.size, rng, self._hold_back)
        ):
            self.states.append(here.copy())
            if not intervals:
                self.window = k
                self._test(k, (k, k), (here, here))
            elif k > 0:
                self.window = k - 1
                self._test(k - 1, (k - 1, k), (self.states[-2], here))

    def mark(self, watch: Watch, rows: Indices, samples: Indices) -> None:
        """Note collisions; of each mission the first stays."""
        Chunk.mark(self, watch, rows, samples)
        for row, sample in zip(rows.tolist(), samples.tolist(), strict=True):
            kind, first = int(watch.kinds[row]), int(watch.first[row])
            hit = _Hit(self.window, kind, first, int(watch.other[row]))
            self.met.setdefault(sample, hit)

    def paths(self, sample: int) -> Tensor:
        """Return the places of all vehicles at the steps of a mission, (N, T+1, d) [m]."""
        rows = self.flight.position_rows
        strays = np.array([state[:, sample][rows] for state in self.states])
        return np.asarray(self.flight.motion.positions + strays.transpose(1, 0, 2))

    def strays(self, obstacle: int, sample: int) -> Matrix:
        """Return how far an obstacle is from where it is expected, (T+1, d) [m]."""
        starts, dimension = self.flight.sampler.track_starts, self.flight.scenario.dimension
        if not starts.size or starts[obstacle] < 0:
            return np.zeros((len(self.states), dimension))
        rows = starts[obstacle] + np.arange(dimension)
        return np.array([state[rows, sample] for state in self.states])


def trails_of(control: Control, plan: Plan, number: str, flights: int, seed: int) -> TrailsView:
    """Fly a plan many times.

    Parameters
    ----------
    control : Control
        Asked whether to end.
    plan : Plan
        With trajectories.
    number : str
        By which the page knows it.
    flights : int
        How often.
    seed : int
        Of the noise: the same seed, the same missions.

    Returns
    -------
    TrailsView
        Counts of all, trails of some.
    """
    flight = prepare(plan, everyone=True)
    rounding = Rounding.of(*extent_of(plan.scenario))
    points = plan.scenario.num_vehicles * (plan.scenario.horizon + 1)
    most = max(1, min(_MOST_TRAILS, _MOST_POINTS // points))
    size = max(1, min(_AT_ONCE, 4_000_000 // max(flight.sampler.width * points, 1) + 50))
    colliding: list[Trail] = []
    safe: list[Trail] = []
    flown, collisions = 0, 0
    seeds = np.random.SeedSequence(seed).spawn(math.ceil(flights / size))
    for one in seeds:
        if control.is_stopped():
            break
        chunk = _Remembered(flight, min(size, flights - flown))
        chunk.fly(np.random.default_rng(one))
        flown += chunk.size
        hits = np.flatnonzero(chunk.hits.any(axis=0)).tolist()
        collisions += len(hits)
        room = min(most, _MOST_COLLIDING) - len(colliding)
        colliding += [_trail(chunk, sample, rounding) for sample in hits[: max(room, 0)]]
        others = np.flatnonzero(~chunk.hits.any(axis=0))[: max(most - len(safe), 0)].tolist()
        safe += [_trail(chunk, sample, rounding) for sample in others]
    return {
        "plan": number,
        "flights": flown,
        "collisions": collisions,
        "interval": _interval(collisions, flown),
        "trails": [*colliding, *safe[: most - len(colliding)]],
    }


def _interval(collisions: int, flights: int) -> list[float]:
    """Return the two-sided 95 % Clopper-Pearson interval of a rate."""
    if flights == 0:
        return [0.0, 1.0]
    left = flights - collisions
    low = float(betaincinv(collisions, left + 1, 0.025)) if collisions else 0.0
    high = float(betaincinv(collisions + 1, left, 0.975)) if left else 1.0
    return [float(f"{low:.4g}"), float(f"{high:.4g}")]


def _trail(chunk: _Remembered, sample: int, rounding: Rounding) -> Trail:
    """Return one mission; without a collision if it has none."""
    paths = chunk.paths(sample)
    hit = chunk.met.get(sample)
    return {
        "paths": [rounding.points(path) for path in paths],
        "collision": None if hit is None else _collision(chunk, sample, paths, hit, rounding),
    }


def _collision(
    chunk: _Remembered, sample: int, paths: Tensor, hit: _Hit, rounding: Rounding
) -> Collision:
    """Return where and when a mission collides, and of whom with what."""
    scenario = chunk.flight.scenario
    names = [scenario.vehicles[hit.first].name]
    if hit.kind in {PAIR, RANGE}:
        names.append(scenario.vehicles[hit.other].name)
    elif hit.kind == OBSTACLE:
        names.append(scenario.obstacles[hit.other].name)
    # At steps both ends of a window are one.
    last = hit.window + (scenario.avoidance == "intervals")
    ends = (hit.window, last)
    ways = paths[:, ends]
    if hit.kind == OBSTACLE:
        # As seen from the obstacle: it stands where it is expected, and the vehicle is off.
        strays = chunk.strays(hit.other, sample)[list(ends)]
        share, at = _touch(scenario, ways[hit.first], strays, hit, last)
    elif hit.kind in {PAIR, RANGE}:
        share, at = _meeting(scenario, ways, hit)
    else:
        share, at = _exit(scenario.workspace, _between(ways[hit.first]))
    time = (hit.window + share * (last - hit.window)) * scenario.dt
    return {"at": rounding.point(at), "time": round(time, 3), "names": names}


def _between(ends: Matrix) -> Matrix:
    """Return places on the way from one end to the other, at `_INSTANTS`."""
    return np.asarray(ends[0] + _INSTANTS[:, None] * (ends[1] - ends[0]))


def _meeting(scenario: Scenario, ways: Tensor, hit: _Hit) -> tuple[float, Vector]:
    """Return when two touch, or lose their range, and where: on the hull, or where the first is."""
    ours, theirs = _between(ways[hit.first]), _between(ways[hit.other])
    apart = np.linalg.norm(ours - theirs, axis=1)
    radii = [scenario.vehicles[i].radius for i in (hit.first, hit.other)]
    if hit.kind == RANGE:
        names = [vehicle.name for vehicle in scenario.vehicles]
        pair = {hit.first, hit.other}
        within = next(r for i, j, r in keep_pairs(scenario.keep, names) if {i, j} == pair)
        when = _first(-apart, -within)
        return float(_INSTANTS[when]), ours[when]
    when = _first(apart, sum(radii))
    toward = radii[0] / sum(radii)
    return float(_INSTANTS[when]), ours[when] + toward * (theirs[when] - ours[when])


def _touch(
    scenario: Scenario, way: Matrix, strays: Matrix, hit: _Hit, last: int
) -> tuple[float, Vector]:
    """Return when a vehicle touches an obstacle, and where it then is."""
    obstacle, ours = scenario.obstacles[hit.other], _between(way)
    seen = ours - _between(strays)
    heights = [_heights(*ends, seen) for ends in _pieces(obstacle, hit.window, last)]
    when = _first(np.min(heights, axis=0), scenario.vehicles[hit.first].radius)
    return float(_INSTANTS[when]), ours[when]


def _pieces(obstacle: Obstacle, first: int, last: int) -> Iterator[tuple[Polytope, Polytope]]:
    """Yield convex pieces of an obstacle as they are at two steps."""
    return zip(obstacle.at(first), obstacle.at(last), strict=True)


def _heights(here: Polytope, there: Polytope, places: Matrix) -> Vector:
    """Return how far places are above the faces of what moves from here to there [m]."""
    if here.normals.shape != there.normals.shape or not np.allclose(here.normals, there.normals):
        # What turns or changes its shape is taken as it is at the nearer step.
        both = [(places @ p.normals.T - p.offsets).max(axis=1) for p in (here, there)]
        return np.asarray(np.where(_INSTANTS < 0.5, *both))
    offsets = _between(np.stack([here.offsets, there.offsets]))
    return np.asarray((places @ here.normals.T - offsets).max(axis=1))


def _exit(workspace: Workspace | None, ours: Matrix) -> tuple[float, Vector]:
    """Return when a center leaves the workspace, and where."""
    if workspace is None:
        return 0.0, ours[0]
    out = np.maximum(workspace.lower - ours, ours - workspace.upper).max(axis=1)
    when = _first(-out, 0.0)
    return float(_INSTANTS[when]), ours[when]


def _first(distances: Vector, reach: float) -> int:
    """Return the first instant at which a distance is within reach, else that of the least."""
    within = np.flatnonzero(distances <= reach)
    return int(within[0]) if within.size else int(distances.argmin())
