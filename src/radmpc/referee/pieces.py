"""Convex pieces of obstacles: which vehicles they concern, where they are in each window."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Vector
from radmpc.geometry import Polytope
from radmpc.model.relations.concerns import is_for
from radmpc.model.scenario import Scenario

__all__ = ["boxes_of", "concerned", "in_windows", "pieces_of"]

Flags = npt.NDArray[np.bool_]


def concerned(scenario: Scenario) -> Flags:
    """Return which vehicles each obstacle concerns, (O, N) bool.

    Parameters
    ----------
    scenario : Scenario
        The plan's.
    """
    found = np.ones((len(scenario.obstacles), scenario.num_vehicles), dtype=bool)
    for number, obstacle in enumerate(scenario.obstacles):
        if obstacle.concerns is not None:
            found[number] = [is_for(obstacle, vehicle.name) for vehicle in scenario.vehicles]
    return found


def pieces_of(scenario: Scenario, step: int) -> Iterator[tuple[int, int, Sequence[Polytope]]]:
    """Yield each convex piece with its numbers: one shape, or one per step on if it moves.

    Parameters
    ----------
    scenario : Scenario
        The plan's.
    step : int
        From which on.
    """
    for number, obstacle in enumerate(scenario.obstacles):
        if obstacle.is_moving:
            yield number, 0, [obstacle.at(k)[0] for k in range(step, scenario.horizon + 1)]
        else:
            for piece, shape in enumerate(obstacle.at(0)):
                yield number, piece, [shape]


def boxes_of(pieces: Sequence[Polytope], *, intervals: bool) -> tuple[Matrix, Matrix]:
    """Return the corners of the box around a piece in each window.

    Parameters
    ----------
    pieces : sequence of Polytope
        One shape, or one per step.
    intervals : bool
        Whether windows are intervals, or steps.

    Returns
    -------
    lower, upper : (W, d) array
        Per window [m]; (1, d), the same in all of them, of one shape.
    """
    lower = np.array([p.vertices.min(axis=0) for p in pieces])
    upper = np.array([p.vertices.max(axis=0) for p in pieces])
    if intervals and len(pieces) > 1:
        lower = np.minimum(lower[:-1], lower[1:])
        upper = np.maximum(upper[:-1], upper[1:])
    return lower, upper


def in_windows(deviations: Vector, *, intervals: bool) -> Vector:
    """Return the largest of some deviations in each window.

    Parameters
    ----------
    deviations : (T+1,) array
        At the steps [m].
    intervals : bool
        Whether windows are intervals, or steps.
    """
    return np.maximum(deviations[:-1], deviations[1:]) if intervals else deviations
