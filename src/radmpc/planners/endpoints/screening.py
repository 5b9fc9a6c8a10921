"""Whether starts and goals are harmless, told by one place in each of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.gaussian import Tail, clearance
from radmpc.model.scenario import Scenario
from radmpc.nearby import near_pairs
from radmpc.planners.endpoints.boxes import Box, Shapes
from radmpc.program.condensed import CondensedModel

__all__ = ["are_surely_harmless"]

_FAR = 40.0
"""Standard deviations beyond which pairs are left out [-]: Gaussian tails there are 0. Where tails
fall slowly it is so many as leave next to nothing."""

_NEAR = 6.0
"""Standard deviations within which a box around a piece of an obstacle calls for a look at its
faces [-]: beyond, tails are 1e-9."""

_MOST = 10_000_000
"""Vehicles times pieces of obstacles, or pairs where all may be near, up to which they are looked
at [-]: 80 MB."""


def are_surely_harmless(scenario: Scenario, models: Sequence[CondensedModel]) -> bool:
    """Whether what starts and goals risk at least, see `floors`, surely sums to Δ at most.

    What a box risks at least it risks at no more than in its middle, which half-spaces across the
    lines to the boxes around hazards bound, with deviations no less than along any direction.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    models : sequence of CondensedModel
        Its vehicles over the whole horizon.

    Returns
    -------
    bool
        False where a closer look has to tell.
    """
    tail, left = Tail(scenario.covariance_samples), scenario.risk_bound
    far, pairs = tail.beyond(_FAR), 0.5 * len(models) * (len(models) - 1)
    if far > _FAR and pairs > _MOST:
        return False
    for at_goal in (False, True):
        boxes = [Box.at_endpoint(model, at_goal=at_goal) for model in models]
        shapes = Shapes.of(scenario, scenario.horizon if at_goal else 0)
        if len(boxes) * len(shapes.pieces) > _MOST:
            return False
        middles = np.array([0.5 * (box.lower + box.upper) for box in boxes])
        covariances = np.array([box.covariance for box in boxes])
        spreads = np.sqrt(np.maximum(np.linalg.eigvalsh(covariances)[:, -1], 0.0))
        radii = np.array([vehicle.radius for vehicle in scenario.vehicles])
        parts = [
            _of_obstacles(shapes, middles, radii, spreads),
            _of_pairs(middles, radii, spreads, far),
            _of_borders(scenario, middles, spreads),
        ]
        left -= sum(float(tail.probability(clearance(*part)).sum()) for part in parts)
        left -= pairs * tail.probability(far)
        if not left > 0.0:
            return False
    return True


def _of_obstacles(
    shapes: Shapes, middles: Matrix, radii: Vector, spreads: Vector
) -> tuple[Vector, Vector]:
    """Return slacks and deviations of every vehicle and every piece, (N p,) each [m]."""
    beside = np.maximum(shapes.lower - middles[:, None], middles[:, None] - shapes.upper)
    slacks = np.linalg.norm(np.maximum(beside, 0.0), axis=2) - radii[:, None]
    known = {
        name: float(np.sqrt(max(np.trace(covariance), 0.0)))
        for name, covariance in shapes.covariances.items()
    }
    strays = np.array([known.get(owner, 0.0) for owner in shapes.owners])
    # Deviations of two add up to less than their sum.
    deviations = spreads[:, None] + strays
    for i, k in np.argwhere(slacks < _NEAR * deviations).tolist():
        # A face of a piece may be farther off than the box around it.
        piece = shapes.pieces[k]
        beyond = float((piece.normals @ middles[i] - piece.offsets).max())
        slacks[i, k] = max(slacks[i, k], beyond - radii[i])
    return slacks.ravel(), deviations.ravel()


def _of_pairs(middles: Matrix, radii: Vector, spreads: Vector, far: float) -> tuple[Vector, Vector]:
    """Return slacks and deviations of the pairs that are not far apart, (P,) each [m]."""
    near = 2.0 * float(radii.max() + far * spreads.max()) + 1e-6
    one, two = near_pairs(middles, near).T
    apart = np.linalg.norm(middles[one] - middles[two], axis=1)
    return apart - radii[one] - radii[two], spreads[one] + spreads[two]


def _of_borders(scenario: Scenario, middles: Matrix, spreads: Vector) -> tuple[Vector, Vector]:
    """Return slacks and deviations of every vehicle and every border, (2 N d,) each [m]."""
    if scenario.workspace is None:
        return np.zeros(0), np.zeros(0)
    ends = middles - scenario.workspace.lower, scenario.workspace.upper - middles
    slacks = np.concatenate([end.ravel() for end in ends])
    return slacks, np.tile(np.repeat(spreads, scenario.dimension), 2)
