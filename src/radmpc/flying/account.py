r"""What is left of a mission's risk bound: arithmetic alone.

A *leg* is what is flown from some step on; its conditional value is the certificate of what is
left of it, given what has been measured. The *remaining risk* of a mission (`wealth`) is the
conditional value of the leg in the air, its *tail*, and the *unallocated risk* (`bank`), which is
never below 0. Another leg may be adopted whose own certificate (`price`) is at most the remaining
risk; what it leaves of that is then unallocated:

.. math:: W_t = C_t(\text{tail}) + b, \qquad C_t(\text{new}) \le W_t, \qquad
          b := W_t - C_t(\text{new}).

Keeping the tail is always allowed and leaves the unallocated risk as it is. The probability of any
collision in the mission is then at most Δ, whatever planner is used and however often (proof:
docs/flying.md).
"""

from __future__ import annotations

import math

from radmpc.arguments import is_number, value_text
from radmpc.errors import ArgumentTypeError, RiskError
from radmpc.records import dataclass, fields, replace

__all__ = ["TOLERANCE", "Account"]

TOLERANCE = 1e-6
"""Share [-] by which a tail counts less than its value, and a certificate more: two evaluations of
one probability may differ by their rounding, which may never add to the remaining risk."""


@dataclass(frozen=True, slots=True)
class Account:
    """A mission's risk: what the leg in the air may still need, and what is kept beside it.

    Attributes
    ----------
    risk_bound : float
        Δ, for the whole mission [-].
    tail : float
        Conditional value of the leg in the air when last valued, not above the true one [-]. May
        exceed Δ: what is measured may be bad news.
    bank : float
        What no leg needs, >= 0 [-].
    """

    risk_bound: float
    tail: float
    bank: float

    def __post_init__(self) -> None:
        """Refuse numbers that are neither probabilities nor sums of probabilities."""
        for field in fields(self):
            _check_risk(getattr(self, field.name), field.name)
        if not 0.0 < self.risk_bound < 0.5:
            raise RiskError(f"risk_bound must be above 0 and below 0.5, got {self.risk_bound:.6g}")

    @classmethod
    def opened(cls, risk_bound: float, price: float) -> Account:
        """Return the account of a mission that begins.

        Parameters
        ----------
        risk_bound : float
            Δ [-], 0 < Δ < 0.5.
        price : float
            Certificate of the first leg, before anything is measured [-].

        Returns
        -------
        Account
            What is not allocated to the leg is kept.

        Raises
        ------
        RiskError
            If the price exceeds the bound: there is nothing to begin with.
        """
        _check_risk(price, "price")
        if price > risk_bound:
            raise RiskError(
                f"its certificate of {price:.6g} is above the risk bound of {risk_bound:.6g}"
            )
        return cls(risk_bound, price, risk_bound - price)

    @property
    def wealth(self) -> float:
        """Remaining risk: what another leg may risk at most, `TOLERANCE` included [-]."""
        return self.bank + self.tail * (1.0 - TOLERANCE)

    def affords(self, price: float) -> bool:
        """Whether a leg may be adopted: its risk is within the remaining risk.

        Parameters
        ----------
        price : float
            Its certificate, given what is measured now, not below the true one [-].
        """
        _check_risk(price, "price")
        return price * (1.0 + TOLERANCE) <= self.wealth

    def kept(self, tail: float) -> Account:
        """Return the account after keeping the leg in the air, valued by what is measured now.

        Parameters
        ----------
        tail : float
            Its conditional value by the rows its certificate charged, not above the true one [-].

        Returns
        -------
        Account
            With the same unallocated risk.
        """
        return replace(self, tail=tail)

    def adopted(self, price: float) -> Account:
        """Return the account after adopting another leg from now on.

        Parameters
        ----------
        price : float
            Its certificate, given what is measured now, not below the true one [-].

        Returns
        -------
        Account
            What the leg leaves of the remaining risk is unallocated; the old unallocated risk is
            part of that.

        Raises
        ------
        RiskError
            If the price exceeds the remaining risk.
        """
        if not self.affords(price):
            raise RiskError(
                f"price must be at most the remaining risk of {self.wealth:.6g}, got {price:.6g}"
            )
        bank = self.wealth - price * (1.0 + TOLERANCE)
        return replace(self, tail=price, bank=max(bank, 0.0))

    def after(self, next_step: float) -> Account:
        """Return what is expected of the account once a step has been flown.

        Parameters
        ----------
        next_step : float
            What of the tail's value that step runs [-].

        Returns
        -------
        Account
            For planning ahead alone: what is measured by then decides.
        """
        return replace(self, tail=max(self.tail - next_step, 0.0))

    def grant(self, share: float) -> float:
        """Return what a candidate may risk: a share of the remaining risk, at most Δ.

        Candidates that may use all of the remaining risk soon leave none: a leg that is tight
        everywhere has next to no value after a step that went well, and no leg fits in that.

        Parameters
        ----------
        share : float
            φ, above 0 and at most 1 [-].

        Returns
        -------
        float
            Such that a leg of exactly this risk may be adopted [-].

        Raises
        ------
        RiskError
            If the share is none.
        """
        if not 0.0 < share <= 1.0:
            raise RiskError(f"share must be above 0 and at most 1, got {share:.6g}")
        return min(share * self.wealth, self.risk_bound) * (1.0 - 2.0 * TOLERANCE)

    def with_risk_bound(self, risk_bound: float) -> Account:
        """Return the account under another bound for the whole mission.

        Parameters
        ----------
        risk_bound : float
            The new Δ: the unallocated risk changes by as much [-].

        Returns
        -------
        Account
            With the same tail.

        Raises
        ------
        RiskError
            If less is unallocated than would be taken: the rest is allocated to the leg in the air.
        """
        _check_risk(risk_bound, "risk_bound")
        bank = self.bank + (risk_bound - self.risk_bound)
        if bank < 0.0:
            raise RiskError(
                f"risk_bound can be lowered to {self.risk_bound - self.bank:.6g} at most, the rest "
                f"is allocated to the leg in the air; got {risk_bound:.6g}"
            )
        return replace(self, risk_bound=risk_bound, bank=bank)


def _check_risk(value: object, name: str) -> None:
    """Refuse numbers that are neither probabilities nor sums of probabilities."""
    if not is_number(value):
        raise ArgumentTypeError(f"{name} must be a number, got {value_text(value)}")
    if not (math.isfinite(value) and value >= 0.0):
        raise RiskError(f"{name} must be finite and at least 0, got {value:.6g}")
