from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from conditional_missions import MISSIONS, check_martingale, crowded, flown
from referee_scenes import make_plan

from radmpc.errors import ArgumentError, NoPlanError, ScenarioError
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan, Status
from radmpc.model.scenario import Workspace
from radmpc.referee import certify
from radmpc.referee.bound import planar
from radmpc.referee.conditional import conditional as module
from radmpc.referee.conditional.conditional import conditional, conditionals, witnesses_of
from radmpc.referee.conditional.rows import Witnesses

SCENES = [
    (2, "steps", True),
    (2, "steps", False),
    (3, "steps", True),
    (2, "intervals", True),
    (2, "intervals", False),
    (3, "intervals", True),
]


FEW = 5_000
"""Missions that show a mistake."""


@cache
def scene(dimension: int, avoidance: str, gain: bool) -> Witnesses:
    return witnesses_of(crowded(dimension, avoidance, gain=gain, noise=0.3 if gain else 0.25))


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize(("dimension", "avoidance", "gain"), SCENES)
def test_the_conditional_value_of_a_certificate_is_a_martingale(
    dimension: int, avoidance: str, gain: bool
) -> None:
    witnesses = scene(dimension, avoidance, gain)
    missions = flown(witnesses, MISSIONS, seed=7)
    start = conditional(witnesses, 0, None).total
    assert 0.15 < start < 0.7
    for now in check_martingale(witnesses, missions):
        # And what is left falls, whatever of all that was left behind counts as a hit.
        for process in (now.total, np.where(now.failed, 1.0, now.total)):
            error = 4.0 * process.std() / np.sqrt(len(process))
            assert process.mean() - error <= 1.017 * start


def test_nothing_is_left_at_the_end_but_where_the_last_step_stands() -> None:
    for avoidance in ("steps", "intervals"):
        witnesses = scene(2, avoidance, True)
        states = [x[-1] for x in witnesses.motion.states]
        assert conditional(witnesses, 4, states).total == 0.0


# Mutants: each is a mistake that is easily made.


def covariances_of_time_zero(monkeypatch: pytest.MonkeyPatch) -> None:
    right = module.since

    def wrong(loops, horizon, step, *, is_measured):
        whole = right(loops, horizon, 0, is_measured=False)
        now = right(loops, horizon, step, is_measured=is_measured)
        return replace(now, covariances=whole.covariances[step:])

    monkeypatch.setattr(module, "since", wrong)


def measurement_ignored(monkeypatch: pytest.MonkeyPatch) -> None:
    right = module._deviations
    monkeypatch.setattr(module, "_deviations", lambda *given: 0.0 * right(*given))


def gain_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(witnesses: Witnesses, step: int, states: object, scale: object = None) -> object:
        if states is None:
            # The value at the start must be right: the mistake is made under way.
            return conditionals(witnesses, step, None)
        loops = witnesses.loops
        A = np.array([[1.0, 1.0], [0.0, 1.0]])
        open_loop = np.kron(A, np.eye(loops.picks.shape[1]))
        transitions = np.broadcast_to(open_loop, loops.transitions.shape)
        mistaken = replace(witnesses, loops=replace(loops, transitions=transitions))
        return conditionals(mistaken, step, states, scale)

    monkeypatch.setattr("conditional_missions.conditionals", wrong)


MUTANTS = [
    covariances_of_time_zero,
    measurement_ignored,
    gain_left_out,
]


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("mutant", MUTANTS)
@pytest.mark.parametrize(("dimension", "avoidance"), [(2, "steps"), (2, "intervals")])
def test_a_wrong_conditional_value_is_no_martingale(
    dimension: int, avoidance: str, mutant, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Without feedback deviations last, and what is forgotten of them shows.
    witnesses = scene(dimension, avoidance, mutant is gain_left_out)
    missions = flown(witnesses, FEW, seed=8)
    mutant(monkeypatch)
    with pytest.raises(AssertionError, match="step"):
        check_martingale(witnesses, missions)


@pytest.mark.slow
def test_integrals_valued_by_half_spaces_under_way_are_no_martingale(
    monkeypatch: pytest.MonkeyPatch,
) -> None:

    witnesses = scene(2, "steps", True)
    missions = flown(witnesses, FEW, seed=8)
    start = conditionals(witnesses, 0, None)
    monkeypatch.setattr(
        "conditional_missions.conditionals",
        lambda w, step, states, *_: start if states is None else conditionals(w, step, states),
    )
    monkeypatch.setattr(planar, "grown_polygon_risks", lambda *given: given[-1])
    with pytest.raises(AssertionError, match="step"):
        check_martingale(witnesses, missions, steps=(1,))


# The certificate of the plan that is left, told anew.


def shifted(plan: Plan, step: int, states: list[np.ndarray]) -> Plan:
    """Return what is left of a plan as a plan of its own, feedback in its controls."""
    scenario = plan.scenario
    fleet, controls = [], []
    for vehicle, path, state in zip(scenario.vehicles, plan.trajectories, states, strict=True):
        loop = vehicle.system.A
        asked = path.controls[step:].copy()
        if vehicle.gain is not None:
            loop = loop + vehicle.system.B @ vehicle.gain
            deviation = state - path.means[step]
            for k in range(len(asked)):
                asked[k] += vehicle.gain @ deviation
                deviation = loop @ deviation
        fleet.append(
            replace(vehicle, start=state, initial_covariance=0.0 * vehicle.initial_covariance)
        )
        controls.append(asked)
    obstacles = tuple(
        Obstacle.moving(o.name, o.shape.outlines[step:]) if o.is_moving else o
        for o in scenario.obstacles
    )
    left = replace(
        scenario,
        vehicles=tuple(fleet),
        obstacles=obstacles,
        horizon=scenario.horizon - step,
    )
    return make_plan(left, controls)


def measured(witnesses: Witnesses, step: int, seed: int) -> list[np.ndarray]:
    missions = flown(witnesses, 1, seed)
    nominal = witnesses.motion.states
    return [nominal[i][step] + path[step][0] for i, path in enumerate(missions.states)]


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("gain", [True, False])
def test_integrals_are_valued_as_the_plan_that_is_left_is_certified(gain: bool) -> None:
    witnesses = scene(2, "steps", gain)
    assert len(witnesses.integrals.windows) > 5
    for seed, step in ((1, 1), (2, 2), (3, 3)):
        states = measured(witnesses, step, seed)
        anew = certify(shifted(witnesses.plan, step, states))
        value = conditional(witnesses, step, states)
        assert value.total == pytest.approx(anew.certified, rel=2e-3, abs=1e-9)


def test_a_face_is_valued_as_the_plan_that_is_left_is_certified() -> None:
    plan = crowded(2, "intervals", noise=0.3)
    alone = replace(
        plan.scenario,
        vehicles=plan.scenario.vehicles[:1],
        obstacles=(),
        workspace=Workspace([-1.5, -0.7], [9.5, 0.8]),
    )
    witnesses = witnesses_of(make_plan(alone, [plan.trajectories[0].controls]))
    for seed, step in ((1, 1), (2, 2), (3, 3)):
        states = measured(witnesses, step, seed)
        left = shifted(witnesses.plan, step, states)
        # The nominal's sagitta holds its reserve, the mean's would hold another.
        value, anew = conditional(witnesses, step, states).total, certify(left).certified
        assert 1e-4 < value < 1.0
        assert value == pytest.approx(anew, rel=0.1)


@pytest.mark.slow
def test_rows_of_old_are_never_better_than_the_best_there_are() -> None:
    for dimension, avoidance, gain in SCENES[:5]:
        witnesses = scene(dimension, avoidance, gain)
        for seed in range(2):
            states = measured(witnesses, 1, seed)
            anew = certify(shifted(witnesses.plan, 1, states)).certified
            assert conditional(witnesses, 1, states).total >= 0.95 * anew


@pytest.mark.slow
def test_the_next_step_is_a_part_of_what_is_left() -> None:
    for dimension, avoidance, gain in SCENES:
        witnesses = scene(dimension, avoidance, gain)
        last = witnesses.plan.scenario.horizon - 1
        for step in range(last + 1):
            value = conditional(witnesses, step, measured(witnesses, step, 4))
            assert 0.0 <= value.next_step <= value.total * (1.0 + 1e-12)
        assert value.next_step == pytest.approx(value.total)


def test_what_cannot_be_valued_is_refused() -> None:
    witnesses = scene(2, "steps", True)
    states = [x[1] for x in witnesses.motion.states]
    with pytest.raises(ArgumentError, match="step must be from 0 to 4, got 5"):
        conditional(witnesses, 5, states)
    with pytest.raises(ArgumentError, match="without measured states step must be 0, got 1"):
        conditional(witnesses, 1, None)
    with pytest.raises(ScenarioError, match="must be 2 states, got 1"):
        conditional(witnesses, 1, states[:1])
    with pytest.raises(ScenarioError, match=r"states\[1\]: must be finite"):
        conditional(witnesses, 1, [states[0], np.full(4, np.nan)])
    empty = replace(witnesses.plan, trajectories=(), status=Status.INFEASIBLE)
    with pytest.raises(NoPlanError):
        witnesses_of(empty)
