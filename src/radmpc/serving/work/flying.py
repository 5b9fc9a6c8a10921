"""A plan flown in a worker, tick by tick as fast as the page wants to see it."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from radmpc.flying.backends import backend_named
from radmpc.flying.recording.campaign import check_replan
from radmpc.flying.recording.recorded import RecordedMission
from radmpc.io.flight.flight_file import FlightWriter
from radmpc.io.flight.record import FlightSettings, TickRow
from radmpc.model.plan import Plan
from radmpc.serving.views.flight import tick_view
from radmpc.serving.work.asking import check_flight
from radmpc.serving.work.control import Control

__all__ = ["fly_plan"]

_GLANCE = 0.05
"""Seconds between two looks at whether to end, while nothing is to be done [s]."""


def fly_plan(
    control: Control, plan: Plan, seed: int, pace: float, options: Mapping[str, Any]
) -> str:
    """Fly one mission.

    Parameters
    ----------
    control : Control
        Receives every ``tick``; asked whether to end.
    plan : Plan
        With trajectories.
    seed : int
        Of the noise and of every plan.
    pace : float
        Seconds from tick to tick at least [s]; 0 is as fast as it goes.
    options : mapping
        ``with``, ``replan`` (``none`` flies the plan as it is), ``deadline`` and ``log``, all of
        them optional.

    Returns
    -------
    str
        How it ended.

    Raises
    ------
    RadmpcError
        If the plan cannot be flown, or not with this backend.
    """
    check_flight(options)
    name = options.get("with") or "model"
    replan = options.get("replan") or "certified"
    settings = FlightSettings(
        name, None if replan == "none" else replan, 1, seed, options.get("deadline")
    )
    check_replan(plan.scenario, settings)
    path = options.get("log")
    if path is None:
        return _flown(control, plan, settings, None, pace)
    with FlightWriter.begin(path, plan, settings, {}) as writer:
        return _flown(control, plan, settings, writer, pace)


def _flown(
    control: Control,
    plan: Plan,
    settings: FlightSettings,
    writer: FlightWriter | None,
    pace: float,
) -> str:
    """Fly the mission: every tick is on the disk, where there is a log, before it is flown."""
    scenario = plan.scenario

    def tell(row: TickRow) -> None:
        if writer is not None:
            writer.append(row)
        control.tell("tick", tick_view(row, scenario, scenario.risk_bound))

    mission = RecordedMission(plan, 0, tell, planner=settings.replan, seed=settings.seed)
    backend = backend_named(settings.backend).make(
        scenario, np.random.default_rng([settings.seed, 0])
    )
    try:
        states, contacts = backend.reset()
        while not mission.is_over and not control.is_stopped():
            due = time.monotonic() + pace
            tick = mission.step(states, deadline=settings.deadline, contacts=contacts)
            if tick.segments:
                states, contacts = backend.advance(tick.segments)
            while time.monotonic() < due and tick.segments and not control.is_stopped():
                time.sleep(min(_GLANCE, max(due - time.monotonic(), 0.0)))
    finally:
        close = getattr(backend, "close", None)
        if callable(close):
            close()
    if not mission.is_over:
        return "stopped"
    hits = len(mission.contacts)
    adopted = sum(entry.what == "adopted" for entry in mission.account)
    plans = "1 new plan" if adopted == 1 else f"{adopted} new plans"
    met = "no collision" if not hits else "1 collision" if hits == 1 else f"{hits} collisions"
    return f"flown to its end: {met}, {plans} adopted"
