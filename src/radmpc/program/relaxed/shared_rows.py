"""Rows that several relaxations have in common, computed once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from radmpc.program.relaxed.cones import Cones, Outline, cones_around
from radmpc.program.relaxed.instants import Instants
from radmpc.program.relaxed.rows import ConeRows
from radmpc.program.relaxed.tails import Tails

__all__ = ["SharedRows"]


class SharedRows:
    """Rows in the plane that were asked for, to be asked for with the same risk bound and tails.

    What a vehicle has to keep clear of is the same alone, in pairs and in larger sets; within a
    reach that was narrowed the cones are still the same.
    """

    def __init__(self) -> None:
        self._cones: dict[tuple[object, ...], Cones] = {}
        self._rows: dict[tuple[object, ...], ConeRows] = {}

    def around(
        self,
        outline: Outline,
        instants: Instants,
        tails: Tails,
        count: int,
        rows_of: Callable[[Cones], ConeRows],
    ) -> ConeRows:
        """Return the rows of the cones around a hazard.

        Parameters
        ----------
        outline : Outline
            The hazard.
        instants : Instants
            Where the body is.
        tails : Tails
            What charges are at least.
        count : int
            Directions, evenly around.
        rows_of : callable
            Called with the cones if there are no rows yet; of the same bound and tail every time.
        """
        hazard = outline.vertices.tobytes(), outline.radius, instants.covariances.tobytes(), count
        reach = instants.lower.tobytes(), instants.upper.tobytes(), instants.windows.tobytes()
        rows = self._rows.get((hazard, reach))
        if rows is None:
            if hazard not in self._cones:
                angles = (2.0 * np.arange(count) + 1.0) * np.pi / count
                directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
                every = np.broadcast_to(directions, (instants.count, *directions.shape))
                self._cones[hazard] = cones_around(outline, instants.covariances, tails, every)
            rows = self._rows[hazard, reach] = rows_of(self._cones[hazard])
        return rows
