"""A disturbance that several vehicles have in common: one wind, one swell, one current's gusts."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_number, field_parts, field_text, value_text
from radmpc.arrays import Frozen, Matrix, as_covariance, as_matrix
from radmpc.errors import ScenarioError
from radmpc.model.numbers import check_correlation
from radmpc.ranges import sized
from radmpc.records import dataclass

__all__ = ["SharedDisturbance", "as_shared", "check_sources", "lasting_parts"]


@dataclass(frozen=True, slots=True, eq=False)
class SharedDisturbance(Frozen):
    """A vehicle's part in a disturbance d that acts on several: G d is added to its own.

    Vehicles that name the same source meet the same d at every step, and must agree about its
    covariance and correlation.

    Attributes
    ----------
    name : str
        Of the source.
    matrix : (n, r) array
        G: what d does to this vehicle's state.
    covariance : (r, r) array
        Covariance D of d at every step, positive semi-definite. One number or a diagonal is taken
        as well.
    correlation : float
        Correlation of d at consecutive steps, from 0 (new at every step) to below 1.

    Examples
    --------
    One wind for the whole fleet, of 0.1 m/s per step and axis:

    >>> import radmpc
    >>> push = [[0.5, 0.0], [0.0, 0.5], [1.0, 0.0], [0.0, 1.0]]  # on positions and velocities
    >>> radmpc.SharedDisturbance("wind", push, 0.1**2).covariance.round(9).tolist()
    [[0.01, 0.0], [0.0, 0.01]]
    """

    name: str
    matrix: Matrix
    covariance: Matrix
    correlation: float = 0.0

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(
            self,
            name: str,
            matrix: npt.ArrayLike,
            covariance: npt.ArrayLike,
            correlation: float = 0.0,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Freeze the matrices."""
        field_text(self.name, ("name",))
        if not self.name.strip():
            state = "blank" if self.name else "empty"
            raise ScenarioError(f"must not be {state}, got {self.name!r}", ("name",))
        matrix = sized(as_matrix(self.matrix, path=("matrix",)), ("matrix",))
        if not matrix.size:
            raise ScenarioError("must have at least one row and column, got none", ("matrix",))
        object.__setattr__(self, "matrix", matrix)
        covariance = as_covariance(self.covariance, matrix.shape[1], ("covariance",))
        object.__setattr__(self, "covariance", covariance)
        object.__setattr__(self, "correlation", field_number(self.correlation, ("correlation",)))
        check_correlation(self.correlation, ("correlation",))

    @property
    def size(self) -> int:
        """Length r of d."""
        return int(self.matrix.shape[1])

    def is_same_source(self, other: SharedDisturbance) -> bool:
        """Return whether another part is one in the same d.

        Parameters
        ----------
        other : SharedDisturbance
            That part, of another vehicle.

        Returns
        -------
        bool
            Whether covariance and correlation are equal.
        """
        return self.correlation == other.correlation and np.array_equal(
            self.covariance, other.covariance
        )


def as_shared(given: object, num_states: int) -> tuple[SharedDisturbance, ...]:
    """Return a vehicle's parts in shared disturbances as a tuple.

    Parameters
    ----------
    given : sequence of SharedDisturbance
        What was given.
    num_states : int
        Length n of the vehicle's state.

    Raises
    ------
    ScenarioError
        If one is something else, has another number of rows, or stands twice.
    """
    names: set[str] = set()
    found = []
    for i, part in enumerate(field_parts(given, "a sequence of SharedDisturbances", ("shared",))):
        path = ("shared", i)
        if not isinstance(part, SharedDisturbance):
            raise ScenarioError(f"must be a SharedDisturbance, got {value_text(part)}", path)
        if len(part.matrix) != num_states:
            text = f"must have {num_states} rows like the state, got {len(part.matrix)}"
            raise ScenarioError(text, (*path, "matrix"))
        if part.name in names:
            raise ScenarioError(f"{part.name!r} stands there twice", (*path, "name"))
        names.add(part.name)
        found.append(part)
    return tuple(found)


def lasting_parts(shared: Iterable[SharedDisturbance]) -> tuple[SharedDisturbance, ...]:
    """Return those parts in shared disturbances that outlast a step.

    Parameters
    ----------
    shared : iterable of SharedDisturbance
        Those of a vehicle.
    """
    return tuple(part for part in shared if part.correlation > 0.0)


def check_sources(shared_by_vehicle: Iterable[tuple[SharedDisturbance, ...]]) -> None:
    """Check that all parts in a source agree about it.

    Parameters
    ----------
    shared_by_vehicle : iterable of tuple of SharedDisturbance
        Those of every vehicle of a scenario.

    Raises
    ------
    ScenarioError
        With the vehicle and source where they do not.
    """
    first: dict[str, SharedDisturbance] = {}
    for i, parts in enumerate(shared_by_vehicle):
        for k, part in enumerate(parts):
            if not part.is_same_source(first.setdefault(part.name, part)):
                raise ScenarioError(
                    f"{part.name!r} has another covariance or correlation than with a vehicle "
                    "before: must be the same for all",
                    ("vehicles", i, "shared", k),
                )
