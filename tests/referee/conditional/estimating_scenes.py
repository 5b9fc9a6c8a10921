"""Vehicles that share disturbances and estimate their states."""

from __future__ import annotations

from dataclasses import replace

from gusty_missions import GUST, TURNED, shaken, side_by_side, swell, wind
from noisy_missions import SENSOR
from physical_scenes import DI, craft, pd, still, wall

from radmpc.model.noise.measurement import Measurement
from radmpc.model.plan import Plan

SEES = {"measurement": SENSOR}


def blown(kind: str) -> Plan:
    """A wind that lasts; one estimates where it is, the other knows."""
    return side_by_side(
        kind, {"shared": (wind(),), **SEES}, {"shared": (wind(matrix=-0.7 * TURNED), swell(0.0))}
    )


def new_wind(kind: str) -> Plan:
    """A wind that is new at every step: it ties errors of estimates, too."""
    return side_by_side(
        kind, {"shared": (wind(0.0),), **SEES}, {"shared": (wind(0.0, -TURNED),), **SEES}
    )


def all_at_once(kind: str) -> Plan:
    return side_by_side(
        kind,
        {"shared": (swell(0.6), wind()), "disturbance_correlation": 0.7, **SEES},
        {"shared": (wind(matrix=-0.7 * TURNED), swell(0.6)), **SEES},
    )


def close(kind: str) -> Plan:
    """Two that see little of the wind, and little of where they are."""
    fleet = [
        replace(shaken(craft(name, DI, place, radius=3.0), 0.05), shared=(wind(0.95, m),), **SEES)
        for name, place, m in (("a", [0, 0], GUST), ("b", [-8.5, 0.2], -0.7 * GUST))
    ]
    return still(*fleet, horizon=4, avoidance=kind)


def told_by_another(kind: str) -> Plan:
    """One that estimates where it is, at a wall; another, far away, sees the wind."""
    blind = replace(shaken(craft("a", DI, [0, 0]), 0.2), **SEES)
    quiet = shaken(craft("b", DI, [-50.0, 0.2]), 0.01)
    fleet = (replace(v, shared=(wind(0.95),)) for v in (blind, quiet))
    return still(*fleet, horizon=4, avoidance=kind, obstacles=(wall(1.5),))


def at_a_wall(kind: str) -> Plan:
    """One that steers hard after what it believes, beside a wall; another sees what blows it."""
    blind = craft("a", DI, [0, 0], gain=pd(0.5, 1.2))
    blind = replace(shaken(blind, 0.1), measurement=Measurement.of([0, 1], 4, 0.3))
    quiet = shaken(craft("b", DI, [-50.0, 0.2]), 0.01)
    fleet = (replace(v, shared=(wind(0.95),)) for v in (blind, quiet))
    return still(*fleet, horizon=4, avoidance=kind, obstacles=(wall(1.2),))


SCENES = {
    "at a wall": at_a_wall,
    "blown": blown,
    "new wind": new_wind,
    "all at once": all_at_once,
    "close": close,
    "told by another": told_by_another,
}
