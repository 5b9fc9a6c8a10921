r"""The events that a certificate charges, written down so that they can be valued again and again.

A certificate bounds the probability of a union of *fixed* sets: half-spaces with their offsets and
shares of the sagitta's reserve, or the sets themselves where they were integrated. The conditional
probability of a fixed set is a martingale; that of the best half-space found anew is not.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.model.plan import Cause, Plan
from radmpc.records import dataclass
from radmpc.referee.conditional.far import Far
from radmpc.referee.conditional.loops import Loops
from radmpc.referee.motion import FleetMotion

__all__ = ["Flags", "HalfspaceRows", "IntegralRows", "Parties", "Witnesses"]

Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Parties:
    """Vehicle and obstacle or partner of each encounter.

    Attributes
    ----------
    causes : tuple of str
        'pair', 'obstacle', 'workspace' or 'range', B of them.
    first : (B,) int array
        The vehicle.
    other : (B,) int array
        The other vehicle of a pair or a range, or the obstacle; 0 for the workspace.
    are_hidden : (B,) bool array
        Whether what is measured leaves open if anything was hit: a vehicle measures with noise, or
        the obstacle's place is not known exactly.
    """

    causes: tuple[Cause, ...]
    first: Indices
    other: Indices
    are_hidden: Flags

    @property
    def others(self) -> Indices:
        """The other vehicle where there are two, 0 elsewhere, (B,)."""
        return np.where(self.are_pairs, self.other, 0)

    @property
    def are_pairs(self) -> Flags:
        """Which encounters are of two vehicles, (B,) bool."""
        return np.array([cause in {"pair", "range"} for cause in self.causes], dtype=bool)

    @property
    def are_capped(self) -> Flags:
        """Which encounters are charged 1 at most, as the certificate does, (B,) bool."""
        return np.array([cause in {"pair", "obstacle"} for cause in self.causes], dtype=bool)


@dataclass(frozen=True, slots=True, eq=False)
class HalfspaceRows:
    r"""Events ``n·y < −margin``, y a (relative) position's deviation from its nominal.

    Of a vehicle the deviation at a share s of step k is
    ``y = [(1 − s) P + s P F − s (1 − s) G − β G] δ_k + s P w_k``, β > 0 at bent near ends.

    Attributes
    ----------
    encounters : (E,) int array
        Which encounter each belongs to.
    windows : (E,) int array
        The step k, or the interval that begins there.
    normals : (E, d) array
        n, away from what is avoided [-].
    margins : (E,) array
        The nominal's distance from the event [m].
    shares : (E,) array
        s, 0 at steps [-].
    bends : (E,) array
        β [-].
    before : (E,) int array
        The row without which this one is charged, "V and not the one before"; −1 where it is
        charged whole.
    nested : (E,) bool array
        Whether that row holds the same n at the same moment.
    first, other : (E, n) array
        ``n·[…]`` as a row on the state of the vehicle and, its sign turned, of the other one.
    fresh : (E,) array
        Variance ``s² n·P W Pᵀ n`` that the step's own disturbance adds, and all of an obstacle's
        place, of which nothing is ever measured [m²].
    link_first, link_other : (E, n) array
        `first` and `other` of the row before, as functions of the same δ_k.
    link_fresh : (E,) array
        Covariance with that row by the same [m²].
    link_rest : (E,) array
        Variance of that row that comes on top of the same δ_k, where it ends the step before: the
        obstacle's place [m²].
    """

    encounters: Indices
    windows: Indices
    normals: Matrix
    margins: Vector
    shares: Vector
    bends: Vector
    before: Indices
    nested: Flags
    first: Matrix
    other: Matrix
    fresh: Vector
    link_first: Matrix
    link_other: Matrix
    link_fresh: Vector
    link_rest: Vector


@dataclass(frozen=True, slots=True, eq=False)
class IntegralRows:
    """Events "in the set grown by the radius", in the plane at steps, integrated exactly.

    Attributes
    ----------
    encounters, windows : (E,) int array
        Which encounter, and at which step.
    means : (E, 2) array
        Nominal (relative) position [m].
    vertices : (E, V, 2) array
        Corners of the set [m].
    radii : (E,) array
        Radius [m].
    strays : (E, 2, 2) array
        Covariance of the obstacle's place; 0 where it is known exactly [m²].
    directions : (E, G, 2) array
        Unit normals worth trying where the noise is singular: faces and axes [-].
    charged : (E,) array
        Probability when they were bought [-].
    are_sharp : (E,) bool array
        Whether that is no bound alone.
    """

    encounters: Indices
    windows: Indices
    means: Matrix
    vertices: Tensor
    radii: Vector
    strays: Tensor
    directions: Tensor
    charged: Vector
    are_sharp: Flags


@dataclass(frozen=True, slots=True, eq=False)
class Witnesses:
    """What a plan was certified by: to be valued by the same rows as long as it is flown.

    Attributes
    ----------
    plan : Plan
        The plan.
    motion : FleetMotion
        Its nominal and closed loops.
    parties : Parties
        The encounters.
    halfspaces : HalfspaceRows
        Events by half-spaces.
    integrals : IntegralRows
        Events by integrals.
    far : Far
        Encounters charged unseen.
    loops : Loops
        The closed loops, as rows are valued by them.
    """

    plan: Plan
    motion: FleetMotion
    parties: Parties
    halfspaces: HalfspaceRows
    integrals: IntegralRows
    far: Far
    loops: Loops

    @property
    def intervals(self) -> bool:
        """Whether the path between steps counts."""
        return self.plan.scenario.avoidance == "intervals"
