"""Avoidances over all windows: what is kept out of what and when, and the resulting rows."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Integers, Matrix, Tensor, Vector
from radmpc.records import dataclass, replace

__all__ = ["Body", "End", "Part", "RowBlock", "Windows"]


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """What avoids: one vehicle, or the relative motion of two, over the outputs.

    Attributes
    ----------
    lower, upper : (T+1, d) array
        Box that holds the (relative) mean position under every admissible control [m].
    covariances : (T+1, d, d) array
        Covariance of the (relative) position [m²].
    bent : (T, d, d) array or None
        Covariance of what feedback held over a step makes of the deviation at its start [m²];
        None where no part of the body bends its path by feedback.
    parts : tuple of Part
        One vehicle, or two with signs +1 and −1.
    """

    lower: Matrix
    upper: Matrix
    covariances: Tensor
    bent: Tensor | None
    parts: tuple[Part, ...]

    @property
    def endpoints(self) -> tuple[tuple[Vector, Vector, Matrix], ...]:
        """Box of the mean and covariance, at the first and at the last step."""
        return (
            (self.lower[0], self.upper[0], self.covariances[0]),
            (self.lower[-1], self.upper[-1], self.covariances[-1]),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """One vehicle's place among the outputs.

    Attributes
    ----------
    sign : float
        +1, or −1 for the second vehicle of a pair.
    position : int
        Output number of its position at k = 0, axis 0; steps follow, axes fastest.
    controls : int
        Output number of its control u⁺ at k = 0, axis 0; u⁻ follows after all u⁺.
    control_bounds : (T, m) array
        Largest |ū|.
    sagitta : (d, m) array
        How far the path hangs off its chord at mid-step, per control; 0 where it is straight.
    """

    sign: float
    position: int
    controls: int
    control_bounds: Matrix
    sagitta: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """Faces to stay within at each window, ``normals @ position <= near`` (and ``far``).

    The windows of one thing to avoid follow one another, and things follow one another: all at
    once, because arrays of a single one are so small that most of the time would be numpy's calls.

    Attributes
    ----------
    normals : (w, f, d) array
        Directions *into* what is avoided.
    near, far : (w, f) array
        Right sides at the window's start and end [m]; −inf marks a face that is not there.
    directions : (w, f) int array
        Equal numbers are equal normals.
    intervals : bool
        Whether window j of a thing is [j, j+1] or step j+1 alone.
    numbers : (w,) int array
        The number j of each window among those of its thing.
    things : (w,) int array
        The thing that is avoided there, counted from 0.
    """

    normals: Tensor
    near: Matrix
    far: Matrix
    directions: Indices
    intervals: bool
    numbers: Indices
    things: Indices

    @classmethod
    def constant(
        cls, normals: Tensor, offsets: Matrix, horizon: int, *, intervals: bool
    ) -> Windows:
        """Return windows whose faces never change.

        Parameters
        ----------
        normals : (n, f, d) array
            Directions into each of n things.
        offsets : (n, f) array
            Right sides [m].
        horizon : int
            Number of windows of each.
        intervals : bool
            Whether windows are intervals.
        """
        count, num_faces = offsets.shape
        repeated = np.repeat(offsets, horizon, axis=0)
        return cls(
            np.repeat(normals, horizon, axis=0),
            repeated,
            repeated,
            np.tile(np.arange(num_faces), (count * horizon, 1)),
            intervals,
            np.tile(np.arange(horizon), count),
            np.repeat(np.arange(count), horizon),
        )


@dataclass(frozen=True, slots=True, eq=False)
class RowBlock:
    """The rows of some things to avoid over all windows; numbers count from 0 within the block.

    Attributes
    ----------
    entry_rows, entry_outputs : (entries,) int array
        Row and output of each coefficient.
    entry_values : (entries,) array
        The coefficients.
    offsets : (r,) array
        Right sides [m].
    deviations : (r,) array
        Standard deviations of the left sides [m].
    events : (r,) int array
        The event each row belongs to.
    event_steps : (e,) int array
        Step of each event, from the program's first on.
    alternative_sizes : (a,) int array
        Rows of each alternative; they follow one another.
    avoidance_sizes : (v,) int array
        Alternatives of each window that asks for a choice.
    avoidance_windows : (v,) int array
        The windows that do, by their numbers among those of their thing.
    presolved_risk : float
        Risk charged for all other windows.
    num_presolved : int
        How many those are.
    alternative_parents : (a,) int array or None
        As in `DisjunctiveProgram`; None where no alternative refines another.
    event_things, avoidance_things : (e,) and (v,) int array, or None
        The thing to avoid that each event, and each window that asks for a choice, is part of; None
        where there is but one.
    """

    entry_rows: Integers
    entry_outputs: Integers
    entry_values: Vector
    offsets: Vector
    deviations: Vector
    events: Integers
    event_steps: Indices
    alternative_sizes: Integers
    avoidance_sizes: Indices
    avoidance_windows: Indices
    presolved_risk: float
    num_presolved: int = 0
    alternative_parents: Integers | None = None
    event_things: Indices | None = None
    avoidance_things: Indices | None = None

    def compact(self) -> RowBlock:
        """Return the same without zeros, numbers of entries, rows and so on in half the memory.

        Half of the entries along the faces of boxes are zeros, and points are rated by all others.
        """
        if self.entry_rows.dtype == np.int32:
            return self
        parents, is_any = self.alternative_parents, self.entry_values != 0.0
        return replace(
            self,
            entry_rows=self.entry_rows[is_any].astype(np.int32),
            entry_outputs=self.entry_outputs[is_any].astype(np.int32),
            entry_values=self.entry_values[is_any],
            events=self.events.astype(np.int32),
            alternative_sizes=self.alternative_sizes.astype(np.int32),
            alternative_parents=None if parents is None else parents.astype(np.int32),
        )


@dataclass(frozen=True, slots=True, eq=False)
class End:
    """One condition at all windows, rated over the reachable boxes.

    Attributes
    ----------
    kind : {0, 1}
        Tells apart deviations of one step that are not nested: 0 is the position's own, 1 what
        feedback held over the following step makes of it.
    is_near : bool
        Whether it reserves the near end's share of the sagitta, or the far end's.
    steps : (w,) int array
        Step at which it is asked.
    offsets : (w, f) array
        Right sides [m].
    deviations : (w, f) array
        Standard deviations along the faces [m].
    least, most : (w, f) array
        Slacks over the reachable box, no sagitta reserved [m].
    """

    kind: int
    is_near: bool
    steps: Indices
    offsets: Matrix
    deviations: Matrix
    least: Matrix
    most: Matrix
