"""Dynamic programming over a lattice, window by window."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from radmpc.arrays import Indices
from radmpc.planners.certified.lattice.motion import Motion
from radmpc.planners.certified.lattice.positions import Lattice
from radmpc.planners.certified.lattice.tables import (
    INFEASIBLE,
    FeasibleValues,
    Float32,
    WindowCosts,
    changed,
    moved,
)
from radmpc.program.condensed import CondensedModel
from radmpc.solvers.solution import Limits

__all__ = ["cheapest_cells"]

_Tables = tuple[Float32, Float32]
"""Effort from one displacement to the next along each axis, [next, last]."""


def cheapest_cells(
    lattice: Lattice,
    model: CondensedModel,
    motion: Motion,
    costs: Callable[[int], WindowCosts],
    limits: Limits,
) -> Indices | None:
    """Return the cheapest path over a lattice within what a vehicle reaches.

    Parameters
    ----------
    lattice : Lattice
        Of positions and displacements.
    model : CondensedModel
        The vehicle, which tells what it reaches.
    motion : Motion
        The effort of its displacements.
    costs : callable
        What displacements cost besides in a window, by its number.
    limits : Limits
        When to stop early.

    Returns
    -------
    (T+1, 2) int array or None
        Cells from the start; None where there is no path, or none was found in time.
    """
    displacements, reach = np.diff(lattice.reference, axis=0), lattice.reach
    width, (row, column) = 2 * reach + 1, (int(place) for place in -lattice.first)
    values = np.full((width, width, *lattice.shape), INFEASIBLE, dtype=np.float32)
    first = displacements[0] * lattice.stride, lattice.stride, reach
    values[:, :, row, column] = motion.first_costs(*first)
    box, arrivals = (row, row + 1, column, column + 1), list[FeasibleValues]()
    tables = _tables(lattice, motion)
    for k in range(model.horizon):
        if limits.reached:
            return None
        if k > 0:
            values = changed(values, tables[k - 1], box)
        ahead = lattice.box(k + 1, model.reach_lower[k + 1], model.reach_upper[k + 1])
        values = moved(values, costs(k), box, ahead)
        arrivals.append(FeasibleValues.of(values, ahead))
        if not arrivals[-1].values.size:
            return None
        box = ahead
    return _traced(lattice, tables, arrivals)


def _tables(lattice: Lattice, motion: Motion) -> list[_Tables]:
    """Return the effort of changes from each displacement to the next."""
    known: dict[bytes, _Tables] = {}
    found, displacements = [], np.diff(lattice.reference, axis=0)
    for k in range(1, len(displacements)):
        last, following = displacements[k - 1 : k + 1]
        key = displacements[k - 1 : k + 1].tobytes()
        if key not in known:
            parts = last, following, lattice.stride, lattice.reach
            known[key] = motion.change_costs(*parts)
        found.append(known[key])
    return found


def _traced(
    lattice: Lattice, tables: Sequence[_Tables], arrivals: Sequence[FeasibleValues]
) -> Indices:
    """Follow the cheapest path back from its end."""
    last = arrivals[-1].cheapest
    displacement, cell = np.array(last[:2]), np.array(last[2:])
    cells = [cell]
    for k in range(len(arrivals) - 1, -1, -1):
        cell = cell - (displacement - lattice.reach)
        cells.append(cell)
        if k > 0:
            along, across = tables[k - 1]
            total = arrivals[k - 1].at(int(cell[0]), int(cell[1]))
            total = total + along[displacement[0]][:, None] + across[displacement[1]][None, :]
            displacement = np.array(np.unravel_index(int(total.argmin()), total.shape))
    return np.asarray(cells[::-1] + lattice.first + lattice.reference)
