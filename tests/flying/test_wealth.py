"""What wealth is worth: a rule that makes it is seen in P(hit) + E[W; nothing hit]."""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent.parent / "referee"))

from conditional_missions import course, crowded, flown
from slalom import careful_plan

from radmpc.flying import deciding
from radmpc.flying.account import Account
from radmpc.flying.flight import fly
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.referee.conditional.conditional import conditional, conditionals, witnesses_of

MISSIONS = 1_000


@cache
def excess() -> tuple[list[float], list[float]]:
    """Return V_t less Δ at two ticks, in standard errors, of missions that fly one plan on.

    The bank is empty: Δ is what the plan costs. First by the rule of the account; then with pools,
    by which the wealth is the larger of the tail and of what is left of Δ after what every step was
    to risk.
    """
    witnesses = witnesses_of(crowded(2, "steps", gain=True, noise=0.3))
    bound = conditional(witnesses, 0, None).total
    missions = flown(witnesses, MISSIONS, seed=11)
    nominal = witnesses.motion.states
    pool, right, pooled = np.full(MISSIONS, bound), [], []
    for step in (0, 1, 2):
        states = [nominal[i][step] + path[step] for i, path in enumerate(missions.states)]
        value = conditionals(witnesses, step, states)
        if step:
            hit = course(witnesses, missions, step).failed
            for found, wealth in (
                (right, value.total),
                (pooled, np.maximum(value.total, pool)),
            ):
                worth = np.where(hit, 1.0, wealth)
                found.append(float((worth.mean() - bound) / (worth.std() / np.sqrt(MISSIONS))))
        pool = np.maximum(pool - value.next_step, 0.0)
    return right, pooled


@pytest.mark.slow
def test_the_tail_and_the_bank_are_worth_no_more_than_the_bound() -> None:
    assert max(excess()[0]) <= 4.0


@pytest.mark.slow
def test_the_larger_of_tail_and_pool_is_worth_more_within_two_ticks() -> None:
    assert max(excess()[1]) > 4.0


def starved(share: float, *, has_bank: bool, missions: int = 4) -> float:
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
def test_without_a_bank_it_does() -> None:
    assert starved(deciding.SHARE, has_bank=False) > 0.03


@pytest.mark.parametrize(("share", "starves"), [(deciding.SHARE, False), (1.0, True)])
def test_who_always_spends_everything_has_nothing_after_kind_steps(
    share: float, starves: bool
) -> None:
    # A leg that is tight everywhere is worth a twentieth after a step that went well.
    account = Account.opened(0.05, 0.02)
    for _ in range(5):
        price = account.grant(share)
        account = account.adopted(price).kept(0.05 * price)
    assert (account.wealth < 1e-4) == starves
