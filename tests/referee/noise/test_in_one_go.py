"""Obstacles and pairs that are judged in one go are charged what they are charged on their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fleets import random_plan
from physical_scenes import DI, craft, pd, still

from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.vehicle import Vehicle
from radmpc.referee import certify
from radmpc.referee.bound import bounds

DECK = np.array([[-1.0, -0.4], [1.0, -0.4], [1.0, 0.4], [-1.0, 0.4]])


def among_everything() -> Plan:
    """Two in one gust among what stands, what moves, and what is not known exactly."""
    wind = SharedDisturbance("wind", 0.3 * np.eye(4, 2), [[0.02, 0.005], [0.005, 0.01]], 0.5)
    fleet: list[Vehicle] = [
        replace(craft(name, DI, place, gain=pd(0.5, 1.0)), shared=(wind,))
        for name, place in (("a", [0.0, 0.0]), ("b", [1.1, 0.3]))
    ]
    obstacles = (
        Obstacle.box("post", [-1.5, -0.5], [-0.6, 0.5]),
        Obstacle.tracked("known", 0.3 * DECK, [0.8, -0.8, 0.0, 0.02]),
        Obstacle.tracked("strays", 0.5 * DECK, [0.0, 2.0, 0.05, -0.1], np.eye(4) * 0.03),
    )
    return still(*fleet, obstacles=obstacles, horizon=5)


def assert_same_on_their_own(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    together = certify(plan, avoidance="intervals")
    monkeypatch.setattr(bounds, "_FEW_ENCOUNTERS", 0)
    apart = certify(plan, avoidance="intervals")
    for one, two in zip(together.ledger, apart.ledger, strict=True):
        assert replace(one, risk=0.0) == replace(two, risk=0.0)
        assert one.risk == pytest.approx(two.risk, rel=1e-6, abs=1e-15)


@pytest.mark.sampled(20)
@pytest.mark.parametrize("seed", range(40))
def test_in_random_scenes(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    assert_same_on_their_own(random_plan(seed), monkeypatch)


def test_among_all_kinds_of_obstacles_in_one_gust(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = among_everything()
    assert len({row.other for row in certify(plan).ledger if row.risk > 1e-9}) == 4
    assert_same_on_their_own(plan, monkeypatch)
