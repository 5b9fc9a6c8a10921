"""Half-spaces that enter a linear program of turning together, and their rows."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Vector
from radmpc.planners.certified.turned.linear.kept_basis import Offered
from radmpc.planners.certified.turned.linear.margins import Margins
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.records import dataclass

__all__ = ["FEW", "FEW_PRICED", "Entered", "Rows", "are_few", "near_first", "rows_of"]

FEW, FEW_PRICED = 256, 24
"""Half-spaces up to which all are in a program from the first, and where risk has a price: each has
some twenty columns then [-]."""

_LITTLE = 1e-9
"""Share of a reserve below which its row is left out [-]."""

_NEAR = 5.0
"""Clearance below which the others are [standard deviations] where all are to keep the same."""

_NEAR_SHARE = 0.75
"""The same where risk has a price, as a share of the room that is asked for [-]: six standard
deviations. Programs of `paper(8)` take 0.85, 0.80 and 0.89 ms with 0.69, 0.75 and 0.81."""


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Rows of half-spaces, r of them.

    Attributes
    ----------
    spaces, ends : (r,) int array
        The half-space and the end of each.
    reserves : (r,) array
        The multiple of the sagitta that is kept free there [-].
    weights : (r,) array
        Of that end in the point that keeps clear, the other end having the rest [-].
    """

    spaces: Indices
    ends: Indices
    reserves: Vector
    weights: Vector

    @property
    def count(self) -> int:
        """Number of rows r."""
        return len(self.spaces)


def rows_of(spaces: HalfSpaces, bends: npt.NDArray[np.bool_] | None) -> Rows:
    """Choose the rows: at each end the chord, and where the curve comes closer, its reserve.

    With s the sagitta toward the half-space and θ its share, the curve keeps what the chord's start
    keeps less ``4θ²s`` and its end less ``4(1 - θ)²s``. Where the nearest point alone is asked,
    after a share t, both rows are of that point, less ``4t(1 - t)s``.

    Parameters
    ----------
    spaces : HalfSpaces
        Turned to the latest paths.
    bends : (w,) bool array or None
        Which half-spaces curves may come closer to than their chords; None where only steps count.
    """
    every = np.arange(spaces.count)
    if bends is None:
        ones = np.ones(spaces.count)
        return Rows(every, ones.astype(np.int64), np.zeros(spaces.count), ones)
    share, nearest = spaces.shares, spaces.nearest
    is_both = np.isnan(nearest)
    at_nearest = 4.0 * nearest * (1.0 - nearest)
    spaces_of, ends, reserves, weights = [], [], [], []
    for end, kept, own in ((0, share, 1.0 - nearest), (1, 1.0 - share, nearest)):
        # The first position is given.
        plain = every[(spaces.windows > 0) | (end == 1)]
        bent = every[bends & (kept > _LITTLE)]
        spaces_of += [plain, bent]
        ends += [np.full(plain.size + bent.size, end)]
        reserve = np.where(is_both, 4.0 * np.square(kept), at_nearest)
        reserves += [np.zeros(plain.size), reserve[bent]]
        weight = np.where(is_both, 1.0, own)
        weights += [weight[plain], weight[bent]]
    return Rows(*(np.concatenate(each) for each in (spaces_of, ends, reserves, weights)))


@dataclass(frozen=True, slots=True, eq=False)
class Entered:
    """Half-spaces that entered a program together.

    Attributes
    ----------
    spaces : HalfSpaces
        They.
    margins : Margins
        What they ask for.
    rows : Rows
        Their rows.
    first : int
        The first column of what is given up of them.
    """

    spaces: HalfSpaces
    margins: Margins
    rows: Rows
    first: int

    def offered(self, num_ends: int) -> Offered:
        """Return what a basis is told by.

        Parameters
        ----------
        num_ends : int
            Ends of each half-space that have columns [-]; one is the later one.
        """
        spaces, rows, used = self.spaces, self.rows, slice(2 - num_ends, 2)
        keys = 2 * spaces.keys[:, None] + np.arange(2)
        row_keys = 2 * keys[rows.spaces, rows.ends] + (rows.reserves > 0.0)
        given_up = spaces.offsets + self.margins.distances - spaces.heights
        return Offered(
            keys[:, used],
            row_keys,
            num_ends * rows.spaces + rows.ends - (2 - num_ends),
            self.margins.lengths[:, used],
            given_up[:, used],
        )


def are_few(spaces: HalfSpaces, margins: Margins) -> bool:
    """Return whether half-spaces are so few that a program holds all of them from the first.

    Parameters
    ----------
    spaces : HalfSpaces
        Turned to the latest paths.
    margins : Margins
        What they ask for.
    """
    return spaces.count <= (FEW_PRICED if margins.num_columns > 1 else FEW)


def near_first(spaces: HalfSpaces, margins: Margins) -> npt.NDArray[np.bool_]:
    """Return what a program begins with: all half-spaces if few, else those near the paths.

    Parameters
    ----------
    spaces : HalfSpaces
        Turned to the latest paths.
    margins : Margins
        What they ask for.
    """
    if are_few(spaces, margins):
        return np.ones(spaces.count, dtype=bool)
    room = spaces.heights - spaces.offsets
    if margins.num_columns > 1:
        return np.asarray((room < _NEAR_SHARE * margins.distances).any(axis=1))
    return np.asarray((spaces.clearances < _NEAR).any(axis=1))
