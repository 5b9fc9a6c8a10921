"""Where vehicles are at each step if all move together over a coarse lattice, tick by tick."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.narrow.joint_search import (
    Configuration,
    GoalGraph,
    joint_search,
)
from radmpc.planners.certified.turned.narrow.rerouting import rerouted
from radmpc.planners.certified.turned.narrow.tuning import TUNING
from radmpc.program.hazards import Hazards

__all__ = ["joint_routes"]


def joint_routes(
    hazards: Hazards, clear: Clear, rng: np.random.Generator, is_stopped: Callable[[], bool]
) -> Mapping[int, Matrix]:
    """Return nodes that vehicles pass, tick by tick: all together, none near another.

    Parameters
    ----------
    hazards : Hazards
        The fleet, in the plane.
    clear : Clear
        How far places are from obstacles.
    rng : Generator
        Draws several solutions; that of fewest ticks is taken.
    is_stopped : callable
        Returns True once it is time to stop.

    Returns
    -------
    mapping of int to (K+1, 2) array
        Positions [m]; empty where none were found.
    """
    starts = np.array([model.drift_position[0] for model in hazards.models])
    goals = np.array([0.5 * (m.vehicle.goal.lower + m.vehicle.goal.upper) for m in hazards.models])
    spread = float(np.sqrt(hazards.variances.max() / hazards.dimension))
    radius = float(hazards.radii.max())
    # Two that turn a corner one behind the other come as near as a diagonal of half a cell.
    least = np.sqrt(2.0) * (2.0 * radius + TUNING.joint_sigmas[1] * np.sqrt(2.0) * spread)
    spacing, origin = _lattice(np.vstack([starts, goals]), float(least))
    room = radius + TUNING.joint_sigmas[0] * spread
    nodes, neighbors = _graph(clear.within_borders(radius), spacing, origin, room)
    if not 0 < len(nodes) <= TUNING.lattice_nodes:
        return {}
    ends = []
    for places in (starts, goals):
        apart = np.linalg.norm(nodes - places[:, None], axis=2)
        nearest = apart.argmin(axis=1)
        if np.unique(nearest).size < len(nearest) or apart.min(axis=1).max() > spacing:
            return {}
        ends.append(tuple(nearest.tolist()))
    found = _shortest(neighbors, (ends[0], ends[1]), rng, is_stopped)
    if not found:
        return {}
    return {i: nodes[[each[i] for each in found]] for i in range(hazards.count)}


def _shortest(
    neighbors: list[list[int]],
    ends: tuple[Configuration, Configuration],
    rng: np.random.Generator,
    is_stopped: Callable[[], bool],
) -> list[Configuration]:
    """Return the solution of fewest ticks of those drawn and rerouted, then that of fewest moves.

    Short solutions are found soon or not at all: long searches end with long ones.
    """
    found: list[list[Configuration]] = []
    graph = GoalGraph.to(ends[1], neighbors)
    for drawn in range(TUNING.joint_draws):
        found += _drawn(graph, ends, TUNING.soon, rng, is_stopped)
        if is_stopped() or (drawn + 1 == TUNING.soon_draws and not found):
            break
    for drawn in range(0 if found else TUNING.joint_draws):
        if is_stopped() or (found and drawn >= TUNING.long_draws):
            break
        found += _drawn(graph, ends, TUNING.configurations, rng, is_stopped)
    count = len(ends[0])
    chosen = sorted(found, key=_length)[: TUNING.rerouted if count <= TUNING.few else 1]
    tries = TUNING.reroutes * count
    found = [rerouted(graph, one, tries, rng, is_stopped) for one in chosen]
    return min(found, key=_length, default=[])


def _drawn(
    graph: GoalGraph,
    ends: tuple[Configuration, Configuration],
    configurations: int,
    rng: np.random.Generator,
    is_stopped: Callable[[], bool],
) -> list[list[Configuration]]:
    """Return the solution of one draw, if it has any among so many configurations."""
    drawn = joint_search(graph, *ends, configurations, rng, is_stopped)
    return [drawn] if drawn else []


def _length(configurations: list[Configuration]) -> tuple[int, int]:
    """Return how many ticks there are, and how often anybody moves to another node."""
    moves = sum(
        here != there
        for before, after in pairwise(configurations)
        for here, there in zip(before, after, strict=True)
    )
    return len(configurations), moves


def _lattice(places: Matrix, least: float) -> tuple[float, Vector]:
    """Return the least spacing, and an origin, of a lattice that places lie on, if there is one."""
    offsets = places - places[0]
    for factor in np.arange(1.0, TUNING.lattice_widest, TUNING.lattice_growth):
        cells = offsets / (factor * least)
        if np.abs(cells - np.rint(cells)).max() <= TUNING.lattice_off:
            return _refined(offsets, factor * least), places[0]
    return least, places[0]


def _refined(offsets: Matrix, spacing: float) -> float:
    """Return the spacing that fits offsets best, near one that fits them."""
    cells = np.rint(offsets / spacing)
    square = float(np.sum(cells * cells))
    return float(np.sum(cells * offsets)) / square if square > 0.0 else spacing


def _graph(
    clear: Clear, spacing: float, origin: Vector, room: float
) -> tuple[Matrix, list[list[int]]]:
    """Return the nodes with room, and which are next to each other with room between."""
    lower = clear.grid.points.min(axis=0)
    upper = clear.grid.points.max(axis=0)
    axes = [
        origin[a]
        + spacing
        * np.arange(
            np.ceil((lower[a] - origin[a]) / spacing),
            np.floor((upper[a] - origin[a]) / spacing) + 1,
        )
        for a in (0, 1)
    ]
    mesh = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    numbers = np.full(mesh.shape[:2], -1)
    is_open = clear.at(mesh) >= room
    numbers[is_open] = np.arange(int(is_open.sum()))
    nodes = mesh[is_open]
    neighbors: list[list[int]] = [[] for _ in range(len(nodes))]
    for one, two in ((numbers[:-1], numbers[1:]), (numbers[:, :-1], numbers[:, 1:])):
        both = (one >= 0) & (two >= 0)
        begin, end = one[both], two[both]
        is_clear = (
            clear.along(nodes[begin], nodes[end]) >= room if begin.size else np.zeros(0, bool)
        )
        for i, j in zip(begin[is_clear].tolist(), end[is_clear].tolist(), strict=True):
            neighbors[i].append(j)
            neighbors[j].append(i)
    return nodes, neighbors
