"""Who has to be watched when: everything whose half-space bound is not negligible."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.model.scenario import Scenario
from radmpc.referee.encounters import Encounters, window_risks
from radmpc.referee.gather import gather_obstacles, gather_pairs
from radmpc.referee.motion import FleetMotion
from radmpc.referee.neighbors import CUTOFF_RISK
from radmpc.referee.sweep import SweepPart, resting, swept
from radmpc.referee.workspace import workspace_risks

__all__ = ["WATCH_RISK", "PairWatch", "SolidWatch", "Window", "watch_list"]

# Encounters below this risk are not simulated: a million samples would not show them.
WATCH_RISK = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class PairWatch:
    """Pairs that may meet in one window.

    Attributes
    ----------
    first, second : (P,) int array
        Vehicles.
    reaches : (P,) array
        Sum of the radii [m].
    bows : (P, d) array
        Bow of the relative mean curve [m].
    """

    first: Indices
    second: Indices
    reaches: Vector
    bows: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class SolidWatch:
    """Vehicles that may touch one convex piece in one window.

    Attributes
    ----------
    vehicles : (M,) int array
        Who.
    reaches : (M,) array
        Their radii [m].
    bows : (M, d) array
        Bows of their mean curves [m].
    parts : tuple of SweepPart
        The piece.
    """

    vehicles: Indices
    reaches: Vector
    bows: Matrix
    parts: tuple[SweepPart, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Window:
    """What to watch at one step, or during one interval.

    Attributes
    ----------
    pairs : PairWatch
        Possibly empty.
    solids : tuple of SolidWatch
        One per piece.
    leavers : (M,) int array
        Vehicles that may leave the workspace.
    leaver_bows : (M, d) array
        Bows of their mean curves [m].
    """

    pairs: PairWatch
    solids: tuple[SolidWatch, ...]
    leavers: Indices
    leaver_bows: Matrix


def watch_list(scenario: Scenario, motion: FleetMotion) -> tuple[tuple[Window, ...], float]:
    """Return what to watch in each window, and a bound on what is not watched.

    Returns
    -------
    windows : tuple of Window
        T+1 steps, or T intervals.
    overlooked : float
        Upper bound on the probability of a collision among all that is left out [-].
    """
    intervals = scenario.avoidance == "intervals"
    num_windows = scenario.horizon + (0 if intervals else 1)
    watched: list[tuple[bool, Encounters, Vector]] = []
    overlooked = 0.0
    for is_pair, gather in ((True, gather_pairs), (False, gather_obstacles)):
        found = gather(scenario, motion, intervals=intervals)
        ends = 2 if intervals else 1
        overlooked += float(found.skipped.sum()) * num_windows * ends * CUTOFF_RISK
        for batch in found.batches:
            risks = window_risks(batch, intervals=intervals)
            overlooked += float(risks[risks < WATCH_RISK].sum())
            watched.append((is_pair, batch, risks))
    leaving, unseen = _leaving(scenario, motion, num_windows, intervals=intervals)
    cache: dict[tuple[int, int, int], tuple[SweepPart, ...]] = {}
    windows = []
    for k in range(num_windows):
        leavers = np.flatnonzero(leaving[:, k])
        bows = _bows_at(motion.bows, leavers, k, intervals=intervals)
        pairs, solids = _empty_pairs(scenario.dimension), []
        for is_pair, batch, risks in watched:
            near = np.flatnonzero(risks[:, k] >= WATCH_RISK)
            if is_pair and near.size:
                pairs = PairWatch(
                    batch.first[near],
                    batch.other[near],
                    batch.radii[near],
                    _bows_at(batch.bows, near, k, intervals=intervals),
                )
            elif near.size:
                solids += _solids(scenario, batch, near, k, cache)
        windows.append(Window(pairs, tuple(solids), leavers, bows))
    return tuple(windows), overlooked + unseen


def _empty_pairs(dimension: int) -> PairWatch:
    """Return a watch over nobody."""
    none = np.zeros(0, dtype=np.int64)
    return PairWatch(none, none, np.zeros(0), np.zeros((0, dimension)))


def _bows_at(bows: Vector, chosen: Indices, window: int, *, intervals: bool) -> Matrix:
    """Return the bows during a window; a step has none."""
    if intervals:
        return np.asarray(bows[chosen, window])
    return np.zeros((len(chosen), bows.shape[2]))


def _leaving(
    scenario: Scenario, motion: FleetMotion, num_windows: int, *, intervals: bool
) -> tuple[Vector, float]:
    """Return whether each vehicle may leave the workspace in each window, and what is ignored."""
    if scenario.workspace is None:
        return np.zeros((scenario.num_vehicles, num_windows)), 0.0
    risks = workspace_risks(scenario.workspace, motion, intervals=intervals)
    if intervals:
        risks = risks[:, :-1] + risks[:, 1:]
    may = (risks >= WATCH_RISK).astype(np.float64)
    return may, float(risks[risks < WATCH_RISK].sum())


def _solids(
    scenario: Scenario,
    batch: Encounters,
    near: Indices,
    window: int,
    cache: dict[tuple[int, int, int], tuple[SweepPart, ...]],
) -> list[SolidWatch]:
    """Group what is near by piece."""
    intervals = scenario.avoidance == "intervals"
    keys = np.column_stack([batch.other[near], batch.piece[near]])
    watches = []
    for obstacle, piece in np.unique(keys, axis=0).tolist():
        who = near[(keys == (obstacle, piece)).all(axis=1)]
        moving = scenario.obstacles[obstacle].is_moving
        key = (obstacle, piece, window if moving else -1)
        if key not in cache:
            here = scenario.obstacles[obstacle].at(window)[piece]
            if moving and intervals:
                cache[key] = swept(here, scenario.obstacles[obstacle].at(window + 1)[piece])
            else:
                cache[key] = resting(here)
        watches.append(
            SolidWatch(
                batch.first[who],
                batch.radii[who],
                _bows_at(batch.bows, who, window, intervals=intervals),
                cache[key],
            )
        )
    return watches
