"""Intervals that bring nobody near are told apart sooner, and certificates stay the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fleets import random_plan
from referee_scenes import make_plan

from radmpc.experiments.families import clutter
from radmpc.model.plan import Plan
from radmpc.referee import Certificate, certify
from radmpc.referee.bound import intervals


def straight_on() -> Plan:
    """Return flights at even speeds among a hundred boxes, near some of them."""
    scenario = replace(clutter(3, 100, 4), avoidance="intervals")
    controls = [0.2 * np.ones((scenario.horizon, 2)) for _ in scenario.vehicles]
    return make_plan(scenario, controls)


def certified(plan: Plan, many: int, monkeypatch: pytest.MonkeyPatch) -> Certificate:
    monkeypatch.setattr(intervals, "_MANY", many)
    return certify(plan, avoidance="intervals")


def check(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> float:
    closely, soon = (certified(plan, many, monkeypatch) for many in (10**9, 0))
    assert soon.certified == pytest.approx(closely.certified, rel=1e-12, abs=1e-22)
    ledgers = [{(r.vehicle, r.other, r.step): r.risk for r in c.ledger} for c in (closely, soon)]
    for key in ledgers[0].keys() | ledgers[1].keys():
        one, other = (ledger.get(key, 0.0) for ledger in ledgers)
        assert other == pytest.approx(one, rel=1e-9, abs=1e-20)
    return closely.certified


def test_certificates_of_random_fleets_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    risks = [check(random_plan(seed), monkeypatch) for seed in range(25)]
    assert sum(0.0 < risk < 1.0 for risk in risks) > 5


def test_certificates_among_a_hundred_boxes_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    assert check(straight_on(), monkeypatch) > 0.0
