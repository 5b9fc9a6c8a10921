"""Where every vehicle of a fleet is expected, and how uncertain that is."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.referee.common import FleetCommon
from radmpc.referee.tracks import Tracks

__all__ = ["FleetMotion", "Group"]

_MOST = 1e100
"""Largest mean or covariance [m, m/s and their squares]: squares of distances are numbers, too."""


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Vehicles whose loops have states of equal length q, stacked for batches of matrix products.

    Attributes
    ----------
    members : (g,) int array
        Their numbers in the scenario.
    transitions : (g, S, q, q) array
        Of their closed loops at every step, see `Loop`; one for all steps where S is 1.
    initial : (g, q, q) array
        Covariance at k = 0.
    disturbances : (g, S, q, q) array
        Added at every step.
    position : (g, d) int array
        State indices of the position.
    own_initial, own_disturbances : (g, q, q) and (g, S, q, q) array
        Covariances without noise that others meet, too; where there is none, the same arrays.
    """

    members: Indices
    transitions: Tensor
    initial: Tensor
    disturbances: Tensor
    position: Indices
    own_initial: Tensor
    own_disturbances: Tensor


@dataclass(frozen=True, slots=True, eq=False)
class FleetMotion:
    """Means and covariances that follow from a scenario and nominal controls.

    Attributes
    ----------
    names : tuple of str
        The vehicles.
    groups : tuple of Group
        The closed loops.
    states : tuple of (T+1, n) array
        Mean states, per vehicle.
    covariances : tuple of (T+1, n, n) array
        State covariances, per vehicle.
    seen : tuple of (T+1, n, n) array
        Covariances of the deviations that feedback acts on: the same, or those of estimates.
    seen_rows : tuple of int
        Where in the loop's state those deviations begin.
    loops : tuple of (T+1, q, q) array
        Covariances of the closed loops' states, of which the vehicle's is the first part.
    positions : (N, T+1, d) array
        Mean positions [m].
    position_covariances : (N, T+1, d, d) array
        Position covariances [m²].
    sagittas : (N, T, d) array
        ``a dt²/8`` for a double integrator under acceleration a, else 0: how far the mean curve
        deviates from its chord in the middle of each interval, against a [m].
    bends : tuple of (d, q) array or None
        ``G = B_p K``, for the loop's state ζ, of those whose path between steps is bent by feedback
        held over the step: at a share s it adds ``−s (1 − s) G ζ_k``; None for all others.
    bent_covariances : (N, T, d, d) array
        Covariance of ``P δ_k − G δ_k``; that of ``P δ_k``, the position's own, without a bend [m²].
    radii : (N,) array
        Hull radii [m].
    tracks : Tracks or None
        Obstacles whose place is not known exactly; None where all are.
    common : FleetCommon or None
        Noise that vehicles have in common; None is none.
    samples : int or None
        Independent steps that covariances were estimated from; None is that they are known.
    unknown : tuple of (T+1, p, p) array or None
        Of each vehicle: see `Loop.unknown`.
    lasting : tuple of (T+1, n + s) array or None
        Of each vehicle: what is expected over every step of its own disturbance, and of the shared
        ones that last, stacked; None is nothing.
    """

    names: tuple[str, ...]
    groups: tuple[Group, ...]
    states: tuple[Matrix, ...]
    covariances: tuple[Tensor, ...]
    seen: tuple[Tensor, ...]
    seen_rows: tuple[int, ...]
    loops: tuple[Tensor, ...]
    positions: Tensor
    position_covariances: Tensor
    sagittas: Tensor
    bends: tuple[Matrix | None, ...]
    bent_covariances: Tensor
    radii: Vector
    tracks: Tracks | None = None
    common: FleetCommon | None = None
    samples: int | None = None
    unknown: tuple[Tensor | None, ...] = ()
    lasting: tuple[Matrix | None, ...] = ()

    @property
    def is_bent(self) -> bool:
        """Whether feedback bends anybody's path between steps."""
        return any(bend is not None for bend in self.bends)

    @property
    def problems(self) -> list[str]:
        """Vehicles that controls or noise carry beyond all numbers."""
        everything = np.concatenate([each.ravel() for each in (*self.states, *self.covariances)])
        if np.abs(everything).max() <= _MOST:  # nor nan
            return []
        return [
            f"vehicle {name!r}: its {field} overflow{'s' if field == 'mean' else ''}"
            for field, arrays in (("mean", self.states), ("covariances", self.covariances))
            for name, array in zip(self.names, arrays, strict=True)
            if not np.all(np.abs(array) <= _MOST)  # nor nan
        ]
