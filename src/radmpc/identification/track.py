"""What a log says of one vehicle, sample by sample, before anything is made of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike

import numpy as np

from radmpc.arguments import field_text
from radmpc.arrays import Frozen, Matrix, Vector, frozen
from radmpc.errors import ArgumentTypeError, FileFormatError, ScenarioError
from radmpc.ranges import sized
from radmpc.records import dataclass
from radmpc.wording import one, value_text

__all__ = ["Track", "check_tracks"]


@dataclass(frozen=True, slots=True, eq=False)
class Track(Frozen):
    """One vehicle's samples as they were logged; entries may be NaN.

    Attributes
    ----------
    name : str
        The vehicle.
    source : str
        The file, as its user named it.
    clock : str
        Tracks with the same word have their times from one clock, and can be compared at equal
        times.
    times : (N,) array
        When the samples were taken [s].
    positions : (N, d) array
        Where the vehicle was [m].
    velocities : (N, d) array or None
        How fast, along the same axes [m/s]; None if not logged.
    controls : (N, d) array or None
        Accelerations that were commanded, each held until the next sample [m/s²].
    references : (N, d) or (N, 2d) array or None
        Where it was to be [m], and how fast [m/s] if that was logged, too.
    second_positions : (N, d) array or None
        The same positions by another sensor [m].

    Raises
    ------
    ScenarioError
        If a word is no text, an array holds no numbers or some beyond 1e9, or its shape is another.

    Examples
    --------
    >>> import radmpc
    >>> track = radmpc.Track("tug", "by hand", "mine", [0.0, 0.5, 1.0], [[0, 0], [1, 0], [2, 1]])
    >>> track.positions.shape, track.velocities is None
    ((3, 2), True)
    """

    name: str
    source: str
    clock: str
    times: Vector
    positions: Matrix
    velocities: Matrix | None = None
    controls: Matrix | None = None
    references: Matrix | None = None
    second_positions: Matrix | None = None

    def __post_init__(self) -> None:
        """Copy and freeze the arrays, and check that they fit."""
        for name in ("name", "source", "clock"):
            field_text(getattr(self, name), (name,))
        object.__setattr__(self, "times", self._entries("times"))
        if self.times.ndim != 1:
            raise ScenarioError(f"must have shape (any), got {self.times.shape}", ("times",))
        if self.positions is None:
            raise ScenarioError("must be a matrix, got None", ("positions",))
        for name in self.parts():
            object.__setattr__(self, name, self._entries(name))
            self._check_shape(name)
            entries = getattr(self, name)
            # What is not finite is missing.
            sized(np.where(np.isfinite(entries), entries, 0.0), (name,))

    def _entries(self, name: str) -> Matrix:
        """Return a copy of an array, of numbers that may be NaN."""
        given = getattr(self, name)
        try:
            return frozen(np.array(given, dtype=np.float64))
        except (TypeError, ValueError, OverflowError) as error:
            raise ScenarioError(
                f"must be numbers of equal row length, got {value_text(given)}", (name,)
            ) from error

    def _check_shape(self, name: str) -> None:
        """Refuse a part that has not one row per time, or other axes than the positions."""
        shape, num = getattr(self, name).shape, len(self.times)
        if name == "positions":
            axes: tuple[int, ...] = (2, 3)
        else:
            d = self.dimension
            axes = (d, 2 * d) if name == "references" else (d,)
        if len(shape) != 2 or shape[0] != num or shape[1] not in axes:
            allowed = " or ".join(f"({num}, {each})" for each in axes)
            raise ScenarioError(f"must have shape {allowed}, got {shape}", (name,))

    def parts(self) -> tuple[str, ...]:
        """Return the names of what was logged beside the times.

        Returns
        -------
        tuple of str
            Of the arrays that are not None.
        """
        names = ("positions", "velocities", "controls", "references", "second_positions")
        return tuple(name for name in names if getattr(self, name) is not None)

    def changed(self, parts: Mapping[str, Matrix | None], times: Vector | None = None) -> Track:
        """Return the track with other parts.

        Parameters
        ----------
        parts : mapping
            By their names; those not named stay as they are.
        times : (N,) array or None
            Of all parts; None leaves them as they are.

        Returns
        -------
        Track
            Of the same vehicle.
        """
        names = ("velocities", "controls", "references", "second_positions")
        found = {name: parts.get(name, getattr(self, name)) for name in names}
        positions = parts.get("positions")
        return Track(
            self.name,
            self.source,
            self.clock,
            self.times if times is None else times,
            self.positions if positions is None else positions,
            **found,
        )

    @property
    def dimension(self) -> int:
        """Number of axes d, 2 or 3."""
        return int(self.positions.shape[1])

    @property
    def where(self) -> str:
        """The file and the vehicle, for messages."""
        return f"{self.source}: vehicle {self.name!r}"


def check_tracks(tracks: object) -> None:
    """Refuse what is no sequence of tracks.

    Parameters
    ----------
    tracks : object
        The argument.

    Raises
    ------
    ArgumentTypeError
        If it is something else; it says what to do instead.
    FileFormatError
        If there is none in it.
    """
    wanted = "tracks must be a sequence of Track"
    if isinstance(tracks, str | PathLike):
        raise ArgumentTypeError(
            f"{wanted}, got {value_text(tracks)}: radmpc.read_logs reads files, and has .tracks"
        )
    if not isinstance(tracks, Sequence):
        raise ArgumentTypeError(f"{wanted}, got {value_text(tracks)}")
    others = [track for track in tracks if not isinstance(track, Track)]
    if others:
        raise ArgumentTypeError(f"{wanted}, got {one(type(others[0]))} in it")
    if not tracks:
        raise FileFormatError("the logs hold no vehicle")
