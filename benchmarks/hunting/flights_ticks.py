"""What a decision under way may be: the account's arithmetic, and commands within their limits."""

from __future__ import annotations

import math

import numpy as np

import radmpc
from radmpc.flying.tick import Tick

__all__ = ["tick_problems"]

_CLOSE = 1e-9
"""Share by which numbers of the account may differ by rounding [-]."""


def tick_problems(
    mission: radmpc.Mission | radmpc.LongMission, tick: Tick, bank: float | None
) -> list[str]:
    """Return what is wrong with a decision.

    Parameters
    ----------
    mission : Mission or LongMission
        Who made it.
    tick : Tick
        The decision.
    bank : float or None
        What was in the bank before; None is not looked at.
    """
    found, entry = _control_problems(mission.scenario, tick), mission.account[-1]
    numbers = [tick.wealth, entry.tail, entry.bank, entry.wealth, tick.seconds]
    numbers += [x for x in (tick.value, tick.price, tick.next_step) if x is not None]
    if not all(math.isfinite(x) and x >= 0.0 for x in numbers):
        found.append(f"numbers that are none: {numbers}")
    if tick.choice not in {"tail", "candidate"} or not tick.reason or "\n" in tick.reason:
        found.append(f"choice {tick.choice!r}, reason {tick.reason!r}")
    if entry.wealth > tick.wealth * (1.0 + _CLOSE) + 1e-15:
        found.append(f"wealth {tick.wealth!r} became {entry.wealth!r}")
    is_kept = tick.choice == "tail"
    if not is_kept and (tick.price is None or tick.price > tick.wealth):
        found.append(f"price {tick.price} beside a wealth of {tick.wealth}")
    # An account that was opened anew promises what it does whatever was hit before.
    is_one = isinstance(mission, radmpc.Mission)
    has_failed = mission.has_failed if is_one else bool(mission.contacts)
    if not is_kept and has_failed:
        found.append("another leg after a contact")
    if is_kept and bank is not None and entry.bank != bank:
        found.append(f"kept, and the bank went from {bank!r} to {entry.bank!r}")
    if entry.step != tick.step or entry.what != ("kept" if is_kept else "adopted"):
        found.append(f"the account says {entry.what!r} at step {entry.step}")
    most = math.inf if tick.value is None else tick.value * 1.02 + _CLOSE
    if is_kept and tick.next_step is not None and tick.next_step > most:
        found.append(f"the next step runs {tick.next_step} of {tick.value}")
    return found


def _control_problems(scenario: radmpc.Scenario, tick: Tick) -> list[str]:
    """Return what is wrong with what vehicles are to do."""
    found = []
    if len(tick.segments) not in {0, len(scenario.vehicles)}:
        found.append(f"{len(tick.segments)} segments")
    for segment, vehicle in zip(tick.segments, scenario.vehicles, strict=False):
        control, most = segment.control, vehicle.control_limit
        norm = math.inf if vehicle.control_norm is None else vehicle.control_norm
        if not np.all(np.isfinite(control)) or np.any(np.abs(control) > most * (1.0 + _CLOSE)):
            found.append(f"{vehicle.name}: control {control.tolist()}, limit {most.tolist()}")
        if float(np.linalg.norm(control)) > norm * (1.0 + _CLOSE):
            found.append(f"{vehicle.name}: control {control.tolist()}, norm {norm}")
    return found
