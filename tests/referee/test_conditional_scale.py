"""What is left of a certificate where measurements tell of the factor of covariances, too."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conditional_missions import Missions, check_martingale, crowded, flown
from physical_scenes import DI, craft, still, wall
from scipy.stats import norm
from scipy.stats import t as student

from radmpc.errors import ArgumentError
from radmpc.model.plan import Plan
from radmpc.referee import gather
from radmpc.referee.conditional import conditional as module
from radmpc.referee.conditional.conditional import conditional, conditionals, witnesses_of
from radmpc.referee.conditional.far import closer_of
from radmpc.referee.conditional.rows import Witnesses
from radmpc.referee.conditional.scales import Scale, squares_of
from radmpc.referee.tails import cutoff_of

FEW = 4
"""Samples, so few that a step of two vehicles tells more than all of them."""


def unsure(plan: Plan, samples: int) -> Plan:
    return replace(plan, scenario=replace(plan.scenario, covariance_samples=samples))


MISSIONS = {"steps": 6_000, "intervals": 500}
"""How many are flown: along intervals nearly all rows are charged without another: it is slow."""


# The law itself, against whoever draws many factors and keeps those that explain what was seen.


def beside_a_wall() -> Witnesses:
    vehicle = craft("a", DI, [0.0, 0.0])
    spread = np.array([0.04, 0.03, 0.01, 0.02])
    vehicle = replace(vehicle, initial_covariance=spread, disturbance_covariance=0.5 * spread)
    plan = still(vehicle, obstacles=(wall(1.0),), horizon=4, avoidance="steps")
    return witnesses_of(unsure(plan, FEW))


def weighted_rate(witnesses: Witnesses, seen: np.ndarray, draws: int) -> tuple[float, float]:
    """Return how often rows to come fail given disturbances until now, and the standard error.

    Factors are drawn as stated, and weighed by how likely they make what was seen; then the rest of
    the mission is drawn for each.
    """
    rng = np.random.default_rng(5)
    vehicle = witnesses.plan.scenario.vehicles[0]
    A, horizon = vehicle.system.A, witnesses.plan.scenario.horizon
    factors = FEW / rng.chisquare(FEW, draws)
    deviations = np.sqrt(np.diagonal(vehicle.disturbance_covariance))
    first = np.sqrt(np.diagonal(vehicle.initial_covariance))
    logs = np.zeros(draws)
    for k, noise in enumerate(seen):
        own = (first if k == 0 else deviations) * np.sqrt(factors)[:, None]
        logs += norm.logpdf(noise, 0.0, own).sum(axis=1)
    weights = np.exp(logs - logs.max())
    state = np.zeros(4)
    for noise in seen:
        state = A @ state + noise
    path = np.repeat(state[None], draws, axis=0)
    rows = witnesses.halfspaces
    count = np.zeros(draws)
    for k in range(len(seen), horizon + 1):
        fresh = rng.normal(size=(draws, 4)) * deviations * np.sqrt(factors)[:, None]
        path = path @ A.T + fresh
        for e in np.flatnonzero(rows.windows == k):
            count += path[:, :2] @ rows.normals[e] < -rows.margins[e]
    mean = float(np.average(count, weights=weights))
    error = np.sqrt(np.sum((weights * (count - mean)) ** 2)) / weights.sum()
    return mean, float(error)


def told(witnesses: Witnesses, seen: np.ndarray) -> Scale:
    """Return what disturbances tell, by the formula as it stands in the documentation."""
    vehicle = witnesses.plan.scenario.vehicles[0]
    covariances = [vehicle.initial_covariance] + [vehicle.disturbance_covariance] * (len(seen) - 1)
    total = sum(float(w @ np.linalg.solve(c, w)) for w, c in zip(seen, covariances, strict=True))
    return Scale(FEW + seen.size, (FEW + total) / (FEW + seen.size))


SEEN = [
    np.array([[0.3, -0.1, 0.05, -0.2]]),
    np.array([[0.1, -0.1, 0.05, -0.1], [0.35, 0.3, 0.1, 0.2]]),
    np.array([[0.12, 0.31, 0.05, 0.03], [0.05, -0.03, 0.02, 0.03]]),
]


@pytest.mark.parametrize("seen", SEEN)
def test_rows_fail_given_what_was_measured_as_missions_that_explain_it_do(seen: np.ndarray) -> None:
    witnesses = beside_a_wall()
    scale, state = told(witnesses, seen), np.zeros(4)
    for noise in seen:
        state = witnesses.plan.scenario.vehicles[0].system.A @ state + noise
    step = len(seen) - 1
    at = [witnesses.motion.states[0][step] + state]
    rate, error = weighted_rate(witnesses, seen, 150_000)
    value = conditional(witnesses, step, at, scale)
    assert value.total == pytest.approx(rate, abs=4.0 * error)
    assert error < 0.05 * rate
    # Who learns half of it is off.
    for wrong in (Scale(FEW), Scale(FEW, scale.factor), Scale(scale.samples)):
        assert abs(conditional(witnesses, step, at, wrong).total - rate) > 6.0 * error


def test_what_is_learned_step_by_step_is_what_is_learned_at_once() -> None:
    squares, components = np.array([3.0, 0.2, 7.5]), [2, 4, 3]
    now = Scale(5)
    for d, n in zip(squares, components, strict=True):
        now = now.learned(float(d), n)
    once = Scale(5).learned(float(squares.sum()), sum(components))
    assert (now.samples, now.factor) == (once.samples, pytest.approx(once.factor))
    later = Scale(5).learned(3.0, 2)
    # Beside covariances that hold what was known by then, only what came since counts.
    began = Scale(later.samples)
    assert now.since(later).factor == pytest.approx(
        began.learned(7.7 / float(later.factor), 7).factor
    )
    assert Scale(None).learned(3.0, 2).samples is None


def test_directions_without_noise_tell_nothing() -> None:
    push = np.array([0.5, 1.0, 0.0])
    covariance = 0.04 * np.outer(push, push) + np.diag([0.0, 0.0, 1e-30])
    squares, components = squares_of(covariance, np.array([0.1 * push, 0.4 * push]))
    assert components == 1
    assert squares == pytest.approx(np.array([0.25, 4.0]))
    # A place in kilometers and a speed in millimeters count alike.
    units = np.diag([1e-3, 1e3])
    full = np.array([[2.0, 0.9], [0.9, 1.0]])
    point = np.array([[0.3, -0.2]])
    squares, components = squares_of(units @ full @ units, point @ units)
    assert components == 2
    assert squares[0] == pytest.approx(float(point[0] @ np.linalg.solve(full, point[0])))


# Many missions, each of which draws a factor of its own.


def mixed(witnesses: Witnesses, count: int, seed: int) -> Missions:
    """Return missions by their own factors, and what is known of these at each step."""
    known = flown(witnesses, count, seed)
    rng = np.random.default_rng(seed + 1)
    factors = FEW / rng.chisquare(FEW, count)
    states = [np.sqrt(factors)[:, None] * path for path in known.states]
    total, samples, scales = np.zeros(count), FEW, []
    for k in range(witnesses.plan.scenario.horizon + 1):
        for i, vehicle in enumerate(witnesses.plan.scenario.vehicles):
            A, B = vehicle.system.A, vehicle.system.B
            loop = A if vehicle.gain is None else A + B @ vehicle.gain
            noise = states[i][k] - (states[i][k - 1] @ loop.T if k else 0.0)
            own = vehicle.disturbance_covariance if k else vehicle.initial_covariance
            total = total + (noise**2 / np.diag(own)).sum(axis=1)
            samples += noise.shape[1]
        scales.append(Scale(samples, (FEW + total) / samples))
    return Missions(states, known.fresh, scales=scales)


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("gain", [True, False])
def test_the_conditional_value_of_a_certificate_is_a_martingale(avoidance: str, gain: bool) -> None:
    witnesses = witnesses_of(unsure(crowded(2, avoidance, gain=gain, noise=0.2), FEW))
    missions = mixed(witnesses, MISSIONS[avoidance], seed=7)
    start = conditional(witnesses, 0, None).total
    for now in check_martingale(witnesses, missions):
        for process in (now.total, np.where(now.failed, 1.0, now.total)):
            error = 4.0 * process.std() / np.sqrt(len(process))
            assert process.mean() - error <= start


def factor_forgotten(scale: Scale) -> Scale:
    return Scale(FEW)


def degrees_forgotten(scale: Scale) -> Scale:
    return Scale(FEW, scale.factor)


def taken_for_the_mean_square(scale: Scale) -> Scale:
    return Scale(scale.samples, (scale.samples * scale.factor - FEW) / (scale.samples - FEW))


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("avoidance", "mutant"),
    [
        ("steps", factor_forgotten),
        ("steps", degrees_forgotten),
        # Along intervals bounds from both sides are 2 % apart, and this is less.
        ("steps", taken_for_the_mean_square),
        pytest.param("intervals", factor_forgotten, marks=pytest.mark.nightly),
        pytest.param("intervals", degrees_forgotten, marks=pytest.mark.nightly),
    ],
)
def test_who_learns_wrongly_is_no_martingale(avoidance: str, mutant) -> None:
    witnesses = witnesses_of(unsure(crowded(2, avoidance, gain=False, noise=0.2), FEW))
    missions = mixed(witnesses, (2 if avoidance == "steps" else 6) * MISSIONS[avoidance], seed=8)
    wrong = replace(missions, scales=[mutant(scale) for scale in missions.scales])
    with pytest.raises(AssertionError, match="step"):
        check_martingale(witnesses, wrong, steps=(1, 2, 3))


def test_a_value_without_what_was_measured_of_the_factor_is_refused() -> None:
    witnesses = beside_a_wall()
    states = [witnesses.motion.states[0][1]]
    with pytest.raises(ArgumentError, match="scale must tell what was measured"):
        conditional(witnesses, 1, states)
    many = Scale(9, np.array([0.5, 1.0, 2.0]))
    found = conditionals(witnesses, 1, [np.repeat(states[0][None], 3, axis=0)], many)
    one = conditional(witnesses, 1, states, Scale(9, 2.0))
    assert found.total[0] < found.total[1] < found.total[2] == pytest.approx(one.total)


@pytest.mark.parametrize("samples", [3, 12, 500])
def test_what_is_far_under_way_is_charged_what_half_spaces_there_are(samples: int) -> None:
    distance, risk = closer_of(samples)
    assert risk == pytest.approx(student.sf(distance, samples), rel=1e-6)
    assert risk <= 1e-10
    assert distance < cutoff_of(samples)[0]


def test_a_factor_that_grew_brings_near_what_was_far(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gather, "_EXPLICIT", 0)  # as large fleets are looked at
    a, b = craft("a", DI, [0.0, 0.0]), craft("b", DI, [0.0, 4e3])
    small = 1e-4 * np.array([1.0, 1.0, 0.1, 0.1])
    fleet = [replace(v, initial_covariance=small, disturbance_covariance=small) for v in (a, b)]
    witnesses = witnesses_of(unsure(still(*fleet, horizon=3, avoidance="steps"), 5))
    assert witnesses.far.count
    looked = []
    right = module.unseen_of
    monkeypatch.setattr(module, "unseen_of", lambda w: looked.append(w) or right(w))
    states = [x[1] for x in witnesses.motion.states]
    quiet = conditional(witnesses, 1, states, Scale(13, 1.0))
    assert not looked
    wild = conditional(witnesses, 1, states, Scale(13, 1e12))
    assert looked
    assert wild.total > 1e-3 > quiet.total
