"""What is left of a certificate in gusts that last and are shared, given what all have measured."""

from __future__ import annotations

import numpy as np
import pytest
from gusty_missions import (
    SCENES,
    conditioned,
    drawn,
    flown_gustily,
    known_of,
    remembers,
    rows_of,
    seen_by_another,
)
from noisy_missions import ObservedMissions, check_charges

from radmpc.flying.knowing import expected_start, known_after, moved
from radmpc.flying.sensing.observing import Observer
from radmpc.model.noise.fleet import fleet_learning
from radmpc.referee.conditional import loops
from radmpc.referee.conditional.conditional import witnesses_of
from radmpc.referee.conditional.gusts import Gusts, gusts_of
from radmpc.referee.conditional.rows import Witnesses
from sampling import IS_THOROUGH

KINDS = ("steps", "intervals")

FEW = 20_000 if IS_THOROUGH else 1_500
"""Missions: nightly those that tell small mistakes, too."""
STEPS = range(5)


@pytest.mark.parametrize("scene", SCENES)
def test_the_law_of_what_lasts_is_that_of_brute_force_conditioning(scene):
    fleet = SCENES[scene]("steps").scenario.vehicles
    members = [i for i, v in enumerate(fleet) if v.shared and remembers(v)]
    rows = rows_of(fleet)
    for step in STEPS:
        _, covariance = conditioned(fleet, step)
        learned, gusts = fleet_learning(fleet, 4), gusts_of(fleet, 12)
        root, left = learned.root(step), gusts.left_open(step)
        for i in members:
            for j in members:
                due = covariance[np.ix_(rows[i], rows[j])]
                # Of noise of one's own that is new at every step nothing is known.
                lasts = [slice(0 if fleet[k].disturbance_correlation else 4, None) for k in (i, j)]
                due = due[lasts[0], lasts[1]]
                mine, other = root[i][4:][lasts[0]], root[j][4:][lasts[1]]
                np.testing.assert_allclose(mine @ other.T, due, atol=1e-12)
                both = (left[i] @ left[j].T)[4:, 4:][: due.shape[0], : due.shape[1]]
                np.testing.assert_allclose(both, due, atol=1e-12)


@pytest.mark.parametrize("scene", SCENES)
def test_what_is_expected_to_last_is_what_brute_force_conditioning_says(scene):
    scenario = SCENES[scene]("steps").scenario
    fleet, rng = scenario.vehicles, np.random.default_rng(3)
    observer = Observer.of(scenario)
    expected = [expected_start(v) for v in fleet]
    states = [v.start + rng.normal(0.0, 0.1, v.start.size) for v in fleet]
    ends = np.cumsum([0, *(v.start.size for v in fleet)])
    added: list[np.ndarray] = []
    for step in STEPS:
        known = observer.observed(step, expected, states)
        due = known_of(fleet, np.array(added).reshape(step, 1, ends[-1]))
        for v, each, state, rest in zip(fleet, known, states, due, strict=True):
            np.testing.assert_array_equal(each[:4], state)
            if remembers(v):
                np.testing.assert_allclose(each[4:], rest[0], atol=1e-10)
        # What moves all of them must be possible: where one wind is all there is, nothing else is.
        takes = drawn(fleet, 1, 1, rng)[0, 0]
        added.append(takes)
        controls = [rng.normal(size=2) for _ in fleet]
        states = [
            moved(v, np.concatenate([x, 0.0 * each[4:]]), u)[:4] + takes[a:b]
            for v, x, each, u, a, b in zip(
                fleet, states, known, controls, ends[:-1], ends[1:], strict=True
            )
        ]
        expected = [moved(v, each, u) for v, each, u in zip(fleet, known, controls, strict=True)]


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scene", SCENES)
def test_rows_fail_as_often_as_they_are_charged_for_given_what_all_know(scene, kind):
    witnesses = witnesses_of(SCENES[scene](kind))
    check_charges(witnesses, flown_gustily(witnesses, FEW, seed=7), (1, 3))


def as_another_sees(flown: ObservedMissions) -> list[np.ndarray]:
    """Return what is known of the wind's strength along x at every step."""
    return [known[:, 8] for known in flown.known[1]]


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_rows_fail_as_often_as_they_are_charged_for_whatever_another_sees_of_the_wind(kind):
    witnesses = witnesses_of(seen_by_another(kind))
    flown = flown_gustily(witnesses, 4_000, seed=7)
    check_charges(witnesses, flown, (1, 2), as_another_sees(flown))


# Mutants: each is a mistake that is easily made.


class Alone:
    """A filter for each vehicle, which hears of no others."""

    def __init__(self, vehicles, size):
        self.members = tuple(i for i, vehicle in enumerate(vehicles) if vehicle.shared)
        self.each = [gusts_of([vehicle], size) for vehicle in vehicles]

    def left_open(self, step):
        roots = [one.left_open(step)[0] for one in self.each if one is not None]
        ends = np.cumsum([0, *(root.shape[1] for root in roots)])
        found = np.zeros((len(self.each), len(roots[0]), ends[-1]))
        at = [i for i, one in enumerate(self.each) if one is not None]
        for i, root, start, end in zip(at, roots, ends[:-1], ends[1:], strict=True):
            found[i, :, start:end] = root
        return found


@pytest.mark.slow
def test_a_filter_for_each_vehicle_charges_too_little_when_another_sees_the_wind_come(monkeypatch):
    monkeypatch.setattr(loops, "gusts_of", Alone)
    witnesses = witnesses_of(seen_by_another("steps"))
    # Each of them is right by what it knows itself ...
    flown = flown_gustily(witnesses, 4_000, seed=7, alone=True)
    check_charges(witnesses, flown, (1, 2))
    # ... and wrong by what the other knows.
    with pytest.raises(AssertionError, match="are charged"):
        check_charges(witnesses, flown, (1, 2), as_another_sees(flown))


def gusts_taken_for_new(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Gusts, "left_open", lambda self, step: right_open(self, 0))


def gusts_taken_for_known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Gusts, "left_open", lambda self, step: 0.0 * right_open(self, step))


def gusts_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take what is not known of one vehicle for independent of what is not known of another."""
    right = loops.since

    def wrong(*given, **named):
        return loops.replace(right(*given, **named), roots=None)

    monkeypatch.setattr("radmpc.referee.conditional.conditional.since", wrong)


right_open = Gusts.left_open
MUTANTS = [gusts_taken_for_new, gusts_taken_for_known, gusts_apart]


def close_together() -> Witnesses:
    """Two that one wind that nobody sees blows at each other."""
    return witnesses_of(SCENES["blind"]("steps"))


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("mutant", MUTANTS)
def test_rows_are_charged_wrongly_by_who_mistakes_what_is_known(mutant, monkeypatch):
    witnesses = close_together()
    flown = flown_gustily(witnesses, 4_000, seed=8)
    check_charges(witnesses, flown, (0, 1, 2))
    mutant(monkeypatch)
    with pytest.raises(AssertionError, match="are charged"):
        check_charges(close_together(), flown, (0, 1, 2))


def test_what_plans_begin_with_is_what_is_known_of_all_together():
    """Between two vehicles, too: that is what no vehicle's own covariance tells."""
    scenario = SCENES["all lasting"]("steps").scenario
    means = [expected_start(v) for v in scenario.vehicles]
    first, second, alone = known_after(scenario, 2, means)
    _, covariance = conditioned(scenario.vehicles, 2)
    rows = rows_of(scenario.vehicles)
    due = covariance[np.ix_(rows[0], rows[1])]
    np.testing.assert_allclose((first.common @ second.common.T)[4:, 4:], due, atol=1e-12)
    assert np.abs(due).max() > 1e-3
    assert alone.common is None
