"""The referee's own propagation of obstacles whose place is known up to noise.

Place and velocity of such an obstacle are a linear system under fresh noise, as a vehicle's closed
loop is, but no control steers it: what is drawn for it once, it is for all vehicles.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.model.obstacle import TrackShape
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass

__all__ = ["Tracks", "tracks_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Tracks:
    """Deviations of M obstacles from where they are expected.

    Attributes
    ----------
    places : (O,) int array
        Place of each of the scenario's obstacles among these; −1 of those known exactly.
    transition : (2 d, 2 d) array
        Of place and velocity over a step.
    initial, disturbances : (M, 2 d, 2 d) array
        Covariances at k = 0, and of what every step adds.
    states : (M, T+1, 2 d, 2 d) array
        Covariances at every step.
    """

    places: Indices
    transition: Matrix
    initial: Tensor
    disturbances: Tensor
    states: Tensor

    @property
    def count(self) -> int:
        """Number of obstacles M."""
        return len(self.initial)

    @property
    def dimension(self) -> int:
        """Number of coordinates d."""
        return len(self.transition) // 2

    @property
    def positions(self) -> Tensor:
        """Covariances of their places, (M, T+1, d, d) [m²]."""
        d = self.dimension
        return self.states[:, :, :d, :d]

    @property
    def deviations(self) -> Matrix:
        """Largest standard deviations along any direction, (M, T+1) [m]."""
        largest = np.linalg.eigvalsh(self.positions)[..., -1]
        return np.asarray(np.sqrt(largest.clip(min=0.0)))

    def within(self, place: int, shares: Vector) -> tuple[Tensor, Tensor]:
        """Return covariances at shares of every step, and with those at the next share.

        Parameters
        ----------
        place : int
            Which of these obstacles.
        shares : (P+1,) array
            From 0 to 1, ascending [-].

        Returns
        -------
        (T, P, d, d) array
            At every share but the last [m²].
        (T, P, d, d) array
            Between every share and the next [m²].
        """
        d = self.dimension
        picked = np.eye(2 * d)[:d]
        s = shares[:, None, None]
        # From one step to the next the place moves straight.
        seen = (1.0 - s) * picked + s * (picked @ self.transition)
        states = self.states[place, :-1, None]
        fresh = self.disturbances[place][:d, :d]
        near, far = seen[:-1], seen[1:]
        own = near @ states @ near.swapaxes(-1, -2) + s[:-1] ** 2 * fresh
        crossed = near @ states @ far.swapaxes(-1, -2) + s[:-1] * s[1:] * fresh
        return own, crossed


def tracks_of(scenario: Scenario) -> Tracks | None:
    """Return the tracks of a scenario's obstacles; None where all are known exactly.

    Parameters
    ----------
    scenario : Scenario
        Its obstacles and its step are taken from it.
    """
    places = np.full(len(scenario.obstacles), -1, dtype=np.int64)
    shapes: list[TrackShape] = []
    for number, obstacle in enumerate(scenario.obstacles):
        shape = obstacle.shape
        if isinstance(shape, TrackShape) and (
            np.any(shape.covariance != 0.0) or np.any(shape.disturbance_covariance != 0.0)
        ):
            places[number] = len(shapes)
            shapes.append(shape)
    if not shapes:
        return None
    d = scenario.dimension
    one, none = np.eye(d), np.zeros((d, d))
    transition = np.block([[one, scenario.dt * one], [none, one]])
    initial = np.array([shape.covariance for shape in shapes])
    disturbances = np.array([shape.disturbance_covariance for shape in shapes])
    states = np.empty((len(shapes), scenario.horizon + 1, 2 * d, 2 * d))
    states[:, 0] = initial
    for k in range(scenario.horizon):
        moved = transition @ states[:, k] @ transition.T
        states[:, k + 1] = 0.5 * (moved + moved.swapaxes(1, 2)) + disturbances
    return Tracks(places, transition, initial, disturbances, states)
