"""Hazards that a relaxation leaves out, since plans like the one at hand keep far from them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.program.relaxed.instants import Instants
from radmpc.program.relaxed.level_curves import Outline
from radmpc.records import dataclass, replace

__all__ = ["Vicinity", "near_boxes", "near_each_other"]

_NEAR, _CLOSE = 10.0, 4.0
"""Deviations of the relative position within which a hazard is near a path, and within which it is
close [-]. With 4 or 6 instead of 10 the proof of `fleet(256, 0)` takes as long, and of ten draws of
`paper(8)` two instead of one need a second search; at 4 a hazard is charged 3e-5 at most."""


@dataclass(frozen=True, slots=True, eq=False)
class Vicinity:
    """Where hazards are at the instants at which they are in reach, I in all.

    Attributes
    ----------
    body, other : int
        The vehicle, by its place; the one that its position is relative to, -1 for none.
    windows : (I,) int array
        Steps at which the instants' intervals begin.
    shares : (I,) array
        How far through it each instant is [-].
    lower, upper : (I or 1, d) array
        Boxes around the hazards [m].
    radius : float
        By how much they are grown [m].
    deviations : (I,) array
        Size of the noise [m].
    is_at_steps : bool
        Whether all instants are the ends of their intervals.
    """

    body: int
    other: int
    windows: Indices
    shares: Vector
    lower: Matrix
    upper: Matrix
    radius: float
    deviations: Vector
    is_at_steps: bool

    @classmethod
    def of(cls, body: int, other: int, instants: Instants, outline: Outline) -> Vicinity:
        """Return where a hazard is.

        Parameters
        ----------
        body, other : int
            As in `Vicinity`.
        instants : Instants
            Of the (relative) position.
        outline : Outline
            The hazard at these instants.
        """
        ends = outline.vertices.min(axis=1), outline.vertices.max(axis=1)
        return cls.of_boxes((body, other), instants, ends, outline.radius)

    @classmethod
    def of_boxes(
        cls,
        bodies: tuple[int, int],
        instants: Instants,
        boxes: tuple[Matrix, Matrix],
        radius: float,
    ) -> Vicinity:
        """Return where several hazards are.

        Parameters
        ----------
        bodies : tuple of int
            Body and other, as in `Vicinity`.
        instants : Instants
            Of the position: hazard by hazard those at which it is in reach.
        boxes : tuple of (I or 1, d) array
            Lower and upper ends of the box of the hazard that each instant is of [m].
        radius : float
            By how much they are grown [m].
        """
        is_at_steps = bool((instants.shares == 1.0).all())
        when = instants.windows, instants.shares
        return cls(*bodies, *when, *boxes, radius, instants.sizes(), is_at_steps)

    def of_bodies(self, places: tuple[int, ...]) -> Vicinity:
        """Return the same of vehicles that are at other places.

        Parameters
        ----------
        places : tuple of int
            The place of each vehicle that bodies count among.
        """
        other = self.other if self.other < 0 else places[self.other]
        return replace(self, body=places[self.body], other=other)

    def is_near(self, paths: Tensor) -> bool:
        """Tell whether mean positions at the steps, (N, T+1, d) [m], come near the hazard."""
        return self._is_within(paths, _NEAR)

    def is_close(self, paths: Tensor) -> bool:
        """Tell whether they come so close that it would be charged for."""
        return self._is_within(paths, _CLOSE)

    def _is_within(self, paths: Tensor, deviations: float) -> bool:
        """Tell whether mean positions come within so many deviations of the hazard."""
        path = paths[self.body] if self.other < 0 else paths[self.body] - paths[self.other]
        at = _positions(path, self.windows, self.shares, are_steps=self.is_at_steps)
        apart = np.maximum(np.maximum(self.lower - at, at - self.upper), 0.0)
        reach = self.radius + deviations * self.deviations
        return bool(np.any((apart * apart).sum(axis=1) <= reach * reach))


def near_boxes(
    instants: Instants, boxes: tuple[Matrix, Matrix], radius: float, path: Matrix
) -> NDArray[np.bool_]:
    """Tell which boxes a path comes near, and when: relaxations would not leave these out.

    Parameters
    ----------
    instants : Instants
        Of the position, I in all.
    boxes : tuple of (h, d) array
        Their lower and upper ends [m].
    radius : float
        By how much they are grown [m].
    path : (T+1, d) array
        Mean positions at the steps [m].

    Returns
    -------
    (h, I) bool array
        True where the path is near a box.
    """
    lower, upper = boxes
    are_steps = bool((instants.shares == 1.0).all())
    at = _positions(path, instants.windows, instants.shares, are_steps=are_steps)
    apart = np.maximum(np.maximum(lower[:, None] - at, at - upper[:, None]), 0.0)
    reach = radius + _NEAR * instants.sizes()
    return np.asarray((apart * apart).sum(axis=2) <= reach * reach)


def _positions(path: Matrix, windows: Indices, shares: Vector, *, are_steps: bool) -> Matrix:
    """Return mean positions at instants on the chords of a path, (I, d) [m]."""
    at = path[windows + 1]
    if are_steps:
        return at
    share = shares[:, None]
    return np.asarray((1.0 - share) * path[windows] + share * at)


def near_each_other(
    paths: Tensor, radii: Vector, deviations: Vector, *, intervals: bool
) -> NDArray[np.bool_]:
    """Tell which vehicles come so near each other that relaxations would not leave that out.

    Parameters
    ----------
    paths : (N, T+1, d) array
        Mean positions at the steps [m].
    radii : (N,) array
        Their hulls [m].
    deviations : (N,) array
        Sizes of their largest noise [m]; that of a relative position is at most the sum of two.
    intervals : bool
        Whether they may be anywhere on chords between the steps.

    Returns
    -------
    (N, N) bool array
        True for itself.
    """
    squares = ((paths[:, None] - paths[None]) ** 2).sum(axis=3)
    reach = np.add.outer(radii, radii) + _NEAR * np.add.outer(deviations, deviations)
    if intervals:
        # In the middle of a step two may be nearer than at its ends, by half of what each moves.
        half = 0.5 * np.linalg.norm(np.diff(paths, axis=1), axis=2).max(axis=1)
        reach = reach + np.add.outer(half, half)
    return np.asarray(squares.min(axis=2) <= reach * reach)
