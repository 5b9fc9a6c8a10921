"""Planners that are asked under way and are not to be trusted: broken, late, greedy, malicious."""

from __future__ import annotations

from concurrent.futures import Executor, Future
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import radmpc
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario

__all__ = ["Instant", "Ticking", "Vandal", "quick"]

_LIMIT = 0.25
"""Seconds for a plan under way: scenes are small."""


def quick(scenario: Scenario, seconds: float | None) -> object:
    """Plan as missions do, for a moment at most."""
    limit = _LIMIT if seconds is None else min(seconds, _LIMIT)
    return radmpc.plan(scenario, rng=0, time_limit=limit)


class Instant(Executor):
    """Works on what it is given at once; now and then refuses, or loses it."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Work, or not."""
        kind, future = self._rng.random(), Future[Any]()
        if kind < 0.05:
            raise RuntimeError("the executor is shut down")
        if kind < 0.1:
            future.cancel()
            return future
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


@dataclass(slots=True)
class Ticking:
    """A clock that moves on by itself, and by what a planner takes.

    Attributes
    ----------
    now : float
        Its time [s].
    step : float
        By which it moves on whenever it is read [s].
    """

    now: float = 0.0
    step: float = 0.0

    def __call__(self) -> float:
        """Return the time."""
        self.now += self.step
        return self.now


class Vandal:
    """Returns anything but what was asked for, and sometimes that.

    Parameters
    ----------
    rng : Generator
        Decides what.
    first : Plan
        Of the whole mission.
    clock : Ticking or None
        That it keeps from standing still.
    """

    def __init__(self, rng: np.random.Generator, first: Plan, clock: Ticking | None = None) -> None:
        self._rng, self._first, self._clock = rng, first, clock

    def __call__(self, scenario: Scenario, seconds: float | None) -> Any:
        """Return something."""
        if self._clock is not None:
            self._clock.now += float(self._rng.choice([0.0, 0.01, 1.0]))
        kind = int(self._rng.integers(14))
        if kind == 0:
            raise ValueError("two\nlines")
        if kind == 1:
            raise RecursionError
        if kind <= 3:
            return [None, "a plan", self._first, 17][int(self._rng.integers(4))]
        if kind == 4:
            # As much risk as any scenario may take.
            return quick(replace(scenario, risk_bound=0.49), seconds)
        found = quick(scenario, seconds)
        plan = found.record
        if kind <= 7 or not plan.trajectories:
            return found
        return self._spoiled(plan, kind)

    def _spoiled(self, plan: Plan, kind: int) -> Plan:
        """Return a plan with something wrong in it."""
        paths = list(plan.trajectories)
        which = int(self._rng.integers(len(paths)))
        path = paths[which]
        if kind == 8:
            del paths[which]
        elif kind == 9:
            paths[which] = replace(path, controls=path.controls[:-1])
        elif kind == 10:
            paths = paths[::-1]
        elif kind == 11:
            scale = float(self._rng.choice([1.0 + 1e-7, 1.1, 1e6, 1e90, 1e200]))
            paths[which] = replace(path, controls=path.controls * scale)
        elif kind == 12:
            noise = self._rng.normal(0.0, float(self._rng.choice([1e-9, 1e-3, 1.0])))
            paths[which] = replace(path, controls=path.controls + noise)
        else:
            paths[which] = replace(path, means=path.means + 5.0, covariances=0.0 * path.covariances)
        return replace(plan, trajectories=tuple(paths))
