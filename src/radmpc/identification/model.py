"""The dynamics that noise is identified for."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix
from radmpc.records import dataclass

__all__ = ["StepModel"]


@dataclass(frozen=True, slots=True, eq=False)
class StepModel:
    """Dynamics without feedback: a double integrator, without velocities a single one.

    Attributes
    ----------
    dt : float
        Step [s].
    dimension : int
        Number of axes d.
    has_velocity : bool
        Whether velocities are part of the state.
    """

    dt: float
    dimension: int
    has_velocity: bool

    @property
    def A(self) -> Matrix:  # noqa: N802 - the field's name
        """State matrix, (n, n)."""
        eye, zero = np.eye(self.dimension), np.zeros((self.dimension, self.dimension))
        return np.block([[eye, self.dt * eye], [zero, eye]]) if self.has_velocity else eye

    @property
    def B(self) -> Matrix:  # noqa: N802 - the field's name
        """Control matrix, (n, d)."""
        eye = np.eye(self.dimension)
        if not self.has_velocity:
            return self.dt * eye
        return np.vstack([0.5 * self.dt**2 * eye, self.dt * eye])

    @property
    def num_states(self) -> int:
        """Length n of the state."""
        return 2 * self.dimension if self.has_velocity else self.dimension

    def states_along(self, axes: Indices) -> Indices:
        """Return where the states of some axes stand.

        Parameters
        ----------
        axes : (k,) array
            Numbers of axes.

        Returns
        -------
        (k,) or (2 k,) array
            Positions, then velocities if these are part of the state.
        """
        return np.concatenate([axes, axes + self.dimension]) if self.has_velocity else axes
