"""How often one flight goes wrong more than once: what Boole's inequality counts several times.

`simulate` stops looking at a flight once it has collided. Here every encounter (a pair, a vehicle
and an obstacle, a vehicle and the workspace) is tested in every window (a step or an interval) of
every flight, with the referee's own geometry.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Indices, Matrix
from radmpc.model.plan import Plan
from radmpc.referee.collisions import Flags, leaves_workspace, meets_origin, meets_solid
from radmpc.referee.flight import Flight, prepare
from radmpc.referee.watch import OBSTACLE, PAIR, WORKSPACE

__all__ = ["Overlap", "measure_overlap"]

_CHUNK = 4_000


@dataclass(frozen=True, slots=True)
class Overlap:
    """Counts over flights; each is at least the one before it.

    Attributes
    ----------
    samples : int
        Flights.
    joint : int
        Flights in which anything goes wrong.
    encounters : int
        Encounters that go wrong, each at most once per flight.
    events : int
        Encounters that go wrong, once per window: what Boole's inequality adds up.
    """

    samples: int
    joint: int
    encounters: int
    events: int


def measure_overlap(plan: Plan, samples: int, seed: int) -> Overlap:
    """Fly a plan and count what goes wrong, with its repetitions.

    Parameters
    ----------
    plan : Plan
        Judged by its scenario and controls.
    samples : int
        Flights.
    seed : int
        Of this measurement alone.

    Returns
    -------
    Overlap
        The counts.
    """
    flight = prepare(plan)
    rng = np.random.default_rng(seed)
    sizes = [_CHUNK] * (samples // _CHUNK) + [samples % _CHUNK] * (samples % _CHUNK > 0)
    counts = np.sum([_count(flight, size, rng) for size in sizes], axis=0)
    return Overlap(samples, *(int(count) for count in counts))


def _count(flight: Flight, size: int, rng: np.random.Generator) -> tuple[int, int, int]:
    """Return flights, encounters and events that go wrong in a chunk."""
    lag = 1 if flight.scenario.avoidance == "intervals" else 0
    hit: dict[tuple[int, int, int], Flags] = {}
    events = 0
    before = np.empty(0)
    for k, here in enumerate(flight.sampler.draw(flight.scenario.horizon, size, rng)):
        if k >= lag:
            found = _window(flight, k - lag, k, (before if lag else here, here))
            events += sum(int(flags.sum()) for flags in found.values())
            for key, flags in found.items():
                hit[key] = hit[key] | flags if key in hit else flags
        before = here.copy()
    if not hit:
        return 0, 0, 0
    table = np.stack(list(hit.values()))
    return int(table.any(axis=0).sum()), int(table.sum()), events


def _window(
    flight: Flight, window: int, step: int, states: tuple[Matrix, Matrix]
) -> dict[tuple[int, int, int], Flags]:
    """Return which flights each encounter goes wrong in, in one window."""
    watch, projection = flight.watches[window], flight.projections[window]
    found: dict[tuple[int, int, int], Flags] = {}
    if not watch.kinds.size:
        return found
    leaves = projection @ states[0] < -watch.margins[:, :1]
    leaves |= projection @ states[1] < -watch.margins[:, -1:]
    for row in np.flatnonzero(leaves.any(axis=1)).tolist():
        sample = np.flatnonzero(leaves[row])
        begin = _places(flight, window, row, sample, (window, states[0]))
        end = _places(flight, window, row, sample, (step, states[1]))
        key = (int(watch.kinds[row]), int(watch.first[row]), int(watch.other[row]))
        flags = found.setdefault(key, np.zeros(states[1].shape[1], dtype=bool))
        flags[sample[_meets(flight, window, row, begin, end)]] = True
    return found


def _meets(flight: Flight, window: int, row: int, begin: Matrix, end: Matrix) -> Flags:
    """Return which of some paths of one row go wrong."""
    watch, scenario = flight.watches[window], flight.scenario
    bows = np.broadcast_to(watch.bows[row], begin.shape)
    reaches = np.full(len(begin), watch.reaches[row])
    kind = watch.kinds[row]
    if kind == PAIR:
        return meets_origin(begin, end, bows, reaches)
    if kind == OBSTACLE:
        obstacle, piece = int(watch.other[row]), int(watch.piece[row])
        moving = scenario.obstacles[obstacle].is_moving
        return meets_solid(
            begin, end, bows, reaches, flight.parts[obstacle, piece, window if moving else -1]
        )
    if kind != WORKSPACE or scenario.workspace is None:
        raise ValueError(f"unknown kind of encounter {kind}")
    return leaves_workspace(begin, end, bows, scenario.workspace)


def _places(
    flight: Flight, window: int, row: int, sample: Indices, when: tuple[int, Matrix]
) -> Matrix:
    """Return the (relative) positions of one row in some flights, (M, d)."""
    watch, (step, state) = flight.watches[window], when

    def of(vehicle: int) -> Matrix:
        rows = flight.position_rows[vehicle]
        return np.asarray(flight.motion.positions[vehicle, step] + state[rows][:, sample].T)

    places = of(int(watch.first[row]))
    return places - of(int(watch.other[row])) if watch.kinds[row] == PAIR else places
