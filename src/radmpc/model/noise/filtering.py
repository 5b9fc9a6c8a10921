"""What a vehicle's measurements tell of its state, and of its disturbance, step by step."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.dynamics import LinearSystem
from radmpc.model.noise.spread import Noise, chain_of, known_rows, learning
from radmpc.model.noise.unlearned import unlearned
from radmpc.records import dataclass

__all__ = ["Learning", "learning_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Learning:
    """What measurements tell of a vehicle's state and of its disturbance, at k = 0..T.

    Attributes
    ----------
    gains : tuple of (2 n + s, p) array
        The filter's: what it makes of the difference between measured and expected, for the state,
        the vehicle's own disturbance and those it shares and that last.
    unknown : tuple of (q, q) array
        Covariance of what is not known, once measured; of all that is shared, too.
    corrections : tuple of (n, n) array
        Covariance of what a measurement adds to the estimate of the state.
    """

    gains: tuple[Matrix, ...]
    unknown: tuple[Matrix, ...]
    corrections: tuple[Matrix, ...]

    def carried(self, step: int, moved: Vector) -> Vector:
        """Return what an estimate that moved tells of the disturbances that follow, (n + s,).

        Parameters
        ----------
        step : int
            0..T.
        moved : (n,) array
            By how much the estimate of the state differs from what was expected.
        """
        return np.asarray(self.gains[step][moved.size :] @ self.surprise(step, moved))

    def surprise(self, step: int, moved: Vector) -> Vector:
        """Return by how much what was measured differed from what was expected, (p,).

        Parameters
        ----------
        step : int
            0..T.
        moved : (n,) array
            By how much the estimate of the state differs from what was expected. What does not move
            it tells nothing: of that the least is taken.
        """
        found, *_ = np.linalg.lstsq(self.gains[step][: moved.size], moved, rcond=1e-10)
        return np.asarray(found)


def learning_of(system: LinearSystem, noise: Noise, horizon: int) -> Learning:
    """Return what a vehicle's measurements tell of it; where none are stated, the state exactly.

    Parameters
    ----------
    system : LinearSystem
        The dynamics.
    noise : Noise
        What shakes it.
    horizon : int
        Number of steps T.
    """
    from radmpc.model.noise.measurement import Measurement  # noqa: PLC0415 - few measure

    n = system.num_states
    sensor = noise.measurement
    exact = sensor is None
    if sensor is None:
        sensor = Measurement(np.eye(n), np.zeros((n, n)))
    chain, rows = chain_of(system, noise, None), known_rows(noise)
    ahead = chain.initial
    gains, unknown, corrections = [], [], []
    for k in range(horizon + 1):
        if k == 0 and noise.belief is not None:
            gained = np.zeros((len(ahead), len(sensor.matrix)))
            learned = np.zeros_like(ahead)
        else:
            seen, gained = learning(sensor, ahead)
            learned = gained @ seen
        left = unlearned(ahead, learned)
        if exact:
            # To the last digit: rounding is not learned of.
            left[:n] = left[:, :n] = 0.0
        gains.append(gained[rows])
        corrections.append(learned[:n, :n])
        unknown.append(left)
        ahead = chain.free @ unknown[-1] @ chain.free.T + chain.fresh
        ahead = 0.5 * (ahead + ahead.T)
    return Learning(tuple(gains), tuple(unknown), tuple(corrections))
