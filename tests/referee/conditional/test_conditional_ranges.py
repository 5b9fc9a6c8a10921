"""What is left of a range that two keep to each other, given what has been measured."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from conditional_missions import MISSIONS, Missions, check_martingale, crowded, flown, row_failures
from estimating_missions import flown_estimating
from gusty_missions import flown_gustily, wind
from noisy_missions import SENSOR, ObservedMissions, check_charges, flown_noisily
from physical_scenes import craft, pd, still
from scipy.stats import norm

from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.model.plan import Plan
from radmpc.model.relations.keep import Keep
from radmpc.referee import certify
from radmpc.referee.conditional import conditional as module
from radmpc.referee.conditional.conditional import conditional, conditionals, witnesses_of
from radmpc.referee.conditional.rows import Parties, Witnesses

KINDS = ("steps", "intervals")
HORIZON = 4


def keeping(plan: Plan, within: float, *others: Keep) -> Plan:
    """Return a plan whose first two vehicles keep a range."""
    names = [v.name for v in plan.scenario.vehicles]
    keep = (Keep(names[:2], within), *others)
    return replace(plan, scenario=replace(plan.scenario, keep=keep))


def hovering(
    kind: str, *changes: dict[str, object], d: int = 2, samples: int | None = None
) -> Plan:
    """Return two that hover 3 m apart, one held by feedback, and one who only looks on."""
    system = double_integrator(1.0, d)
    a = craft("a", system, [0.0] * d, gain=pd(0.3, 0.9, d), noise=0.1)
    b = craft("b", system, [3.0, 0.4, 0.2][:d], noise=0.05)
    c = craft("c", system, [-9.0] * d, noise=0.05)
    fleet = [replace(v, **more) for v, more in zip((a, b), changes or ({}, {}), strict=True)]
    plan = still(*fleet, c, horizon=HORIZON, avoidance=kind, covariance_samples=samples)
    return keeping(plan, 3.5)


GUSTS = {"disturbance_correlation": 0.8}
SEES = {"measurement": SENSOR}
NEW = ({"shared": (wind(0.0),)}, {"shared": (wind(0.0, -0.7 * wind().matrix),)})
LASTING = ({"shared": (wind(),)}, {"shared": (wind(matrix=-0.7 * wind().matrix),), **GUSTS})
SENSED = ({**LASTING[0], **SEES}, LASTING[1])

SCENES = {
    "alone": hovering,
    "in space": lambda kind: hovering(kind, d=3),
    "passing": lambda kind: keeping(crowded(2, kind, noise=0.25), 8.9),
    "passing, no gain": lambda kind: keeping(crowded(2, kind, gain=False, noise=0.2), 8.9),
    "gusts": lambda kind: hovering(kind, GUSTS, {}),
    "estimates": lambda kind: hovering(kind, SEES, {}),
    "wind": lambda kind: hovering(kind, *NEW),
    "wind that lasts": lambda kind: hovering(kind, *LASTING),
    "estimates in a wind": lambda kind: hovering(kind, *SENSED),
    "known up to a factor": lambda kind: hovering(kind, samples=8),
}
MEASURED_ALIKE = ("alone", "in space", "passing", "passing, no gain")


@cache
def scene(name: str, kind: str) -> Witnesses:
    return witnesses_of(SCENES[name](kind))


@pytest.mark.slow
@pytest.mark.sampled(6)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", SCENES)
def test_before_anything_is_measured_the_value_of_a_range_is_its_certificate(name, kind):
    witnesses = scene(name, kind)
    value, certificate = conditional(witnesses, 0, None), certify(witnesses.plan)
    charged = sum(row.risk for row in certificate.ledger if row.cause == "range")
    assert charged > 1e-3
    assert value.total == pytest.approx(certificate.certified, rel=1e-7)
    # 1.6 % of Gaussians, and 0.1 % each way of the sum that stands for Student's t.
    assert value.total / 1.0195 <= value.least <= value.total


# A case so small that a page of arithmetic does.


def drifting(within: float, kind: str = "steps") -> Plan:
    """Return two without inertia, of whom one drifts off."""
    system = LinearSystem(np.eye(2), np.eye(2), (0, 1), None)
    fleet = [craft(n, system, place, radius=1e-3) for n, place in (("a", [0, 0]), ("b", [2, 1]))]
    fleet = [
        replace(v, initial_covariance=0.04 * np.eye(2), disturbance_covariance=own)
        for v, own in zip(fleet, (np.diag([0.09, 0.04]), [[0.05, 0.02], [0.02, 0.04]]), strict=True)
    ]
    plan = still(*fleet, horizon=2, avoidance=kind)
    controls = [np.zeros((2, 2)), np.array([[0.3, 0.1], [0.3, 0.2]])]
    paths = [replace(t, controls=u) for t, u in zip(plan.trajectories, controls, strict=True)]
    return keeping(replace(plan, trajectories=tuple(paths)), within)


def polygon_risks(within: float, mean: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Return what is outside of each side of polygons of 4, 8, 16 and 32 corners, added up."""
    sums = []
    for corners in (4, 8, 16, 32):
        turns = 2.0 * np.pi / corners * np.arange(corners)
        sides = np.column_stack([np.cos(turns), np.sin(turns)])
        room = within * np.cos(np.pi / corners) - sides @ mean
        sums.append(
            norm.sf(room / np.sqrt(np.einsum("fi,ij,fj->f", sides, covariance, sides))).sum()
        )
    return np.array(sums)


def test_what_is_left_of_a_range_is_what_a_page_of_arithmetic_says():
    within = 3.6
    plan = drifting(within)
    one, two = plan.scenario.vehicles
    added = one.disturbance_covariance + two.disturbance_covariance
    means = [np.array([-2.0, -1.0]), np.array([-2.3, -1.1]), np.array([-2.6, -1.3])]
    spread = [0.08 * np.eye(2) + k * added for k in range(3)]
    before = sum(polygon_risks(within, m, c) for m, c in zip(means, spread, strict=True))
    best = int(before.argmin())
    witnesses = witnesses_of(plan)
    apart = [row for row in certify(plan).ledger if row.cause == "pair"]
    others = sum(row.risk for row in apart)
    assert others < 1e-6 * before.min()
    assert conditional(witnesses, 0, None).total == pytest.approx(before[best], rel=1e-6)
    for seed in range(4):
        rng = np.random.default_rng(seed)
        states = [x[1] + rng.normal(0.0, 0.4, 2) for x in witnesses.motion.states]
        mean = states[0] - states[1] - [0.3, 0.2]
        due = polygon_risks(within, mean, added)[best]
        found = conditional(witnesses, 1, states)
        assert found.total == pytest.approx(due, rel=1e-6, abs=1e-9)
        assert found.next_step == pytest.approx(found.total)
        draws = rng.multivariate_normal(mean, added, 100_000)
        rate = np.mean(np.linalg.norm(draws, axis=1) > within)
        assert rate <= found.total + 1e-3


# Missions, many at once.


def relative(witnesses: Witnesses, missions: Missions, step: int) -> np.ndarray:
    """Return where the first of two is, seen from the other, (S, d)."""
    motion = witnesses.motion
    one, two = (
        motion.positions[i, step]
        + missions.states[i][step][:, list(witnesses.plan.scenario.vehicles[i].system.position)]
        for i in (0, 1)
    )
    return one - two


def lost(witnesses: Witnesses, missions: Missions, step: int) -> np.ndarray:
    """Return who is out of range at a step, or on the way from the one before, (S,)."""
    within = witnesses.plan.scenario.keep[0].within
    here = relative(witnesses, missions, step)
    out = np.linalg.norm(here, axis=1) > within
    if not witnesses.intervals or not step:
        return out
    before = relative(witnesses, missions, step - 1)
    bow = np.zeros_like(here)
    for i, sign in ((0, 1.0), (1, -1.0)):
        vehicle, path = witnesses.plan.scenario.vehicles[i], witnesses.plan.trajectories[i]
        asked = np.repeat(path.controls[step - 1][None], len(here), axis=0)
        if vehicle.gain is not None:
            asked = asked + missions.states[i][step - 1] @ vehicle.gain.T
        bow += sign * asked / 8.0
    for s in np.linspace(0.0, 1.0, 21):
        place = (1.0 - s) * before + s * here - 4.0 * s * (1.0 - s) * bow
        out |= np.linalg.norm(place, axis=1) > within
    return out


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["alone", "passing", "passing, no gain"])
def test_who_loses_a_range_fails_one_of_its_rows(name, kind):
    witnesses = scene(name, kind)
    missions = flown(witnesses, 2_000, seed=3)
    rows, parties = witnesses.halfspaces, witnesses.parties
    of_range = np.array([parties.causes[e] == "range" for e in rows.encounters])
    failed = row_failures(witnesses, missions)
    first = 1 if witnesses.intervals else 0
    count = 0
    for step in range(first, HORIZON + 1):
        out = lost(witnesses, missions, step)
        window = step - 1 if witnesses.intervals else step
        assert not (out & ~failed[of_range & (rows.windows == window)].any(axis=0)).any()
        count += int(out.sum())
    assert count > 5


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", MEASURED_ALIKE)
def test_the_conditional_value_of_a_range_is_a_martingale(name, kind):
    witnesses = scene(name, kind)
    check_martingale(witnesses, flown(witnesses, MISSIONS // 2, seed=7))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["alone"])
def test_ranges_lost_and_what_is_left_never_grow_on_average(name, kind):
    witnesses = scene(name, kind)
    # Nothing but the range goes wrong here.
    missions = flown(witnesses, MISSIONS, seed=9)
    out = np.zeros(MISSIONS, dtype=bool)
    last = conditional(witnesses, 0, None).total
    for step in range(HORIZON + 1):
        out |= lost(witnesses, missions, step)
        nominal = witnesses.motion.states
        states = [nominal[i][step] + path[step] for i, path in enumerate(missions.states)]
        now = np.where(out, 1.0, conditionals(witnesses, step, states).total)
        error = 4.0 * now.std() / np.sqrt(MISSIONS)
        assert now.mean() - error <= 1.017 * last
        last = min(last, now.mean() + error)
    assert out.mean() > 0.002


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("name", "fly"),
    [
        ("gusts", flown_noisily),
        ("estimates", flown_noisily),
        ("wind", flown_noisily),
        ("wind that lasts", flown_gustily),
        ("estimates in a wind", flown_estimating),
    ],
)
def test_ranges_are_lost_as_often_as_is_charged_given_what_is_known(name, fly, kind):
    witnesses = scene(name, kind)
    known: ObservedMissions = fly(witnesses, 3_000, seed=5)
    check_charges(witnesses, known, (0, 2, 3))


# Mutants: each is a mistake that is easily made.


def other_vehicle_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    right = module.halfspace_values

    def wrong(rows, parties, noise, *rest):
        if noise.step:
            rows = replace(rows, other=0.0 * rows.other, link_other=0.0 * rows.link_other)
        return right(rows, parties, noise, *rest)

    monkeypatch.setattr(module, "halfspace_values", wrong)


def ranges_taken_for_walls(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        Parties, "are_pairs", property(lambda self: np.array([c == "pair" for c in self.causes]))
    )


def measurement_ignored(monkeypatch: pytest.MonkeyPatch) -> None:
    right = module._deviations
    monkeypatch.setattr(module, "_deviations", lambda *given: 0.0 * right(*given))


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "mutant", [other_vehicle_forgotten, ranges_taken_for_walls, measurement_ignored]
)
def test_a_wrong_conditional_value_of_a_range_is_no_martingale(mutant, kind, monkeypatch):
    witnesses = scene("alone", kind)
    missions = flown(witnesses, 5_000, seed=8)
    mutant(monkeypatch)
    with pytest.raises(AssertionError, match="step"):
        check_martingale(witnesses, missions)


def test_a_range_hides_from_who_estimates_whether_it_is_lost():
    for name, hides in (("alone", False), ("estimates", True)):
        parties = scene(name, "steps").parties
        ranges = np.array([cause == "range" for cause in parties.causes])
        assert ranges.any()
        assert (parties.are_hidden[ranges] == hides).all()
        assert not parties.are_capped[ranges].any()
