"""Scenes under every kind of noise, one by one and all together."""

from __future__ import annotations

from dataclasses import replace

from noisy_missions import SENSOR, noisy, wind
from physical_scenes import DI, craft, pd, still

from radmpc.model.plan import Plan


def blown_together(kind: str) -> Plan:
    """Return two that hover side by side, and that one wind blows at each other."""
    a = replace(craft("a", DI, [0, 0], gain=pd(0.3, 0.9), noise=0.05), shared=wind())
    b = replace(craft("b", DI, [1.6, 0.2], noise=0.05), shared=wind(-0.7))
    return still(a, b, horizon=4, avoidance=kind)


GUSTS = {"disturbance_correlation": 0.8}
BLIND = {"measurement": SENSOR}
BOTH = {**GUSTS, **BLIND}
SCENES = {
    "strays": lambda kind: noisy(kind, strays=True),
    "strays, no gain": lambda kind: noisy(kind, strays=True, gain=False, noise=0.15),
    "gusts": lambda kind: noisy(kind, GUSTS, {"disturbance_correlation": 0.4}),
    "shared": blown_together,
    "estimates": lambda kind: noisy(kind, BLIND, BLIND, noise=0.2),
    "all": lambda kind: noisy(kind, BOTH, GUSTS, strays=True, noise=0.12),
}
