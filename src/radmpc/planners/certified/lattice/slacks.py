"""What slack obstacles leave displacements on a lattice: where they block, where it is little.

Where walls are near everywhere, nine tenths of what is near is blocked: a bit each, instead of a
place and a slack (`parking` of s2m2: 6 MB a search, not 124).
"""

from __future__ import annotations

from itertools import product

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices
from radmpc.planners.certified.lattice.half_planes import AvoidanceHalfPlanes
from radmpc.planners.certified.lattice.positions import Lattice
from radmpc.planners.certified.lattice.tables import Float32
from radmpc.records import dataclass

__all__ = ["Slacks", "slacks_of"]


@dataclass(frozen=True, slots=True)
class Slacks:
    """What one obstacle leaves displacements, numbered by displacement and position.

    Attributes
    ----------
    bits : (ceil(n / 8),) array
        A bit per displacement that leaves so little slack that no avoidance allows it; none where
        there are no such displacements.
    numbers : (m,) array
        Displacements that leave little slack, the blocked ones left out.
    values : (m,) array
        What they leave, by the best alternative [m].
    """

    bits: npt.NDArray[np.uint8]
    numbers: npt.NDArray[np.uint32]
    values: Float32

    def blocked(self, count: int) -> npt.NDArray[np.bool_] | None:
        """Return whether each of all displacements is blocked; None where none is."""
        if not self.bits.size:
            return None
        return np.unpackbits(self.bits, count=count).view(np.bool_)


def slacks_of(
    lattice: Lattice,
    reference: Indices,
    displacement: Indices,
    avoidance: AvoidanceHalfPlanes,
    bounds: tuple[float, float],
) -> Slacks:
    """Return what slack an obstacle leaves displacements, each with its best alternative.

    Parameters
    ----------
    lattice : Lattice
        Of positions and displacements.
    reference, displacement : (2,) array
        Where the lattice lies, and by how much it moves in this window [cells].
    avoidance : AvoidanceHalfPlanes
        The obstacle, in this window.
    bounds : pair of float
        Slack below which displacements are blocked, and below which it is little [m].
    """
    least, little = bounds
    axes = lattice.axes(reference)
    # Cells from which no displacement leads near are cut away first.
    longest = (lattice.reach + np.abs(displacement)) * lattice.stride
    rough = np.full(lattice.shape, -np.inf)
    for here, ahead in zip(avoidance.here, avoidance.ahead, strict=True):
        slack = np.full(lattice.shape, np.inf)
        for plane in (here, ahead):
            room = plane[2] - plane[0] * axes[0][:, None] - plane[1] * axes[1][None, :]
            slack = np.minimum(slack, room - np.abs(plane[:2]) @ longest)
        rough = np.maximum(rough, slack)
    x, y = np.nonzero(rough < little)
    steps = (
        np.array(list(product(range(-lattice.reach, lattice.reach + 1), repeat=2))) + displacement
    )
    points = np.column_stack([axes[0][x], axes[1][y]])
    reached = lattice.reached(points, (x, y), steps)
    best = np.full((len(steps), x.size), -np.inf)
    for here, ahead in zip(avoidance.here, avoidance.ahead, strict=True):
        now = here[2] - points @ here[:2]
        then = ahead[2] - ahead[0] * reached[0] - ahead[1] * reached[1]
        np.maximum(best, np.minimum(now[None, :], then), out=best)
    number, cell = np.nonzero((best < little) & (best >= least))
    cells = x * lattice.shape[1] + y
    numbers = number * (lattice.shape[0] * lattice.shape[1]) + cells[cell]
    return Slacks(
        _bits(best < least, cells, lattice),
        numbers.astype(np.uint32),
        best[number, cell].astype(np.float32),
    )


def _bits(
    is_blocked: npt.NDArray[np.bool_], cells: Indices, lattice: Lattice
) -> npt.NDArray[np.uint8]:
    """Return a bit per displacement of the lattice, from those of some of its cells."""
    if not is_blocked.any():
        return np.zeros(0, dtype=np.uint8)
    everywhere = np.zeros((len(is_blocked), lattice.shape[0] * lattice.shape[1]), dtype=np.bool_)
    everywhere[:, cells] = is_blocked
    return np.packbits(everywhere)
