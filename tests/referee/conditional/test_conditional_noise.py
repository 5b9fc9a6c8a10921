"""What is left of a certificate under all the noise there is, given all that is measured."""

from __future__ import annotations

from dataclasses import replace

import pytest
from noisy_missions import SENSOR, check_charges, flown_noisily, noisy, wind
from physical_scenes import DI, craft, pd, still

from radmpc.model.plan import Plan
from radmpc.referee import certify
from radmpc.referee.conditional import conditional as module
from radmpc.referee.conditional.conditional import conditional, witnesses_of


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
KINDS = ("steps", "intervals")


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scene", SCENES)
def test_before_anything_is_measured_the_value_is_the_certificate(scene, kind):
    plan = SCENES[scene](kind)
    value = conditional(witnesses_of(plan), 0, None)
    assert value.total == pytest.approx(certify(plan).certified, rel=1e-7)
    assert value.total / 1.0171 <= value.least <= value.total


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scene", SCENES)
def test_rows_fail_as_often_as_they_are_charged_for_given_what_is_known(scene, kind):
    witnesses = witnesses_of(SCENES[scene](kind))
    flown = flown_noisily(witnesses, 4_000, seed=7)
    check_charges(witnesses, flown, (0, 2, 3))


# Mutants: each is a mistake that is easily made.


def places_taken_for_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    right = module.halfspace_values

    def wrong(rows, parties, noise, *rest):
        if noise.step:
            rows = replace(rows, fresh=0.5 * rows.fresh, link_fresh=0.5 * rows.link_fresh)
        return right(rows, parties, noise, *rest)

    monkeypatch.setattr(module, "halfspace_values", wrong)


def gusts_taken_for_new(monkeypatch: pytest.MonkeyPatch) -> None:
    right = module._deviations

    def wrong(*given):
        found = right(*given).copy()
        found[:, :, 4:] = 0.0
        return found

    monkeypatch.setattr(module, "_deviations", wrong)


def gusts_taken_for_each_ones_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "together", lambda noise, *_: noise)


def estimates_taken_for_the_truth(monkeypatch: pytest.MonkeyPatch) -> None:
    right = module.since

    def wrong(loops, *given, **named):
        return right(replace(loops, unknown=0.0 * loops.unknown), *given, **named)

    monkeypatch.setattr(module, "since", wrong)


MUTANTS = [
    ("strays, no gain", places_taken_for_measured),
    ("gusts", gusts_taken_for_new),
    ("shared", gusts_taken_for_each_ones_own),
    ("estimates", estimates_taken_for_the_truth),
]


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize(("scene", "mutant"), MUTANTS)
def test_rows_are_charged_wrongly_by_who_mistakes_what_is_known(scene, mutant, monkeypatch):
    witnesses = witnesses_of(SCENES[scene]("intervals"))
    flown = flown_noisily(witnesses, 4_000, seed=8)
    mutant(monkeypatch)
    with pytest.raises(AssertionError, match="are charged"):
        check_charges(witnesses, flown, (0, 1, 2))
