"""How often one flight goes wrong more than once: what Boole's inequality counts several times.

`simulate` stops looking at a flight once it has collided. Here every encounter (a pair, a vehicle
and an obstacle, a vehicle and the workspace) is tested in every window (a step or an interval) of
every flight, with the referee's own geometry.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Indices
from radmpc.model.plan import Plan
from radmpc.referee.simulation.collisions import Flags
from radmpc.referee.simulation.flight import Chunk, SampledFleet
from radmpc.referee.simulation.preparation import prepare
from radmpc.referee.simulation.watch import Watch

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


class _Counting(Chunk):
    """Flights that go on after a collision: every encounter is tested in every window."""

    def __init__(self, flight: SampledFleet, size: int) -> None:
        super().__init__(flight, size)
        self.events = 0
        self.encounters: dict[tuple[int, int, int], Flags] = {}

    def is_open(self, kinds: Indices, samples: Indices) -> Flags:
        """Return that all are to be tested."""
        del samples
        return np.ones(kinds.shape, dtype=bool)

    def mark(self, watch: Watch, rows: Indices, samples: Indices) -> None:
        """Count encounters once per window, whichever piece of an obstacle is met."""
        super().mark(watch, rows, samples)
        keys = np.column_stack([watch.kinds[rows], watch.first[rows], watch.other[rows]])
        for key in np.unique(keys, axis=0):
            flags = np.zeros(self.size, dtype=bool)
            flags[samples[(keys == key).all(axis=1)]] = True
            name = (int(key[0]), int(key[1]), int(key[2]))
            self.events += int(flags.sum())
            known = self.encounters.get(name)
            self.encounters[name] = flags if known is None else known | flags


def _count(flight: SampledFleet, size: int, rng: np.random.Generator) -> tuple[int, int, int]:
    """Return flights, encounters and events that go wrong in a chunk."""
    chunk = _Counting(flight, size)
    chunk.fly(rng)
    joint = int(chunk.hits.any(axis=0).sum())
    return joint, sum(int(flags.sum()) for flags in chunk.encounters.values()), chunk.events
