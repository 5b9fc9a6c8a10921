"""What a vehicle's measurements tell of its state, and of its disturbance, step by step."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.dynamics import LinearSystem
from radmpc.model.noise.spread import Noise, chain_of, learning
from radmpc.records import dataclass

__all__ = ["Learning", "learning_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Learning:
    """What measurements tell of a vehicle's state and of its disturbance, at k = 0..T.

    Attributes
    ----------
    gains : tuple of (2 n, p) array
        The filter's: what it makes of the difference between measured and expected.
    unknown : tuple of (2 n, 2 n) array
        Covariance of what is not known, once measured.
    told : tuple of (n, n) array
        Covariance of what a measurement adds to the estimate of the state.
    """

    gains: tuple[Matrix, ...]
    unknown: tuple[Matrix, ...]
    told: tuple[Matrix, ...]

    def carried(self, step: int, moved: Vector) -> Vector:
        """Return what an estimate that moved tells of the disturbance that follows, (n,).

        Parameters
        ----------
        step : int
            0..T.
        moved : (n,) array
            By how much the estimate of the state differs from what was expected.
        """
        gain = self.gains[step]
        of_state, of_rest = np.split(gain, 2)
        found, *_ = np.linalg.lstsq(of_state, moved, rcond=1e-10)
        return np.asarray(of_rest @ found)


def learning_of(system: LinearSystem, noise: Noise, horizon: int) -> Learning:
    """Return what a vehicle's measurements tell of it; where none are stated, the state exactly.

    Parameters
    ----------
    system : LinearSystem
        The dynamics.
    noise : Noise
        What shakes it; nothing shared.
    horizon : int
        Number of steps T.
    """
    from radmpc.model.noise.measurement import Measurement  # noqa: PLC0415 - few measure

    n = system.num_states
    sensor = noise.measurement
    exact = sensor is None
    if sensor is None:
        sensor = Measurement(np.eye(n), np.zeros((n, n)))
    chain = chain_of(system, noise, None)
    ahead = chain.initial
    gains, unknown, told = [], [], []
    for k in range(horizon + 1):
        if k == 0 and noise.known is not None:
            gained = np.zeros((len(ahead), len(sensor.matrix)))
            learned = np.zeros_like(ahead)
        else:
            seen, gained = learning(sensor, ahead)
            learned = gained @ seen
        left = ahead - learned
        if exact:
            # To the last digit: rounding is not learned of.
            left[:n] = left[:, :n] = 0.0
        gains.append(gained)
        told.append(learned[:n, :n])
        unknown.append(0.5 * (left + left.T))
        ahead = chain.free @ unknown[-1] @ chain.free.T + chain.fresh
        ahead = 0.5 * (ahead + ahead.T)
    return Learning(tuple(gains), tuple(unknown), tuple(told))
