"""Samples as trails: drawn and tested as `radmpc.simulate` does, and remembered.

What is flown and what counts as a collision is the simulation's own exact geometry, which shares
nothing with the bounds of the certificate.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import betaincinv

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.model.plan import Plan
from radmpc.records import dataclass, field
from radmpc.referee.simulation.flight import Chunk, SampledFleet
from radmpc.referee.simulation.preparation import prepare
from radmpc.referee.simulation.watch import OBSTACLE, PAIR, Watch
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
        "collision": None if hit is None else _collision(chunk.flight, paths, hit, rounding),
    }


def _collision(flight: SampledFleet, paths: Tensor, hit: _Hit, rounding: Rounding) -> Collision:
    """Return where and when a mission collides, and of whom with what."""
    scenario = flight.scenario
    vehicle = scenario.vehicles[hit.first]
    share, at = 0.0, paths[hit.first, hit.window]
    if scenario.avoidance == "intervals":
        ways = paths[:, hit.window : hit.window + 2]
        share, at = _contact(flight, ways, hit)
    names = [vehicle.name]
    if hit.kind == PAIR:
        names.append(scenario.vehicles[hit.other].name)
    elif hit.kind == OBSTACLE:
        names.append(scenario.obstacles[hit.other].name)
    time = (hit.window + share) * scenario.dt
    return {"at": rounding.point(at), "time": round(time, 3), "names": names}


def _contact(flight: SampledFleet, ways: Tensor, hit: _Hit) -> tuple[float, Vector]:
    """Return the share of a window at which something is touched, and where a vehicle then is."""
    scenario = flight.scenario

    def places(i: int) -> Matrix:
        begin, end = ways[i]
        return np.asarray(begin + _INSTANTS[:, None] * (end - begin))

    ours = places(hit.first)
    radius = scenario.vehicles[hit.first].radius
    if hit.kind == PAIR:
        theirs = places(hit.other)
        reach = radius + scenario.vehicles[hit.other].radius
        apart = np.linalg.norm(ours - theirs, axis=1)
        when = _first(apart, reach)
        toward = radius / reach
        return float(_INSTANTS[when]), ours[when] + toward * (theirs[when] - ours[when])
    if hit.kind == OBSTACLE:
        obstacle = scenario.obstacles[hit.other]
        pieces = obstacle.at(hit.window)
        heights = [(ours @ p.normals.T - p.offsets).max(axis=1) for p in pieces]
        when = _first(np.min(heights, axis=0), radius)
        return float(_INSTANTS[when]), ours[when]
    workspace = scenario.workspace
    if workspace is None:
        return 0.0, ours[0]
    out = np.maximum(workspace.lower - ours, ours - workspace.upper).max(axis=1)
    when = _first(-out, 0.0)
    return float(_INSTANTS[when]), ours[when]


def _first(distances: Vector, reach: float) -> int:
    """Return the first instant at which a distance is within reach, else that of the least."""
    within = np.flatnonzero(distances <= reach)
    return int(within[0]) if within.size else int(distances.argmin())
