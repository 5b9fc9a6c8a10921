"""The latest path of every vehicle of a fleet, as half-spaces are turned to them one after another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.planners.certified.hazards import Hazards

__all__ = ["Paths", "SavedPaths"]


SavedPaths = tuple[Sequence[Matrix], Tensor, Tensor]
"""Controls, mean positions and sagittas of all vehicles."""


class Paths:
    """Where every vehicle is on average, by its latest controls; changed in place.

    Parameters
    ----------
    hazards : Hazards
        The fleet.

    Attributes
    ----------
    controls : list of (T, m) array
        Nominal controls of each vehicle.
    means : (N, T+1, d) array
        Mean positions [m]; of a reference without controls, where one was set.
    sagittas : (N, T, d) array
        How far each path hangs off its chords at mid-step [m].
    """

    def __init__(self, hazards: Hazards) -> None:
        self._models = hazards.models
        self.controls: list[Matrix] = [np.zeros(m.control_bounds.shape) for m in hazards.models]
        self.means: Tensor = np.array([model.drift_position for model in hazards.models])
        self.sagittas: Tensor = np.zeros((hazards.count, hazards.horizon, hazards.dimension))

    def fly(self, vehicle: int, controls: Matrix) -> None:
        """Give a vehicle new controls.

        Parameters
        ----------
        vehicle : int
            Its number.
        controls : (T, m) array
            Nominal controls.
        """
        model = self._models[vehicle]
        self.controls[vehicle] = controls
        self.means[vehicle] = model.drift_position + model.position @ controls.ravel()
        self.sagittas[vehicle] = controls @ model.vehicle.system.sagitta.T

    def refer(self, vehicle: int, positions: Matrix) -> None:
        """Give a vehicle a path to turn half-spaces to, whether or not any controls follow it.

        Parameters
        ----------
        vehicle : int
            Its number.
        positions : (T+1, d) array
            Positions at the steps [m].
        """
        self.means[vehicle] = positions
        self.sagittas[vehicle] = 0.0

    def cost(self) -> float:
        """Return the effort of all controls."""
        pairs = zip(self._models, self.controls, strict=True)
        return sum(model.vehicle.cost_weight * float(np.abs(u).sum()) for model, u in pairs)

    def state(self) -> SavedPaths:
        """Return what `restore` takes to come back to these paths."""
        return tuple(self.controls), self.means.copy(), self.sagittas.copy()

    def restore(self, state: SavedPaths) -> None:
        """Come back to paths that `state` returned."""
        controls, means, sagittas = state
        self.controls = list(controls)
        self.means, self.sagittas = means.copy(), sagittas.copy()
