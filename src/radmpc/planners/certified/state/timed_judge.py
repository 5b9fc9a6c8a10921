"""The referee as the search asks it: how long it takes, and about what it would say."""

from __future__ import annotations

import time

from radmpc.arrays import Matrix
from radmpc.planners.verdict import Judge, RoughJudge, Verdict

__all__ = ["TimedJudge", "estimate"]

_TELLING = (0.1, 4.0)
"""Multiples of Δ between which a certificate tells how much lower than roughly those of other plans
are [-]: among plans of `zigzag` and of `multi_square8` that is 0.17 to 0.22 and 0.22 to 0.29 (eight
of ten), where certificates are 0.1 to 4 Δ, and 0.12 to 0.30 among all."""


class TimedJudge:
    """The referee, how long it took, and about what it would say of other plans.

    Parameters
    ----------
    judge : callable
        The referee.
    risk_bound : float
        Δ [-].

    Attributes
    ----------
    seconds : float
        What a certificate took at most [s]: 5 ms of eight vehicles, a second of 200 drones.
    """

    def __init__(self, judge: Judge, risk_bound: float) -> None:
        self._judge = judge
        self._rough = judge.rough if isinstance(judge, RoughJudge) else None
        self._telling = _TELLING[0] * risk_bound, _TELLING[1] * risk_bound
        self._latest: tuple[tuple[Matrix, ...], float] | None = None
        self._ratio: float | None = None
        self.seconds = 0.0

    def __call__(self, controls: tuple[Matrix, ...]) -> Verdict:
        """Return the referee's verdict."""
        begun = time.perf_counter()
        verdict = self._judge(controls)
        self.seconds = max(self.seconds, time.perf_counter() - begun)
        if self._telling[0] <= verdict.certified <= self._telling[1]:
            self._latest = controls, verdict.certified
        return verdict

    def estimate(self, controls: tuple[Matrix, ...]) -> float | None:
        """Return about what the certificate is [-]; None where that is not known, or no quicker."""
        if self._rough is None:
            return None
        if self._latest is not None:
            latest, certified = self._latest
            self._ratio, self._latest = certified / max(self._rough(latest), certified), None
        return None if self._ratio is None else self._ratio * self._rough(controls)


def estimate(judge: Judge, controls: tuple[Matrix, ...]) -> float | None:
    """Return about what a judge would certify [-], if it tells quickly; else None.

    Parameters
    ----------
    judge : callable
        The referee.
    controls : tuple of (T, m) array
        Of every vehicle.
    """
    return judge.estimate(controls) if isinstance(judge, TimedJudge) else None
