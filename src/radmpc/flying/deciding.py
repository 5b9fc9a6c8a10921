"""Whether the tail is flown on or another leg: what it may cost, and which is better."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from radmpc.arguments import is_number, value_text
from radmpc.arrays import Vector
from radmpc.errors import ArgumentError, ArgumentTypeError
from radmpc.flying.account import Account
from radmpc.flying.candidates.judging import Candidate
from radmpc.flying.candidates.sources import Moment, Sources
from radmpc.flying.candidates.times import LATE, Timer
from radmpc.flying.leg import Leg, leg_of
from radmpc.flying.measuring import check_number
from radmpc.flying.sensing.evidence import Evidence
from radmpc.flying.tick import Segment, Tick
from radmpc.model.plan import Plan
from radmpc.records import dataclass
from radmpc.wording import distinct_texts

__all__ = [
    "MISS_PRICE",
    "SHARE",
    "Decision",
    "Later",
    "Rule",
    "decided",
    "objection",
    "opened",
    "plan_ahead",
]

SHARE = 0.6
"""Share of the remaining risk that a candidate may use [-]. At 1 little soon remains: a leg that is
tight everywhere has no value after a step that went well (docs/flying.md)."""

MISS_PRICE = 20.0
"""Effort that a meter of missing the goals is worth [1/m]: 1 m/s² of a vehicle of weight 1, held
for a step, is an effort of 1. Without it much effort would go into the last centimeters
(docs/flying.md)."""

_LAST_TICKS = 2
"""Steps before the end at which a candidate may use all of the remaining risk [-]."""

_LEAST_GRANT = 1e-5
"""Remaining risk below which nothing is planned [-]: plans that risk nothing are long to find."""

_WORKER_SHARE = 0.8
"""Share of a step that planning for the next one gets where decisions have deadlines [-]."""


@dataclass(frozen=True, slots=True)
class Rule:
    """How a mission decides.

    Attributes
    ----------
    sources : Sources
        What makes candidates.
    share : float
        φ, what a candidate may use of the remaining risk, above 0 and at most 1 [-].
    miss_price : float
        Effort that missing goals by a meter is worth [1/m].
    """

    sources: Sources
    share: float
    miss_price: float

    def __post_init__(self) -> None:
        """Refuse numbers out of their ranges."""
        check_number(self.miss_price, "miss_price", most=1e300)
        if not is_number(self.share):
            raise ArgumentTypeError(f"share must be a number, got {value_text(self.share)}")
        if not 0.0 < self.share <= 1.0:
            raise ArgumentError(f"share must be above 0 and at most 1, got {self.share:.6g}")


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
        Conditional value of the tail [-]; None where not all were measured.
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

    def tick(
        self,
        step: int,
        flown: tuple[Segment, ...],
        wealth: float,
        notes: tuple[Sequence[str], float],
    ) -> Tick:
        """Return it as a tick of the mission.

        Parameters
        ----------
        step : int
            Of the mission.
        flown : tuple of Segment
            What vehicles do by it.
        wealth : float
            What there was [-].
        notes : tuple of sequence of str and float
            Alarms, and the seconds it took.
        """
        alarms, seconds = notes
        return Tick(
            step,
            flown,
            "tail" if self.leg is None else "candidate",
            self.reason,
            self.value,
            wealth,
            self.price,
            self.next_step,
            tuple(alarms),
            seconds,
        )


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


@dataclass(frozen=True, slots=True, eq=False)
class Later:
    """What is expected at the next step.

    Attributes
    ----------
    step : int
        Of the mission.
    leg : Leg
        In the air by then.
    expected : tuple of (n,) array
        Where vehicles will be on average.
    account : Account
        As it is now.
    evidence : Evidence
        As it is now.
    """

    step: int
    leg: Leg
    expected: tuple[Vector, ...]
    account: Account
    evidence: Evidence


def plan_ahead(rule: Rule, later: Later, next_step: float, *, is_timed: bool) -> None:
    """Have the background plan for the next step, within what will be left by then.

    Parameters
    ----------
    rule : Rule
        How the mission decides.
    later : Later
        What is expected.
    next_step : float
        What of the tail's value is run until then [-].
    is_timed : bool
        Whether decisions have deadlines, and planning with them.
    """
    scenario = later.leg.plan.scenario
    left = scenario.horizon - (later.step - later.leg.began)
    if left < 1 or rule.sources.background is None:
        return
    grant = _grant(rule, later.account.after(next_step), left)
    if grant >= _LEAST_GRANT:
        seconds = _WORKER_SHARE * scenario.dt if is_timed else None
        asked = later.evidence.left(later.leg, later.step, later.expected, grant)
        rule.sources.begin(asked, later.step, later.evidence.scale, seconds)


def _grant(rule: Rule, account: Account, left: int) -> float:
    """Return what a candidate may risk with so many steps left [-]."""
    return account.grant(1.0 if left <= _LAST_TICKS else rule.share)


def decided(rule: Rule, moment: Moment, timer: Timer) -> Decision:
    """Return what is flown from a moment on.

    Parameters
    ----------
    rule : Rule
        How the mission decides.
    moment : Moment
        What is known.
    timer : Timer
        How long it may take.
    """
    value = moment.value
    best, least = None, _score(rule, moment, moment.leg, value.total)
    refused: list[Candidate] = []
    for found in _offered(rule, moment, timer):
        reason = found.reason
        if found.leg is not None and found.price is not None:
            score = _score(rule, moment, found.leg, found.price)
            reason = objection(moment, found.price, (least, score), is_first=best is None)
            if not reason:
                best, least = found, score
        if reason:
            refused.append(Candidate(None, found.price, reason))
    if best is not None and timer.is_nearly_over():
        # In time, but judging and comparing it took what was left.
        refused.append(Candidate(None, best.price, LATE))
        best = None
    if best is not None and best.leg is not None:
        reason = "the candidate is better, and its risk is within what remains"
        return Decision(best.leg, reason, value.total, best.price, best.next_step)
    last = refused[-1]
    return Decision(None, last.reason, value.total, last.price, value.next_step)


def _offered(rule: Rule, moment: Moment, timer: Timer) -> Iterator[Candidate]:
    """Yield candidates, at least one or why there is none."""
    sources = rule.sources
    left = moment.leg.plan.scenario.horizon - (moment.step - moment.leg.began)
    if left == 0 or sources.is_idle:
        yield Candidate(None, None, "the plan is kept" if left else "the mission is at its end")
        return
    grant = _grant(rule, moment.account, left)
    if grant < _LEAST_GRANT:
        yield Candidate(None, None, f"a candidate might risk {grant:.3g}, too little to plan with")
        return
    yield Candidate(None, None, "there was nothing to choose from")
    yield from sources.offers(moment, grant, timer)


def _score(rule: Rule, moment: Moment, leg: Leg, price: float) -> float:
    """Return what a leg is compared by: effort and miss to come, or its risk, safety first."""
    if moment.is_unsafe:
        return price
    look = leg.outlook(moment.step, moment.states)
    return look.effort + rule.miss_price * look.miss


def objection(moment: Moment, price: float, scores: tuple[float, float], *, is_first: bool) -> str:
    """Return why a candidate is not adopted; empty if it is, unless a better one comes.

    Parameters
    ----------
    moment : Moment
        What is known.
    price : float
        What it costs [-].
    scores : tuple of float
        What the best leg so far and the candidate are compared by, the less the better.
    is_first : bool
        Whether that best leg is the tail.
    """
    if not moment.account.affords(price):
        risks, remains = distinct_texts(price, moment.account.wealth)
        return f"the candidate risks {risks}, and {remains} remains"
    least, score = scores
    if score < least:
        return ""
    if not is_first:
        return "another candidate is better"
    if moment.is_unsafe:
        risks, tail = distinct_texts(price, moment.value.total)
        return f"the candidate risks {risks}, the tail {tail}"
    ours, other = f"{least:.4g}", f"{score:.4g}"
    than = "as good" if ours == other else "better"
    return f"the tail is {than}: {ours} against {other} still to come"
