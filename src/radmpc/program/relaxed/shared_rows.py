"""Rows that several relaxations have in common, computed once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from radmpc.arrays import Indices, Tensor
from radmpc.program.keepout import KeepOuts
from radmpc.program.relaxed.cones import Cones, cones_around
from radmpc.program.relaxed.instants import Instants
from radmpc.program.relaxed.level_curves import Outline
from radmpc.program.relaxed.rows import ConeRows
from radmpc.program.relaxed.shared_hazards import SharedHazards
from radmpc.program.relaxed.tails import Tails

__all__ = ["SharedCones", "SharedRows"]

_Hazard = tuple[object, ...]
"""A hazard, the noise that it is seen with at every instant, and the number of directions."""

_MOSTLY = 0.5
"""Share of all instants from which on the cones are computed at all of them at once [-]."""


class SharedCones:
    """Cones in the plane that were asked for, to be asked for with the same tails.

    They are the same for all vehicles of one size whose noise is the same, wherever these may be,
    and for all pairs of such: from the second that asks on, they are known at every instant.

    Parameters
    ----------
    keeps_rows : bool
        Whether rows of them are kept for all who ask, too: in large fleets they are many.
    """

    def __init__(self, *, keeps_rows: bool = False) -> None:
        self.keepouts = KeepOuts()
        self._keeps_rows = keeps_rows
        self._known: dict[_Hazard, Cones] = {}
        self._seen: set[_Hazard] = set()
        self._rows: SharedRows | None = None

    def rows(self) -> SharedRows:
        """Return rows of these cones: the shared ones, or new ones where none are kept."""
        if self._rows is None or not self._keeps_rows:
            self._rows = SharedRows(self, SharedHazards())
        return self._rows

    def forget_rows(self) -> None:
        """Give up the rows: those around another plan are asked for next."""
        self._rows = None

    def at(
        self,
        hazard: _Hazard,
        around: tuple[Outline, Instants, Tails, int],
        chosen: Indices,
    ) -> Cones:
        """Return the cones around a hazard at some instants.

        Parameters
        ----------
        hazard : tuple
            What tells it, its noise and the number of directions from others.
        around : tuple of Outline, Instants, Tails and int
            The hazard and where the body is, both at all instants; what charges are at least, and
            directions, evenly around.
        chosen : (c,) int array
            The instants' numbers.
        """
        outline, instants, tails, count = around
        cones = self._known.get(hazard)
        if cones is None:
            is_shared = hazard in self._seen or chosen.size >= _MOSTLY * instants.count
            if not is_shared:
                self._seen.add(hazard)
                some = outline.take(chosen), instants.covariances[chosen]
                return cones_around(*some, tails, _evenly(count, chosen.size))
            every = instants.covariances, tails, _evenly(count, instants.count)
            cones = self._known[hazard] = cones_around(outline, *every)
        return cones.take(chosen)


class SharedRows:
    """Rows in the plane that were asked for, to be asked for with the same risk bound and tails.

    What a vehicle has to keep clear of is the same alone, in pairs and in larger sets; within a
    reach that was narrowed the cones are still the same.

    Parameters
    ----------
    cones : SharedCones or None
        Those of other vehicles, for the same tails.
    hazards : SharedHazards or None
        Of the same vehicles, within their whole reach: rows are kept there alone. None is within
        any reach.
    """

    def __init__(
        self, cones: SharedCones | None = None, hazards: SharedHazards | None = None
    ) -> None:
        self.hazards = hazards
        self._cones = SharedCones() if cones is None else cones
        self.keepouts = self._cones.keepouts
        self._rows: dict[tuple[object, ...], ConeRows] = {}

    def around(
        self,
        around: tuple[Outline, Instants, Tails, int],
        chosen: Indices,
        rows_of: Callable[[Cones], ConeRows],
    ) -> ConeRows:
        """Return the rows of the cones around a hazard.

        Parameters
        ----------
        around, chosen
            As in `SharedCones.at`.
        rows_of : callable
            Called with the cones at the chosen instants if there are no rows yet; of the same bound
            and tail every time.
        """
        outline, instants, _, count = around
        hazard = outline.vertices.tobytes(), outline.radius, instants.covariances.tobytes(), count
        if self.hazards is not None:
            return rows_of(self._cones.at(hazard, around, chosen))
        lower, upper = instants.lower[chosen], instants.upper[chosen]
        reach = lower.tobytes(), upper.tobytes(), chosen.tobytes()
        rows = self._rows.get((hazard, reach))
        if rows is None:
            cones = self._cones.at(hazard, around, chosen)
            rows = self._rows[hazard, reach] = rows_of(cones)
        return rows


def _evenly(count: int, num_instants: int) -> Tensor:
    """Return directions evenly around, the same at all instants, (I, count, 2)."""
    angles = (2.0 * np.arange(count) + 1.0) * np.pi / count
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.broadcast_to(directions, (num_instants, *directions.shape))
