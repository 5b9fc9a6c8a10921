"""What a mission is about, what it may risk and what it has done."""

from __future__ import annotations

from threading import RLock

from radmpc.flying.account import Account
from radmpc.flying.leg import Leg
from radmpc.flying.locking import one_at_a_time
from radmpc.flying.tick import Contact, Entry, Tick, entered, failure, progress_text
from radmpc.model.scenario import Scenario

__all__ = ["Logbook"]


class Logbook:
    """A scenario, the leg in the air, the account and what has come of them so far.

    Parameters
    ----------
    scenario : Scenario
        Of the mission.
    leg : Leg
        Its first one.
    account : Account
        As it is opened.
    """

    def __init__(self, scenario: Scenario, leg: Leg, account: Account) -> None:
        self._scenario, self._step = scenario, 0
        self._leg, self._account = leg, account
        self._contacts: list[Contact] = []
        self._past = 0  # of these, those before the account was opened anew
        self._ticks: list[Tick] = []
        self._entries: list[Entry] = []
        self._lock = RLock()

    @property
    def scenario(self) -> Scenario:
        """What the mission is about."""
        return self._scenario

    @property
    def balance(self) -> Account:
        """What is left of Δ."""
        return self._account

    @property
    def leg(self) -> Leg:
        """What is in the air."""
        return self._leg

    @property
    def account(self) -> tuple[Entry, ...]:
        """Every change of it, in order."""
        return tuple(self._entries)

    @property
    def ticks(self) -> tuple[Tick, ...]:
        """Every decision, in order."""
        return tuple(self._ticks)

    @property
    def has_failed(self) -> bool:
        """Whether anything was hit or lost: from then on the tail is flown, nothing is promised.

        Unless the account is opened anew.
        """
        return len(self._contacts) > self._past

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """What was hit, and ranges that were lost."""
        return tuple(self._contacts)

    @property
    def is_over(self) -> bool:
        """Whether the last step has been measured."""
        return self._step > self._scenario.horizon

    def __repr__(self) -> str:
        """Return how far it is in one line."""
        end = f"over after {self._scenario.horizon} steps" if self.is_over else None
        told = progress_text(self._scenario, self._step, self._account.wealth, end)
        return f"{type(self).__name__}({told}; {self._failure() or 'no collision'})"

    @one_at_a_time
    def set_risk_bound(self, risk_bound: float) -> None:
        """Change Δ under way: the unallocated risk changes by as much.

        Parameters
        ----------
        risk_bound : float
            The new Δ of the whole mission [-].

        Raises
        ------
        RiskError
            If less is unallocated than would be taken.
        """
        self._account = self._account.with_risk_bound(risk_bound)
        self._enter("bound", None)

    def _failure(self) -> str:
        """Return in a few words why the mission has failed; empty where it has not."""
        return failure(self._contacts[self._past :])

    def _enter(self, what: str, price: float | None) -> None:
        """Write a row of the account."""
        self._entries.append(entered(self._step, what, self._account, price))
