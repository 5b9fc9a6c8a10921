"""Samples as transitions: what a step did that the model does not explain yet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.identification.model import StepModel
from radmpc.identification.sampling import Samples
from radmpc.identification.whiteness import LEAST_CHANGE
from radmpc.records import dataclass, replace

__all__ = [
    "Evidence",
    "Segment",
    "Transitions",
    "moving_axes",
    "segments",
    "stacked",
    "without_jumps",
]

Evidence = Literal["commands", "references", "states"]
"""What is known beside the states: the commands, where the vehicle was to be, or nothing."""

_JUMP = 25.0
"""Robust standard deviations [-] beyond which a step is a jump: a Student-t with 3 degrees of
freedom gets there once in 10,000 steps."""

_MOST_JUMPS = 0.02
"""Share of steps [-] above which far ones are no jumps but the noise."""

_ROUNDING = 1e-6
"""Share of the accelerations that commands and references come to below which all their differences
are rounding [-]: what is stored in 32 bits has seven digits."""

_LEFT = 1e-3
"""Share of the corrections [-] that feedback to a reference that never changes may leave: else the
vehicle was steered by other references, which were not logged."""


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """Successive transitions of one vehicle without a gap.

    Attributes
    ----------
    first : int
        Step at which they begin.
    y : (k, n) array
        What dynamics without feedback leave unexplained of the next state.
    h : (k, q) array
        What feedback may explain it by: deviations from the reference; q is 0 where there is none.
    offset : (k, d) array or None
        Difference of two sensors' positions at the beginning of each transition [m].
    """

    first: int
    y: Matrix
    h: Matrix
    offset: Matrix | None


@dataclass(frozen=True, slots=True, eq=False)
class Transitions:
    """All transitions of a vehicle.

    Attributes
    ----------
    name : str
        The vehicle.
    clock : str
        As in `Track`.
    segments : tuple of Segment
        In the order of time.
    deviations, corrections : (k, n), (k, d) array or None
        Deviations from the reference, and by how much commands differ from the reference's own
        accelerations [m/s²]; None unless both were logged.
    """

    name: str
    clock: str
    segments: tuple[Segment, ...]
    deviations: Matrix | None = None
    corrections: Matrix | None = None

    @property
    def num_steps(self) -> int:
        """How many there are."""
        return sum(len(segment.y) for segment in self.segments)

    def joined(self, other: Transitions) -> Transitions:
        """Return these transitions with those of another log of the same vehicle.

        Parameters
        ----------
        other : Transitions
            Of any clock: what they have in common with other vehicles is told by the first.
        """
        pairs = (self.deviations, self.corrections, other.deviations, other.corrections)
        deviations = corrections = None
        if not any(part is None for part in pairs):
            one, answer, another, its_answer = (part for part in pairs if part is not None)
            deviations = np.concatenate([one, another])
            corrections = np.concatenate([answer, its_answer])
        clock = self.clock if self.clock == other.clock else f"{self.clock}, {other.clock}"
        together = (*self.segments, *other.segments)
        return Transitions(self.name, clock, together, deviations, corrections)

    def along(self, axes: Indices, model: StepModel) -> Transitions:
        """Return the transitions of some axes alone.

        Parameters
        ----------
        axes : (k,) array
            Numbers of axes.
        model : StepModel
            Dynamics of all axes.
        """
        states = model.states_along(axes)
        found = tuple(
            replace(
                one,
                y=one.y[:, states],
                h=one.h[:, states] if one.h.shape[1] else one.h,
                offset=None if one.offset is None else one.offset[:, axes],
            )
            for one in self.segments
        )
        return replace(
            self,
            segments=found,
            deviations=None if self.deviations is None else self.deviations[:, states],
            corrections=None if self.corrections is None else self.corrections[:, axes],
        )


def segments(samples: Samples, evidence: Evidence) -> Transitions:
    """Return the transitions of a vehicle.

    Parameters
    ----------
    samples : Samples
        At steps.
    evidence : {'commands', 'references', 'states'}
        What may explain them.
    """
    lengths = np.diff(samples.times)
    d, n = samples.track.dimension, samples.states.shape[1]
    is_step = np.diff(samples.steps) == 1
    states = samples.states
    if evidence == "references" and samples.references is not None:
        states = samples.states - samples.references
    y = states[1:] - states[:-1]
    if n == 2 * d:
        y[:, :d] -= lengths[:, None] * states[:-1, d:]
    if evidence == "commands" and samples.effects is not None:
        y -= samples.effects[:-1]
    h = states[:-1] if evidence == "references" else np.empty((len(y), 0))
    offset = None if samples.second is None else samples.states[:-1, :d] - samples.second[:-1]
    found = tuple(
        Segment(int(samples.steps[run[0]]), y[run], h[run], None if offset is None else offset[run])
        for run in _runs(is_step)
    )
    deviations, corrections = _feedback_pairs(samples, is_step)
    return Transitions(samples.track.name, samples.track.clock, found, deviations, corrections)


def _runs(is_step: npt.NDArray[np.bool_]) -> list[Indices]:
    """Return runs of indices where a mask holds."""
    places = np.flatnonzero(is_step)
    if not places.size:
        return []
    return list(np.split(places, np.flatnonzero(np.diff(places) > 1) + 1))


def _feedback_pairs(
    samples: Samples,
    is_step: npt.NDArray[np.bool_],
) -> tuple[Matrix | None, Matrix | None]:
    """Return deviations and what commands answered, where both were logged."""
    d, references = samples.track.dimension, samples.references
    if references is None or samples.controls is None or references.shape[1] != 2 * d:
        return None, None
    if len(samples.times) < 2:
        return None, None
    deviations = (samples.states - references)[:-1]
    lengths = np.diff(samples.times)[:, None]
    planned = np.diff(references[:, d:], axis=0) / lengths
    corrections = samples.controls[:-1] - planned
    largest = np.abs(samples.controls).max() + np.abs(references[:, d:]).max() / lengths.min()
    if np.abs(corrections).max() <= _ROUNDING * largest:
        corrections[:] = 0.0
    deviations, corrections = deviations[is_step], corrections[is_step]
    if np.ptp(references, axis=0).max() == 0.0 and not _is_law(deviations, corrections):
        return None, None
    return deviations, corrections


def _is_law(deviations: Matrix, corrections: Matrix) -> bool:
    """Whether feedback explains corrections, as it does of a vehicle that holds one place."""
    h, y = deviations - deviations.mean(axis=0), corrections - corrections.mean(axis=0)
    rest = y - h @ np.linalg.lstsq(h, y, rcond=None)[0]
    return float(np.sum(rest**2)) <= _LEFT * float(np.sum(y**2))


def without_jumps(transitions: Transitions, dimension: int) -> tuple[Transitions, int, float]:
    """Return transitions without jumps of the position, such as a receiver's resets.

    Parameters
    ----------
    transitions : Transitions
        Of one vehicle.
    dimension : int
        Number of axes d.

    Returns
    -------
    transitions : Transitions
        Segments end at jumps.
    count : int
        How many were left out.
    largest : float
        The largest of them [m].
    """
    if transitions.num_steps < 10:
        return transitions, 0, 0.0
    y = np.concatenate([segment.y for segment in transitions.segments])[:, :dimension]
    centered = np.abs(y - np.median(y, axis=0))
    scale = 1.4826 * np.median(centered, axis=0)
    is_jump = np.any((centered > _JUMP * scale) & (scale > 0.0), axis=1)
    count = int(is_jump.sum())
    if not count or count > _MOST_JUMPS * len(y):
        return transitions, 0, 0.0
    pieces: list[Segment] = []
    begin = 0
    for segment in transitions.segments:
        pieces += _parts(segment, ~is_jump[begin : begin + len(segment.y)])
        begin += len(segment.y)
    largest = float(np.linalg.norm(y[is_jump] - np.median(y, axis=0), axis=1).max())
    return replace(transitions, segments=tuple(pieces)), count, largest


def _parts(segment: Segment, is_kept: npt.NDArray[np.bool_]) -> Sequence[Segment]:
    """Return what remains of a segment."""
    return [
        Segment(
            segment.first + int(run[0]),
            segment.y[run],
            segment.h[run],
            None if segment.offset is None else segment.offset[run],
        )
        for run in _runs(is_kept)
    ]


def stacked(all_segments: Sequence[Segment]) -> tuple[Matrix, Matrix, Vector]:
    """Return all y, all h, and 1 where a transition follows the one before it, else 0."""
    y = np.concatenate([segment.y for segment in all_segments])
    h = np.concatenate([segment.h for segment in all_segments])
    follows = np.ones(len(y))
    firsts = np.cumsum([0, *(len(segment.y) for segment in all_segments[:-1])])
    follows[firsts] = 0.0
    return y, h, follows


def moving_axes(y: Matrix, model: StepModel) -> Indices:
    """Return the axes of which any state changes unexplained; if none does, all.

    Parameters
    ----------
    y : (N, n) array
        What dynamics leave unexplained.
    model : StepModel
        Dynamics.

    Returns
    -------
    (k,) array
        Their numbers.
    """
    deviations = y.std(axis=0)
    moves = deviations > LEAST_CHANGE * float(deviations.max())
    axes = np.flatnonzero(moves.reshape(-1, model.dimension).any(axis=0))
    return axes if axes.size else np.arange(model.dimension)
