"""Tables of events as they are bought: half-spaces at moments, and integrals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.referee.bound.halfspace import end_margins
from radmpc.referee.conditional.choices import Choice
from radmpc.referee.conditional.rows import Flags, IntegralRows
from radmpc.referee.sites import Sites

__all__ = ["TimedRows", "all_integrals", "at_steps", "joined", "links"]


@dataclass(frozen=True, slots=True, eq=False)
class TimedRows:
    """Half-spaces in the order of time, E of them, before anything is known of the noise.

    Attributes
    ----------
    encounters, windows : (E,) int array
        As in `HalfspaceRows`.
    normals : (E, d) array
        Away from what is avoided [-].
    margins, shares, bends : (E,) array
        As in `HalfspaceRows`.
    before : (E,) int array
        Row within these, or −1.
    nested : (E,) bool array
        As in `HalfspaceRows`.
    """

    encounters: Indices
    windows: Indices
    normals: Matrix
    margins: Vector
    shares: Vector
    bends: Vector
    before: Indices
    nested: Flags

    def take(self, chosen: Indices) -> TimedRows:
        """Return some half-spaces, none of which is linked to another."""
        return TimedRows(
            self.encounters[chosen],
            self.windows[chosen],
            self.normals[chosen],
            self.margins[chosen],
            self.shares[chosen],
            self.bends[chosen],
            self.before[chosen],
            self.nested[chosen],
        )


def joined(tables: Sequence[TimedRows], dimension: int) -> TimedRows:
    """Return all half-spaces in one table.

    Parameters
    ----------
    tables : sequence of TimedRows
        Any number of them.
    dimension : int
        d.
    """
    ints, numbers = np.zeros(0, dtype=np.int64), np.zeros(0)
    starts = np.cumsum([0, *(len(t.windows) for t in tables)])
    before = [
        np.where(t.before < 0, -1, t.before + start)
        for t, start in zip(tables, starts, strict=False)
    ]
    return TimedRows(
        np.concatenate([ints, *(t.encounters for t in tables)]),
        np.concatenate([ints, *(t.windows for t in tables)]),
        np.concatenate([np.zeros((0, dimension)), *(t.normals for t in tables)]),
        np.concatenate([numbers, *(t.margins for t in tables)]),
        np.concatenate([numbers, *(t.shares for t in tables)]),
        np.concatenate([numbers, *(t.bends for t in tables)]),
        np.concatenate([ints, *before]),
        np.concatenate([np.zeros(0, dtype=bool), *(t.nested for t in tables)]),
    )


def at_steps(sites: Sites, normals: Matrix, numbers: Indices) -> TimedRows:
    """Return one half-space per encounter and step.

    Parameters
    ----------
    sites : Sites
        Of one end each, encounter by encounter.
    normals : (S, d) array
        Their half-spaces [-].
    numbers : (B,) int array
        The encounters' numbers.
    """
    count = len(normals)
    steps = count // len(numbers)
    margins = end_margins(sites, normals[:, None])[:, 0, 0]
    windows, none = np.tile(np.arange(steps), len(numbers)), np.zeros(count)
    apart, same = np.full(count, -1), np.zeros(count, dtype=bool)
    owners = np.repeat(numbers, steps)
    return TimedRows(owners, windows, normals, margins, none, none, apart, same)


def links(choice: Choice, ends: int) -> tuple[Indices, Flags]:
    """Return which row each is charged without, and which of these links are of nested events.

    Parameters
    ----------
    choice : Choice
        The half-spaces.
    ends : int
        Events of each: near, bent near where there is feedback, far.
    """
    count, width = choice.directions.shape[:2]
    rows = np.arange(count * width * ends).reshape(count, width, ends)
    before = np.full(rows.shape, -1)
    nested = np.zeros(rows.shape, dtype=bool)
    if choice.parts:
        before[:, :, 1:] = rows[:, :, :-1]
        before[:, 1:, 0] = rows[:, :-1, -1]
    else:
        nested[:, 1:, 0] = ~choice.begins[:, 1:]
        before[:, 1:, 0] = np.where(nested[:, 1:, 0], rows[:, :-1, -1], -1)
    return before.ravel(), nested.ravel()


def all_integrals(tables: Sequence[IntegralRows], dimension: int) -> IntegralRows:
    """Return all integrals in one table, corners and directions padded by the first.

    Parameters
    ----------
    tables : sequence of IntegralRows
        Any number of them.
    dimension : int
        d.
    """
    ints = np.zeros(0, dtype=np.int64)
    if not any(len(t.windows) for t in tables):
        empty = np.zeros((0, 1, dimension))
        none = np.zeros(0)
        square = np.zeros((0, dimension, dimension))
        return IntegralRows(ints, ints, empty[:, 0], empty, none, square, empty, none, none > 0.0)
    corners = max(t.vertices.shape[1] for t in tables)
    tried = max(t.directions.shape[1] for t in tables)
    return IntegralRows(
        np.concatenate([t.encounters for t in tables]),
        np.concatenate([t.windows for t in tables]),
        np.concatenate([t.means for t in tables]),
        np.concatenate([_padded(t.vertices, corners) for t in tables]),
        np.concatenate([t.radii for t in tables]),
        np.concatenate([t.strays for t in tables]),
        np.concatenate([_padded(t.directions, tried) for t in tables]),
        np.concatenate([t.charged for t in tables]),
        np.concatenate([t.are_sharp for t in tables]),
    )


def _padded(rows: Tensor, count: int) -> Tensor:
    """Repeat the first entry until there are enough."""
    return np.concatenate([rows, np.repeat(rows[:, :1], count - rows.shape[1], axis=1)], axis=1)
