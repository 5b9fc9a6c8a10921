"""The referee's simulation and certificates against a second simulator, which draws in loops."""

from __future__ import annotations

from physical import fly
from physical_scenes import KINDS, unclipped
from scipy.stats import binomtest, fisher_exact

from radmpc.model.plan import Plan
from radmpc.referee import certify, simulate


def check_counts(plan: Plan, missions: int, false_alarm: float, told: str = "collisions") -> None:
    """Assert that both simulators count alike, of every kind, and that what is told happens."""
    expected = fly(plan, missions, seed=1)
    found = simulate(plan, missions, rng=2)
    # Rates that tell: a scene in which nothing ever happens would agree with anything.
    assert 0.01 * missions < getattr(expected, told) < 0.9 * missions
    for kind in KINDS:
        counts = [getattr(expected, kind), getattr(found, kind)]
        table = [counts, [missions - count for count in counts]]
        assert fisher_exact(table).pvalue > false_alarm, (kind, counts)


def check_certificate(plan: Plan, missions: int, most: float | None = 2.5) -> None:
    """Assert that a certificate is not below the second simulator's rate, nor far above it."""
    plan = unclipped(plan)
    flown = fly(plan, missions, seed=3)
    interval = binomtest(flown.collisions, missions).proportion_ci(1 - 2e-4, "exact")
    certificate = certify(plan)
    assert flown.saturated == 0
    assert not certificate.problems
    assert certificate.certified >= interval.low
    if most is not None:
        assert certificate.certified <= most * interval.high
