"""Whether the tail is flown on or another leg: what it may cost, and which is better."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from radmpc.arrays import Vector
from radmpc.errors import ArgumentError
from radmpc.flying.account import Account
from radmpc.flying.candidates import Candidate, Planning, candidate
from radmpc.flying.leg import Leg, leg_of
from radmpc.flying.measuring import check_number
from radmpc.model.plan import Plan
from radmpc.referee.conditional.conditional import Conditional

__all__ = [
    "MISS_PRICE",
    "SHARE",
    "UNKNOWN",
    "Decision",
    "Moment",
    "Rule",
    "Timer",
    "decided",
    "opened",
]

SHARE = 0.6
"""Share of the wealth that a candidate may cost [-]. At 1 the wealth dries up: a leg that is tight
everywhere is worth nothing after a step that went well (docs/flying.md)."""

MISS_PRICE = 20.0
"""Effort that a meter of missing the goals is worth [1/m]: 1 m/s² of a vehicle of weight 1, held
for a step, is an effort of 1. Without it "whatever can be had" buys much effort for the last
centimeters (docs/flying.md)."""

_LAST_TICKS = 2
"""Steps before the end at which a candidate may cost all of the wealth [-]."""

_LEAST_GRANT = 1e-5
"""Wealth below which nothing is planned [-]: planners search long for plans that risk nothing."""

_PLANNING_SHARE = 0.8
"""Share of the time to the deadline that planning gets [-]; the rest is for judging."""


@dataclass(frozen=True, slots=True)
class Rule:
    """How a mission decides.

    Attributes
    ----------
    planning : callable or None
        What makes candidates; None never plans anew.
    share : float
        φ, what a candidate may cost of the wealth, above 0 and at most 1 [-].
    miss_price : float
        Effort that missing goals by a meter is worth [1/m].
    """

    planning: Planning | None
    share: float
    miss_price: float

    def __post_init__(self) -> None:
        """Refuse numbers out of their ranges."""
        check_number(self.share, "share", 1.0)
        check_number(self.miss_price, "miss_price")
        if self.share == 0.0:
            raise ArgumentError("share must be above 0, got 0")


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """What is known when a decision is made.

    Attributes
    ----------
    step : int
        Of the mission.
    states : tuple of (n,) array
        Measured.
    leg : Leg
        In the air: the tail.
    value : Conditional
        What is left of it.
    account : Account
        With the tail valued.
    """

    step: int
    states: tuple[Vector, ...]
    leg: Leg
    value: Conditional
    account: Account


@dataclass(frozen=True, slots=True)
class Timer:
    """How long a decision may still take.

    Attributes
    ----------
    clock : callable
        Returns seconds.
    end : float
        When the decision is due, by that clock [s].
    """

    clock: Callable[[], float]
    end: float

    @property
    def left(self) -> float:
        """Seconds to the end; negative after it."""
        return self.end - self.clock()


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """What is flown, and why.

    Attributes
    ----------
    leg : Leg or None
        The leg that is adopted; None keeps the tail.
    reason : str
        Why, in one sentence.
    value : float or None
        Conditional value of the tail [-]; None where nothing was measured.
    price : float or None
        What the candidate costs, adopted or not [-]; None where there is none.
    next_step : float or None
        What of the value of the leg that is flown is run until the next step [-].
    """

    leg: Leg | None
    reason: str
    value: float | None
    price: float | None
    next_step: float | None


UNKNOWN = Decision(None, "nothing was measured", None, None, None)
"""The decision where nothing was measured."""


def opened(plan: Plan, step: int) -> tuple[Leg, Account]:
    """Return the leg that flies a plan from a step on, and an account for it.

    Parameters
    ----------
    plan : Plan
        With trajectories; of them the controls count.
    step : int
        Of the mission.

    Raises
    ------
    RiskError
        If its certificate exceeds its scenario's Δ.
    """
    leg = leg_of(plan.scenario, [t.controls for t in plan.trajectories], step)
    return leg, Account.opened(plan.scenario.risk_bound, leg.price)


def decided(rule: Rule, moment: Moment, timer: Timer | None) -> Decision:
    """Return what is flown from a moment on.

    Parameters
    ----------
    rule : Rule
        How the mission decides.
    moment : Moment
        What is known.
    timer : Timer or None
        How long it may take; None is no limit.
    """
    found = _sought(rule, moment, timer)
    value = moment.value
    reason = found.reason or _objection(rule, moment, found)
    if reason or found.leg is None or found.price is None:
        return Decision(None, reason, value.total, found.price, value.next_step)
    following = found.leg.value(moment.step, moment.states).next_step
    reason = "the candidate is better, and its price is within the wealth"
    return Decision(found.leg, reason, value.total, found.price, following)


def _sought(rule: Rule, moment: Moment, timer: Timer | None) -> Candidate:
    """Return a candidate in time, or why there is none."""
    scene, passed = moment.leg.plan.scenario, moment.step - moment.leg.began
    left = scene.horizon - passed
    if rule.planning is None or left == 0:
        return Candidate(None, None, "the plan is kept" if left else "the mission is at its end")
    grant = moment.account.grant(1.0 if left <= _LAST_TICKS else rule.share)
    if grant < _LEAST_GRANT:
        reason = f"a candidate might risk {grant:.3g}, too little to plan with"
        return Candidate(None, None, reason)
    seconds = None if timer is None else _PLANNING_SHARE * timer.left
    if seconds is not None and seconds <= 0.0:
        return Candidate(None, None, "there was no time to plan")
    start = moment.step
    found = candidate(rule.planning, scene, passed, moment.states, grant, seconds, start)
    if timer is not None and timer.left < 0.0:
        return Candidate(None, found.price, "the candidate came too late")
    return found


def _objection(rule: Rule, moment: Moment, found: Candidate) -> str:
    """Return why a candidate is not adopted; empty if it is."""
    if found.leg is None or found.price is None:
        return found.reason
    if not moment.account.affords(found.price):
        return f"the candidate costs {found.price:.3g}, the wealth is {moment.account.wealth:.3g}"
    if moment.value.total > moment.account.risk_bound:
        # Safety first: what is left risks more than the whole mission was to risk.
        if found.price < moment.value.total:
            return ""
        return f"the candidate risks {found.price:.3g}, the tail {moment.value.total:.3g}"
    ours, theirs = (
        look.effort + rule.miss_price * look.miss
        for look in (
            moment.leg.outlook(moment.step, moment.states),
            found.leg.outlook(moment.step, moment.states),
        )
    )
    if theirs >= ours:
        return f"the tail is better: {ours:.4g} against {theirs:.4g} still to come"
    return ""
