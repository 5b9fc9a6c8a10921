"""What a vehicle measures of its state, and how well."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_integer, field_parts, value_text
from radmpc.arrays import Frozen, Matrix, as_covariance, as_matrix
from radmpc.errors import ScenarioError
from radmpc.ranges import sized
from radmpc.records import dataclass

__all__ = ["Measurement"]

_MOST_STATES = 10_000
"""States of a vehicle beyond which no matrix is made [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Measurement(Frozen):
    """A sensor, ``y = C x + v`` at every step before the control of that step is chosen.

    What a vehicle knows of its state is then the estimate of a Kalman filter, and its feedback is
    ``u = ū + K (x̂ − x̄)``.

    Attributes
    ----------
    matrix : (p, n) array
        C: which states are measured, or which sums of them.
    covariance : (p, p) array
        Covariance R of the noise v, new at every step, positive semi-definite. One number or a
        diagonal is taken as well.

    Examples
    --------
    A receiver that is good to 2 m per axis, on a double integrator in the plane:

    >>> import radmpc
    >>> receiver = radmpc.Measurement([[1, 0, 0, 0], [0, 1, 0, 0]], 2.0**2)
    >>> receiver.covariance.tolist()
    [[4.0, 0.0], [0.0, 4.0]]
    """

    matrix: Matrix
    covariance: Matrix

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(self, matrix: npt.ArrayLike, covariance: npt.ArrayLike) -> None: ...

    def __post_init__(self) -> None:
        """Freeze the matrices."""
        matrix = sized(as_matrix(self.matrix, path=("matrix",)), ("matrix",))
        if not len(matrix):
            raise ScenarioError("must have at least one row, got none", ("matrix",))
        object.__setattr__(self, "matrix", matrix)
        covariance = as_covariance(self.covariance, len(matrix), ("covariance",))
        object.__setattr__(self, "covariance", covariance)

    @classmethod
    def of(cls, states: Sequence[int], num_states: int, covariance: npt.ArrayLike) -> Measurement:
        """Return a sensor that sees some states as they are, noise aside.

        Parameters
        ----------
        states : sequence of int
            Their indices, from 0.
        num_states : int
            Length n of the state.
        covariance : (p, p) array_like
            Covariance of the noise; one number or a diagonal is taken as well.

        Returns
        -------
        Measurement
            With a row of zeros and a one per state.

        Raises
        ------
        ScenarioError
            If an index is that of no state, or one stands twice.
        """
        num_states = field_integer(num_states, ("num_states",))
        if not 1 <= num_states <= _MOST_STATES:
            wrong = f"must be from 1 to {_MOST_STATES}, got {value_text(num_states)}"
            raise ScenarioError(wrong, ("num_states",))
        allowed = f"distinct state indices from 0 to {num_states - 1}"
        parts = field_parts(states, allowed, ("of",))
        chosen = [field_integer(i, ("of", k)) for k, i in enumerate(parts)]
        is_wrong = any(not 0 <= i < num_states for i in chosen) or len(set(chosen)) < len(chosen)
        if is_wrong or not chosen:
            raise ScenarioError(f"must be {allowed}, got {chosen}", ("of",))
        return cls(np.eye(num_states)[chosen], covariance)
