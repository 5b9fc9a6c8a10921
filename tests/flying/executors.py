"""Executors that do what a test asks, and a planner that is quick and always the same."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any

import numpy as np

from radmpc.flying.leg import leg_of
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.program.build import condensed_models


def steering(scenario: Scenario, seconds: float | None) -> Plan:
    """Return the plan of least squares to where every vehicle should end, at rest."""
    del seconds
    controls = []
    for model in condensed_models(scenario):
        assert model.velocity is not None
        assert model.drift_velocity is not None
        rows = np.vstack([model.position[-1], model.velocity[-1]])
        idle = np.concatenate([model.drift_position[-1], model.drift_velocity[-1]])
        wanted = np.concatenate([model.vehicle.goal.center, np.zeros(scenario.dimension)])
        answer = np.linalg.lstsq(rows, wanted - idle, rcond=None)[0]
        controls.append(answer.reshape(model.control_bounds.shape))
    return leg_of(scenario, controls, 0).plan


class AtOnce(Executor):
    """Does everything when it is asked."""

    def __init__(self) -> None:
        self.asked = 0

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.asked += 1
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class Never(AtOnce):
    """Never does anything."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.asked += 1
        return Future()


class OneStepLate(AtOnce):
    """Does everything, and says so when it is asked the next time it could be."""

    def __init__(self) -> None:
        super().__init__()
        self.waiting: list[tuple[Future[Any], Callable[[], Any]]] = []

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.asked += 1
        future: Future[Any] = Future()
        self.waiting.append((future, lambda: fn(*args, **kwargs)))
        return future

    def catch_up(self) -> None:
        for future, work in self.waiting:
            future.set_result(work())
        self.waiting.clear()


class Broken(AtOnce):
    """Is of no use any more."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        raise RuntimeError("cannot schedule new futures after shutdown")
