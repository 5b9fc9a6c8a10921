"""What counts as near a path, and how far paths keep apart at first."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix
from radmpc.gaussian import CONVEX_RISK
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass

__all__ = ["Near", "first_clearance", "squared_limits"]


@dataclass(frozen=True, slots=True)
class Near:
    """Which windows get a half-space, and how carefully it is turned.

    Attributes
    ----------
    clearance : float
        Standard deviations that are kept in any case [-].
    reach : float
        Room beyond them up to which something counts as near [m].
    is_refined : bool
        Whether directions are refined to the best by clearance, or the line of closest approach
        will do.
    is_start_given : bool
        Whether in the first window only those count between vehicles that keep the clearance where
        they start: nothing changes that end. The last window is turned to goals alike.
    is_nearest_asked : bool
        Whether paths keep clear of corners, and of each other, where they are nearest alone.
    """

    clearance: float
    reach: float
    is_refined: bool
    is_start_given: bool = False
    is_nearest_asked: bool = False


def first_clearance(
    hazards: Hazards, risk_bound: float, share: float = TUNING.first_share
) -> float:
    """Return how far vehicles keep apart before risk has a price [standard deviations].

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    risk_bound : float
        Δ [-].
    share : float
        Share of Δ per vehicle that every half-space may risk [-].
    """
    risk = min(share * risk_bound / hazards.count, CONVEX_RISK)
    return float(hazards.tail.clearance_for(risk))


def squared_limits(hazards: Hazards, which: tuple[Indices, Indices, Indices], near: Near) -> Matrix:
    """Return the squared distance below which pieces are near members, by pairs, (p, T) [m²].

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    which : tuple of int array
        The members; of each pair the place among them, and the number of the piece.
    near : Near
        What counts as near.
    """
    members, places, pieces = which
    variances, radii = hazards.variances[members], hazards.radii[members][:, None]
    if hazards.shapes.covariances is None:
        return np.square(radii + near.clearance * np.sqrt(variances) + near.reach)[places]
    spread = np.sqrt(variances[places] + hazards.shapes.variances[pieces])
    return np.asarray(np.square(radii[places] + near.clearance * spread + near.reach))
