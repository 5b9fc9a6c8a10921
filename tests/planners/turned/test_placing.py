"""Attempts that are turned though they miss something, and those that are left."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.experiments.families import circle
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned import attempts as making
from radmpc.planners.certified.turned.attempt import Attempt, Begin
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.verdict import Verdict
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits


def begun(hazards: Hazards) -> Begin:
    """Begin with what vehicles do alone, all of them in conflict."""
    task = Task(hazards, lambda _: Verdict(1.0, ()), Limits(), 1e-3, 0.05, lambda _: None)
    alone = SuccessiveLp(hazards, Limits())
    assert alone.begin_alone()
    return Begin(task, alone, {}, (tuple(range(hazards.count)),), 1.0, 2.4)


@pytest.mark.parametrize(("missed", "is_turned"), [(0.5, True), (9.0, False)])
def test_what_attempts_miss_alike_is_turned_unless_it_is_far_too_much(
    missed: float, is_turned: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pairs that meet head-on miss alike whatever else there is: to turn them takes seconds."""
    scenario = circle(3)
    begin, turned = begun(Hazards.of(scenario, condensed_models(scenario))), []
    assert 0.5 < begin.task.hazards.radii.sum() < 9.0
    begins = iter([Attempt(begin.referring({}), 0) for _ in range(2)])

    def run(attempt: Attempt) -> FleetIncumbent:
        turned.append(attempt)
        return FleetIncumbent()

    monkeypatch.setattr(making, "_attempts", lambda *_: begins)
    monkeypatch.setattr(making, "_turned", lambda *_: (missed, FleetIncumbent(), False))
    monkeypatch.setattr(Attempt, "run", run)
    making.tried(begin, np.random.default_rng(0), Limits())
    # What missed least is turned at the end in any case.
    assert len(turned) == (2 if is_turned else 1)
