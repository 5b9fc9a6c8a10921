"""Mixed-integer programs solved at once: the same answers, in order, and a stop reaches all."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.sparse import csr_array

from radmpc.errors import SolverError
from radmpc.solvers.milp import at_once
from radmpc.solvers.milp.at_once import minimized_at_once
from radmpc.solvers.milp.highs import HighsBackend
from radmpc.solvers.milp.model import MilpAnswer, MilpModel
from radmpc.solvers.solution import Limits, Outcome


def knapsack(seed: int) -> MilpModel:
    """Things of which as many are taken as weigh half of all."""
    rng = np.random.default_rng(seed)
    weights, worth = rng.uniform(1.0, 2.0, 12), rng.uniform(1.0, 2.0, 12)
    return MilpModel(
        cost=-worth,
        lower=np.zeros(12),
        upper=np.ones(12),
        matrix=csr_array(weights[None]),
        row_lower=np.array([-np.inf]),
        row_upper=np.array([0.5 * weights.sum()]),
        num_continuous=0,
    )


@dataclass
class Slow:
    """Takes until it is stopped."""

    name: str = "slow"

    def minimize(self, model: MilpModel, gap: float, limits: Limits) -> MilpAnswer:
        while not limits.reached:
            time.sleep(0.01)
        return MilpAnswer(Outcome.LIMIT, None, -np.inf, 0)


@dataclass
class Failing:
    """Fails at once."""

    name: str = "failing"

    def minimize(self, model: MilpModel, gap: float, limits: Limits) -> MilpAnswer:
        raise SolverError("no answer")


@dataclass
class Timing:
    """Notes how long each may take."""

    seconds: list[float]
    name: str = "timing"

    def minimize(self, model: MilpModel, gap: float, limits: Limits) -> MilpAnswer:
        self.seconds.append(limits.seconds_left)
        return MilpAnswer(Outcome.LIMIT, None, -np.inf, 0)


def test_answers_are_those_of_one_after_the_other() -> None:
    models = [knapsack(seed) for seed in range(5)]
    found = minimized_at_once(HighsBackend(), models, 1e-6, Limits())
    for model, answer in zip(models, found, strict=True):
        alone = HighsBackend().minimize(model, 1e-6, Limits())
        assert answer.outcome is Outcome.OPTIMAL
        assert answer.bound == alone.bound


def test_of_no_model_there_is_no_answer() -> None:
    assert minimized_at_once(HighsBackend(), [], 1e-6, Limits()) == []


def test_a_stop_reaches_all_and_is_asked_for_by_the_caller_alone() -> None:
    asking: set[int] = set()
    begun = time.monotonic()

    def is_stopped() -> bool:
        asking.add(threading.get_ident())
        return time.monotonic() > begun + 0.1

    found = minimized_at_once(Slow(), [knapsack(0)] * 3, 1e-6, Limits(is_stopped=is_stopped))
    assert len(found) == 3
    assert asking == {threading.get_ident()}


def test_what_a_solver_raises_is_raised_and_ends_the_others() -> None:
    with pytest.raises(SolverError, match="no answer"):
        minimized_at_once(Failing(), [knapsack(0)] * 3, 1e-6, Limits())


def test_each_may_take_its_share_of_the_time_that_is_left(monkeypatch) -> None:
    monkeypatch.setattr(at_once, "num_processors", lambda: 1)
    backend = Timing([])
    minimized_at_once(backend, [knapsack(0)] * 4, 1e-6, Limits().within(60.0))
    shares = sorted(backend.seconds)
    assert shares[0] == pytest.approx(30.0, abs=1.0)
    assert shares[-1] == pytest.approx(60.0, abs=1.0)
