"""One danger: what is kept apart from what and when, and the rows that come of it."""

from __future__ import annotations

from dataclasses import dataclass

from radmpc.arrays import Indices, Matrix, Tensor, Vector

__all__ = ["Body", "End", "Part", "RowBlock", "Windows"]


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """What is kept apart, one vehicle or the relative motion of two, over the outputs.

    Attributes
    ----------
    lower, upper : (T+1, d) array
        Reach of the (relative) position [m].
    covariances : (T+1, d, d) array
        Covariance of the (relative) position [m²].
    bent : (T, d, d) array or None
        Covariance of what feedback held over a step makes of the deviation at its start [m²];
        None where no part of the body bends its path by feedback.
    parts : tuple of Part
        One vehicle, or two with signs +1 and −1.
    """

    lower: Vector
    upper: Vector
    covariances: Tensor
    bent: Tensor | None
    parts: tuple[Part, ...]


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
    control_bounds: Vector
    sagitta: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """Faces to stay within at each window, ``normals @ position <= near`` (and ``far``).

    Attributes
    ----------
    normals : (w, f, d) array
        Directions *into* what is avoided.
    near, far : (w, f) array
        Right sides at the window's start and end [m]; −inf marks a face that is not there.
    directions : (w, f) int array
        Equal numbers are equal normals.
    intervals : bool
        Whether window j is [j, j+1] or step j+1 alone.
    shares : (w, f) array or None
        Share of the near end of the reserve for the sagitta, where it was chosen with the faces.
    """

    normals: Tensor
    near: Vector
    far: Vector
    directions: Indices
    intervals: bool
    shares: Vector | None = None


@dataclass(frozen=True, slots=True, eq=False)
class RowBlock:
    """The rows of one danger; numbers of rows, events and steps count from 0 within the block."""

    entry_rows: Indices
    entry_outputs: Indices
    entry_values: Vector
    offsets: Vector
    deviations: Vector
    events: Indices
    event_steps: Indices
    alternative_sizes: Indices
    avoidance_sizes: Indices
    avoidance_windows: Indices
    presolved_risk: float
    num_presolved: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class End:
    """One condition at all windows: which step, right sides, deviations, slacks over the reach.

    ``kind`` tells apart deviations of one step that are not nested: 0 is the position's own, 1
    what feedback held over the following step makes of it. ``is_near`` tells whose share of the
    reserve for the sagitta it keeps. ``least`` and ``most`` are slacks without any reserve [m].
    """

    kind: int
    is_near: bool
    steps: Indices
    offsets: Vector
    deviations: Vector
    least: Vector
    most: Vector
