from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from account_rules import check_adoption, played
from hypothesis import given, settings
from hypothesis import strategies as st

from radmpc.errors import ArgumentTypeError, RiskError
from radmpc.flying.account import TOLERANCE, Account
from sampling import examples

QUICK = settings(max_examples=examples(200), deadline=None, derandomize=True)
BOUNDS = st.floats(1e-6, 0.49)
RISKS = st.one_of(st.just(0.0), st.floats(1e-12, 3.0))
ACCOUNTS = st.builds(Account, BOUNDS, RISKS, RISKS)


def test_what_the_first_leg_does_not_need_is_in_the_bank() -> None:
    account = Account.opened(0.05, 0.03)
    assert account.bank == pytest.approx(0.02)
    assert account.wealth == pytest.approx(0.05, rel=1e-6)
    assert account.wealth <= 0.05


def test_a_mission_does_not_begin_above_its_bound() -> None:
    with pytest.raises(RiskError, match=r"certificate of 0\.051 is above the risk bound of 0\.05"):
        Account.opened(0.05, 0.051)
    assert Account.opened(0.05, 0.05).bank == 0.0


@QUICK
@given(ACCOUNTS, RISKS)
def test_adopting_a_leg_makes_no_wealth_and_leaves_the_rest_in_the_bank(
    account: Account, price: float
) -> None:
    check_adoption(account, price)


@QUICK
@given(ACCOUNTS)
def test_a_leg_for_all_of_the_wealth_can_be_bought_and_none_above(account: Account) -> None:
    check_adoption(account, account.wealth * (1.0 - 2.0 * TOLERANCE))
    assert account.affords(account.wealth * (1.0 - 2.0 * TOLERANCE))
    if account.wealth:
        assert not account.affords(account.wealth)


@QUICK
@given(ACCOUNTS, RISKS)
def test_keeping_the_tail_leaves_the_bank_alone(account: Account, tail: float) -> None:
    kept = account.kept(tail)
    assert (kept.bank, kept.tail, kept.risk_bound) == (account.bank, tail, account.risk_bound)


@QUICK
@given(ACCOUNTS, st.floats(1e-6, 1.0))
def test_what_is_granted_can_be_bought_and_is_at_most_the_bound(
    account: Account, share: float
) -> None:
    grant = account.grant(share)
    assert grant <= min(share * account.wealth, account.risk_bound)
    assert account.affords(grant)


@QUICK
@given(ACCOUNTS, BOUNDS)
def test_the_bound_moves_the_bank_and_nothing_else(account: Account, bound: float) -> None:
    change = bound - account.risk_bound
    if account.bank + change < 0.0:
        with pytest.raises(RiskError, match="the rest is allocated to the leg in the air"):
            account.with_risk_bound(bound)
        return
    moved = account.with_risk_bound(bound)
    assert moved.tail == account.tail
    assert moved.risk_bound == bound
    assert moved.bank == pytest.approx(account.bank + change)


def test_a_bound_moved_down_and_up_again_is_as_before() -> None:
    account = Account.opened(0.05, 0.03)
    again = account.with_risk_bound(0.035).with_risk_bound(0.05)
    assert again.bank == pytest.approx(account.bank)
    with pytest.raises(RiskError, match=r"lowered to 0\.03 at most"):
        account.with_risk_bound(0.0299)


@QUICK
@given(st.integers(0, 2**32 - 1), st.integers(1, 30), BOUNDS)
def test_no_buyer_brings_the_mission_above_its_bound(seed: int, steps: int, bound: float) -> None:
    rng = np.random.default_rng(seed)

    def whim(step: int, account: Account) -> float:
        del step
        return float(account.wealth * rng.choice([0.0, 0.3, 1.0 - 2e-6, 1.0, 1.5, 20.0]))

    assert played(Account.opened(bound, 0.0), steps, whim).hit <= bound * (1.0 + 1e-12)


def test_the_bound_is_attained_by_who_stakes_everything_at_once() -> None:
    game = played(Account.opened(0.05, 0.0), 10, lambda step, account: account.grant(1.0))
    assert game.hit == pytest.approx(0.05, rel=1e-5)


# What must not pass for an account: each is a rule that was tempting.


class Adds(Account):
    """Puts what is left into the bank beside what is there already."""

    def adopted(self, price: float) -> Account:
        right = Account.adopted(self, price)
        return replace(self, tail=price, bank=self.bank + right.bank)


class Sells(Account):
    """Sells whatever is asked for."""

    def adopted(self, price: float) -> Account:
        return replace(self, tail=price, bank=max(self.wealth - price, 0.0))


class Anew(Account):
    """Grants the bound anew at each adoption."""

    @property
    def wealth(self) -> float:
        return self.risk_bound


class Larger(Account):
    """Takes the larger of the tail and what a pool still holds."""

    @property
    def wealth(self) -> float:
        return max(self.tail, self.risk_bound)


@pytest.mark.parametrize("wrong", [Adds, Sells])
def test_an_account_with_another_arithmetic_fails_the_properties(wrong: type[Account]) -> None:
    prices = {Adds: 0.01, Sells: 0.06}
    with pytest.raises(AssertionError):
        check_adoption(wrong(0.05, 0.02, 0.03), prices[wrong])


@pytest.mark.parametrize("wrong", [Adds, Sells, Anew, Larger])
def test_an_account_with_another_rule_loses_the_game(wrong: type[Account]) -> None:
    game = played(wrong(0.05, 0.0, 0.05), 10, lambda step, account: 0.04)
    assert game.hit > 0.3


def test_the_right_rule_wins_the_same_game() -> None:
    game = played(Account(0.05, 0.0, 0.05), 10, lambda step, account: 0.04)
    assert (game.refused, game.hit) == (9, pytest.approx(0.04))


def test_accounts_do_not_change() -> None:
    account = Account.opened(0.05, 0.01)
    with pytest.raises(FrozenInstanceError):
        account.bank = 1.0


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1e-9])
def test_what_is_no_risk_is_refused(value: float) -> None:
    account = Account.opened(0.05, 0.01)
    for act in (account.kept, account.adopted, account.affords, account.with_risk_bound):
        with pytest.raises(RiskError, match="must be finite and at least 0"):
            act(value)


def test_what_is_no_number_is_refused() -> None:
    account = Account.opened(0.05, 0.01)
    with pytest.raises(ArgumentTypeError, match=r"tail must be a number, got '0.01'"):
        account.kept("0.01")
    with pytest.raises(RiskError, match=r"share must be above 0 and at most 1, got 1\.5"):
        account.grant(1.5)
