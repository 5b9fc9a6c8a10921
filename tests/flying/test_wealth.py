"""What wealth is worth: a rule that makes it is seen in P(hit) + E[W; nothing hit]."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent.parent / "referee"))

from conditional_missions import course, crowded, flown
from slalom import careful_plan

from radmpc.flying import deciding
from radmpc.flying.flight import fly
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.referee.conditional.conditional import conditional, conditionals, witnesses_of

MISSIONS = 1_000


def excess(*, pools: bool) -> list[float]:
    """Return V_t less Δ at two ticks, in standard errors, of missions that fly one plan on.

    The bank is empty: Δ is what the plan costs. With pools the wealth is the larger of the tail and
    of what is left of Δ after what every step was to risk.
    """
    witnesses = witnesses_of(crowded(2, "steps", gain=True, noise=0.3))
    bound = conditional(witnesses, 0, None).total
    missions = flown(witnesses, MISSIONS, seed=11)
    nominal = witnesses.motion.states
    pool, found = np.full(MISSIONS, bound), []
    for step in (0, 1, 2):
        states = [nominal[i][step] + path[step] for i, path in enumerate(missions.states)]
        value = conditionals(witnesses, step, states)
        if step:
            wealth = np.maximum(value.total, pool) if pools else value.total
            worth = np.where(course(witnesses, missions, step).failed, 1.0, wealth)
            found.append(float((worth.mean() - bound) / (worth.std() / np.sqrt(MISSIONS))))
        pool = np.maximum(pool - value.next_step, 0.0)
    return found


@pytest.mark.slow
def test_the_tail_and_the_bank_are_worth_no_more_than_the_bound() -> None:
    assert max(excess(pools=False)) <= 4.0


@pytest.mark.slow
def test_the_larger_of_tail_and_pool_is_worth_more_within_two_ticks() -> None:
    assert max(excess(pools=True)) > 4.0


def starved(share: float, *, has_bank: bool, missions: int = 6) -> float:
    """Return the share of ticks with wealth below 1e-4."""
    few = []
    for seed in range(missions):
        mission = Mission(careful_plan(), planner=None, warm=True, share=share)
        if not has_bank:
            now = mission.balance
            mission.set_risk_bound(now.risk_bound - (1.0 - 1e-9) * now.bank)
        flight = fly(mission, Model(mission.scenario, seed))
        few += [t.wealth < 1e-4 for t in flight.ticks if t.segments]
    return sum(few) / len(few)


@pytest.mark.slow
def test_wealth_does_not_dry_up() -> None:
    assert starved(deciding.SHARE, has_bank=True) < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("share", [deciding.SHARE, 1.0])
def test_without_a_bank_it_does(share: float) -> None:
    assert starved(share, has_bank=False) > 0.03
