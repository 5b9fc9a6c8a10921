"""The price of risk from round to round, and when to go back to paths that were certified."""

from __future__ import annotations

import numpy as np

from radmpc.planners.certified.turned.paths import SavedPaths
from radmpc.planners.certified.turned.price_tuning import PRICE_TUNING
from radmpc.records import dataclass

__all__ = ["PriceControl", "SafePaths", "Taken"]


@dataclass(frozen=True, slots=True)
class Taken:
    """What paths come to.

    Attributes
    ----------
    certified : float
        Their certificate [-].
    cost : float
        Their cost.
    """

    certified: float
    cost: float


@dataclass(frozen=True, slots=True, eq=False)
class SafePaths:
    """Certified paths that one may go back to.

    Attributes
    ----------
    paths : SavedPaths
        What they are restored from.
    price : float
        Of a unit of probability, at which they were planned.
    certified : float
        Their certificate [-].
    """

    paths: SavedPaths
    price: float
    certified: float


@dataclass(slots=True, eq=False)
class PriceControl:
    """Moves the price until the certificate is just below Δ and the cost falls no more.

    The price follows the certificate. Where paths went from which no price leads back to a
    certificate of Δ, they are restored, and the price is higher from there.

    Attributes
    ----------
    price : float
        Of a unit of probability.
    risk_bound : float
        Δ [-].
    gap : float
        Relative difference of costs below which plans count as equal [-].
    rival : float
        Cost of the best plan known from elsewhere; inf where there is none.
    is_urgent : bool
        Whether rounds take so long that a first plan is worth more than a cheap one.
    is_brief : bool
        Whether the first plan that is charged enough of Δ ends the rounds.
    is_large : bool
        Whether little of the whole is much of many vehicles.
    num_stalls : int
        Rounds in a row that gained too little.
    safe : SafePaths or None
        The last certified paths of a round; None before.
    """

    price: float
    risk_bound: float
    gap: float
    rival: float = float("inf")
    is_urgent: bool = False
    is_brief: bool = False
    is_large: bool = False
    num_stalls: int = 0
    _num_rounds: int = 0
    _num_idle: int = 0
    _num_over: int = 0
    _num_worse: int = 0
    _num_backs: int = 0
    _cheapest: float = float("inf")
    _last_cost: float = float("inf")
    _last_certified: float = float("inf")
    _last_price: float = float("inf")
    safe: SafePaths | None = None
    _most: float = float("inf")

    def __post_init__(self) -> None:
        """Bound the price: risk that costs so much more than effort is stuck, whatever it costs."""
        self._most = PRICE_TUNING.dearest * self.price

    def begin(self, certified: float, cost: float, paths: SavedPaths) -> None:
        """Take note of the paths that rounds begin with.

        Parameters
        ----------
        certified, cost : float
            Their certificate [-] and cost.
        paths : SavedPaths
            What they are restored from.
        """
        self._last_certified = certified
        if certified <= self.risk_bound:
            self._cheapest, self.safe = cost, SafePaths(paths, self.price, certified)

    @property
    def is_over(self) -> bool:
        """Whether nothing more is expected of another round."""
        is_idle = self.safe is not None and self._num_idle >= PRICE_TUNING.most_idle
        is_worse = self._num_worse >= PRICE_TUNING.most_worse
        return is_idle or is_worse or self.num_stalls >= PRICE_TUNING.max_stalls

    def has_nearly_stopped(self, certified: float, cost: float, risk: float) -> bool:
        """Tell whether paths hardly move any more but for what they risk.

        Parameters
        ----------
        certified, cost, risk
            As in `follow`.
        """
        moved, _ = self._moved(certified, cost, risk)
        return moved <= PRICE_TUNING.little * self.gap * abs(cost)

    def follow(
        self,
        certified: float,
        cost: float,
        paths: SavedPaths,
        risk: float = 0.0,
        between: Taken | None = None,
    ) -> SavedPaths | None:
        """Choose the next price after a round; return paths to go back to first, if any.

        Parameters
        ----------
        certified, cost, paths
            As in `begin`, of the round's.
        risk : float
            What its half-spaces' risks sum to [-].
        between : Taken or None
            A certified plan between the last certified paths and the round's, where these risk too
            much.
        """
        self._count(Taken(certified, cost), risk, between)
        is_little = self._is_little(certified, cost)
        self.num_stalls = self.num_stalls + 1 if is_little else 0
        is_over = certified > self.risk_bound
        self._num_over = self._num_over + 1 if is_over else 0
        if not is_over:
            self._cheapest = min(self._cheapest, cost)
            self.safe = SafePaths(paths, self.price, certified)
        elif between is not None:
            self._cheapest = min(self._cheapest, between.cost)
        is_lost = (
            certified > PRICE_TUNING.lost * self.risk_bound
            or self._num_over >= PRICE_TUNING.most_over
        )
        is_lost |= is_little and certified > PRICE_TUNING.nearly_spent * self.risk_bound
        if is_lost and self.safe is not None and self._num_backs < PRICE_TUNING.most_backs:
            return self._back(self.safe)
        is_first = self.is_brief and self.safe is None
        aim = PRICE_TUNING.first_aim if is_first else PRICE_TUNING.aim
        ratio = certified / (aim * self.risk_bound)
        ratio = float(np.clip(ratio, 1.0 / PRICE_TUNING.most_fall, PRICE_TUNING.most_rise))
        power = self._power(certified, ratio)
        self._last_certified, self._last_cost, self._last_price = certified, cost, self.price
        self.price *= ratio**power
        if is_over and is_little and self.safe is not None:
            self.price *= PRICE_TUNING.nudge
        is_near = certified <= PRICE_TUNING.patient * self.risk_bound
        if is_over and self.safe is None and (self.is_urgent or not is_near):
            # The longer nothing is certified, the less it may cost to wait.
            waited = self._num_over if self.is_urgent else self._num_over - 1
            self.price *= (
                PRICE_TUNING.urgency if self.is_urgent else PRICE_TUNING.impatience
            ) ** waited
        self.price = min(self.price, self._most)
        return None

    def _power(self, certified: float, ratio: float) -> float:
        """Return the power of the ratio of certificate to aim that the price follows.

        A secant in logarithms where certificates come near the aim from below: there they answer
        the price the less, the more of the cost is due to what cannot be avoided.
        """
        # Where effort is free, so is risk.
        damping, fell = PRICE_TUNING.damping, self._last_price / max(self.price, 1e-300)
        if not PRICE_TUNING.near <= ratio <= 1.0 or not 1.0 < fell < np.inf:
            return damping
        rose = certified / max(self._last_certified, 1e-300)
        reply = float(np.log(rose) / np.log(fell))
        steepest = 1.0 / PRICE_TUNING.most_power
        return 1.0 / max(reply, steepest) if 0.0 < reply < 1.0 / damping else damping

    def _count(self, latest: Taken, risk: float, between: Taken | None) -> None:
        """Take note of how much a round gained, and of what others could gain."""
        self._num_rounds += 1
        certified, cost = latest.certified, latest.cost
        little = PRICE_TUNING.enough * self.gap * abs(cost)
        self._num_idle += 1
        is_over = certified > self.risk_bound
        best = between if is_over else latest
        moved, worth = self._moved(certified, cost, risk)
        # Paths that risk more than Δ would be dearer still if they did not.
        told = latest if best is None else best
        potential = moved + worth * max(self.risk_bound - told.certified, 0.0)
        is_behind = told.cost - self.rival > PRICE_TUNING.behind * potential
        is_behind &= self._num_rounds >= PRICE_TUNING.tried
        if best is not None and self._cheapest - best.cost >= little:
            self._num_idle = 0
        tuning = PRICE_TUNING
        share = tuning.negligible_of_many if self.is_large else tuning.negligible
        is_spent = best is not None and potential <= share * self.gap * abs(cost)
        is_worse = self.is_large and is_over and cost >= self.rival
        self._num_worse = self._num_worse + 1 if is_worse else 0
        if is_behind or is_spent:
            self._num_idle = PRICE_TUNING.most_idle

    def _moved(self, certified: float, cost: float, risk: float) -> tuple[float, float]:
        """Return what risk does not explain of the last change of the cost, and what risk costs."""
        worth = self.price * max(risk / max(certified, 1e-300), 1.0)
        return abs(self._last_cost - cost - worth * (certified - self._last_certified)), worth

    def _back(self, safe: SafePaths) -> SavedPaths:
        """Go on from certified paths at a higher price, the higher the more often."""
        self._num_backs, self._num_over, self.num_stalls = self._num_backs + 1, 0, 0
        self.price = PRICE_TUNING.dearer**self._num_backs * safe.price
        self.safe = SafePaths(safe.paths, self.price, safe.certified)
        self._last_certified, self._last_cost = self.risk_bound, float("inf")
        self._last_price = float("inf")
        return safe.paths

    @property
    def _is_waiting(self) -> bool:
        """Whether a certificate that hardly falls as the price rises is not worth more rounds."""
        return self.is_urgent and self.safe is None

    def _is_little(self, certified: float, cost: float) -> bool:
        """Whether a round gained too little."""
        little = PRICE_TUNING.enough * self.gap * abs(cost)
        is_same = abs(self._last_cost - cost) < little
        if certified > self.risk_bound:
            is_far = certified > PRICE_TUNING.close * self.risk_bound
            return (
                is_same or is_far or self._is_waiting
            ) and certified > PRICE_TUNING.less * self._last_certified
        if certified < PRICE_TUNING.spent * self.risk_bound:
            # The price is still falling.
            return is_same
        return max(self._cheapest, self._last_cost) - cost < little
