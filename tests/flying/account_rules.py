"""A game against the account: whoever plans buys what the account lets them, nature draws."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from radmpc.errors import RiskError
from radmpc.flying.account import TOLERANCE, Account

Buyer = Callable[[int, Account], float]
"""From the step and the account to the price of a leg that is run wholly in the next step."""


@dataclass(frozen=True)
class Game:
    """Legs that stake all their price on the next step, so that what survives is worth nothing.

    Attributes
    ----------
    hit : float
        Probability that the mission ends in a collision [-].
    refused : int
        Legs that the account refused.
    """

    hit: float
    refused: int


def played(account: Account, steps: int, buyer: Buyer) -> Game:
    """Return what becomes of a mission, exactly: only what survives goes on."""
    alive, refused = 1.0, 0
    for step in range(steps):
        price = min(buyer(step, account), 1.0)
        try:
            account = account.adopted(price)
        except RiskError:
            refused += 1
            price = min(account.tail, 1.0)
        alive *= 1.0 - price
        account = account.kept(0.0)
    return Game(1.0 - alive, refused)


def check_adoption(account: Account, price: float) -> None:
    """Assert what must hold of an adoption, whatever the account."""
    wealth = account.wealth
    if price * (1.0 + TOLERANCE) > wealth:
        try:
            account.adopted(price)
        except RiskError:
            return
        raise AssertionError("a leg above the wealth was sold")
    after = account.adopted(price)
    assert after.bank >= 0.0
    assert after.tail == price
    assert after.risk_bound == account.risk_bound
    # True values: the tail is worth at most its price, and a rounding of it is lost on the way.
    assert after.bank + after.tail <= wealth
    assert after.bank + after.tail >= wealth - 2.0 * TOLERANCE * price - 1e-18
    assert after.kept(after.tail).bank == after.bank
