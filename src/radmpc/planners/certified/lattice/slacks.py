"""What slack obstacles leave displacements on a lattice: where they block, where it is little.

Where walls are near everywhere, nine tenths of what is near is blocked: a bit each, instead of a
place and a slack (`parking` of s2m2: 6 MB a search, not 124).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.planners.certified.lattice.half_planes import AvoidanceHalfPlanes
from radmpc.planners.certified.lattice.positions import Lattice
from radmpc.records import dataclass
from radmpc.solvers.compiled_code import is_compiled

if is_compiled():
    from radmpc.solvers import _compiled

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
    values: npt.NDArray[np.float32]


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
    axes = lattice.axes(reference)
    ahead = lattice.axes_ahead(reference, displacement)
    longest = (lattice.reach + np.abs(displacement)) * lattice.stride
    if not is_compiled():
        return _measured(lattice, avoidance, (axes, ahead), longest, bounds)
    bits, numbers, values = _compiled.lattice_slacks(
        (2 * lattice.reach + 1, *lattice.shape),
        avoidance.here,
        avoidance.ahead,
        axes[0],
        axes[1],
        ahead[0],
        ahead[1],
        (float(longest[0]), float(longest[1])),
        bounds,
    )
    return Slacks(
        np.frombuffer(bits, dtype=np.uint8),
        np.frombuffer(numbers, dtype=np.uint32),
        np.frombuffer(values, dtype=np.float32),
    )


def _measured(
    lattice: Lattice,
    avoidance: AvoidanceHalfPlanes,
    axes: tuple[list[Vector], list[Vector]],
    longest: Vector,
    bounds: tuple[float, float],
) -> Slacks:
    """Return the same without compiled code."""
    (x_axis, y_axis), (x_ahead, y_ahead) = axes
    least, little = bounds
    planes = list(zip(avoidance.here, avoidance.ahead, strict=True))
    # Cells from which no displacement leads near are cut away first.
    rough = np.full(lattice.shape, -np.inf)
    for pair in planes:
        slack = np.full(lattice.shape, np.inf)
        for plane in pair:
            room = _room(plane, x_axis[:, None], y_axis[None, :])
            slack = np.minimum(slack, room - np.abs(plane[:2]) @ longest)
        rough = np.maximum(rough, slack)
    rows, columns = np.nonzero(rough < little)
    width = 2 * lattice.reach + 1
    i, j = (each.ravel()[:, None] for each in np.indices((width, width)))
    best = np.full((width * width, rows.size), -np.inf)
    for here, ahead in planes:
        now = _room(here, x_axis[rows], y_axis[columns])
        then = _room(ahead, x_ahead[rows + i], y_ahead[columns + j])
        np.maximum(best, np.minimum(now[None, :], then), out=best)
    number, cell = np.nonzero((best < little) & (best >= least))
    cells = rows * lattice.shape[1] + columns
    numbers = number * (lattice.shape[0] * lattice.shape[1]) + cells[cell]
    return Slacks(
        _bits(best < least, cells, lattice),
        numbers.astype(np.uint32),
        best[number, cell].astype(np.float32),
    )


def _room(plane: Vector, x: Matrix, y: Matrix) -> Matrix:
    """Return the slack that points have in a half-plane [m]."""
    return np.asarray(plane[2] - plane[0] * x - plane[1] * y)


def _bits(
    is_blocked: npt.NDArray[np.bool_], cells: Indices, lattice: Lattice
) -> npt.NDArray[np.uint8]:
    """Return a bit per displacement of the lattice, from those of some of its cells."""
    if not is_blocked.any():
        return np.zeros(0, dtype=np.uint8)
    everywhere = np.zeros((len(is_blocked), lattice.shape[0] * lattice.shape[1]), dtype=np.bool_)
    everywhere[:, cells] = is_blocked
    return np.packbits(everywhere)
