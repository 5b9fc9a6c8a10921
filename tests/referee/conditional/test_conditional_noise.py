"""What is left of a certificate under all the noise there is, given all that is measured."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conditional_scenes import SCENES
from noisy_missions import check_charges, flown_noisily

from radmpc.referee.conditional import conditional as module
from radmpc.referee.conditional.conditional import witnesses_of

KINDS = ("steps", "intervals")


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
@pytest.mark.nightly
@pytest.mark.parametrize(("scene", "mutant"), MUTANTS)
def test_rows_are_charged_wrongly_by_who_mistakes_what_is_known(scene, mutant, monkeypatch):
    witnesses = witnesses_of(SCENES[scene]("intervals"))
    flown = flown_noisily(witnesses, 4_000, seed=8)
    mutant(monkeypatch)
    with pytest.raises(AssertionError, match="are charged"):
        check_charges(witnesses, flown, (0, 1, 2))
