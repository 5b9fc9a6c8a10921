"""Counts end the search, the turning and the proof, not the clock: slow machines plan the same."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pytest

from radmpc.experiments.families import paper
from radmpc.planning import plan

LONG = 1e9
"""A time limit that nothing comes near [s]."""


def ever_slower(clock: Callable[[], float]) -> Callable[[], float]:
    """Return a clock of a machine that others use more and more."""
    began = clock()

    def now() -> float:
        elapsed = clock() - began
        return began + elapsed + 1000.0 * elapsed**3

    return now


@pytest.mark.slow
def test_a_machine_that_slows_down_makes_the_same_plan_and_bound(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scenario = paper(4, 0)
    one = plan(scenario, time_limit=LONG)
    for name in ("monotonic", "perf_counter"):
        monkeypatch.setattr(time, name, ever_slower(getattr(time, name)))
    other = plan(scenario, time_limit=LONG)
    assert one.cost == other.cost
    assert one.certified_lower_bound == other.certified_lower_bound
    for mine, its in zip(one.require().trajectories, other.require().trajectories, strict=True):
        np.testing.assert_array_equal(mine.controls, its.controls)
