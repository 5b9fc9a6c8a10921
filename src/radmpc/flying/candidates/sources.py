"""Where candidates come from: the background, the paths in the air, a planner asked on the spot."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from functools import partial

from radmpc.arrays import Vector
from radmpc.flying.account import Account
from radmpc.flying.candidates.background import Background
from radmpc.flying.candidates.judging import (
    Candidate,
    Order,
    Planning,
    failed,
    judged,
    leg_judged,
    load_planning,
)
from radmpc.flying.candidates.times import NO_TIME, DecisionTimes, Timer
from radmpc.flying.knowing import expected_start
from radmpc.flying.leg import Leg
from radmpc.flying.remainder import left_of
from radmpc.flying.sensing.evidence import Evidence
from radmpc.flying.warm.goals import widened
from radmpc.flying.warm.search import Try, WarmSearch
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass, field, replace
from radmpc.referee.conditional.conditional import Conditional
from radmpc.referee.conditional.scales import Scale
from radmpc.solvers.solution import never

__all__ = ["Moment", "Sources"]

_TRIES = 2
"""Warm candidates at a tick at most [-]: a second one, at a higher price of risk, where the first
costs more than there is."""

_REHEARSALS = 3
"""Warm candidates before the first tick [-]: the price of risk is within some 10 % by then."""


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
    evidence : Evidence
        What was measured of covariances known up to a factor.
    """

    step: int
    states: tuple[Vector, ...]
    leg: Leg
    value: Conditional
    account: Account
    evidence: Evidence

    @property
    def is_unsafe(self) -> bool:
        """Whether what is left risks more than the whole mission was to risk."""
        return self.value.total > self.account.risk_bound

    def left(self, grant: float) -> Scenario:
        """Return the steps that are left, from measured states, under a bound."""
        return self.evidence.left(self.leg, self.step, self.states, grant)


@dataclass(slots=True, eq=False)
class Sources:
    """What makes candidates for a mission.

    Attributes
    ----------
    planning : callable or None
        Asked on the spot; None for no planner.
    warm : WarmSearch
        Turns the paths in the air.
    is_warm : bool
        Whether it does at every tick, or only where the tail risks too much.
    background : Background or None
        Plans for the next step; None for no planner.
    miss_price : float
        Effort that a meter beside a goal is worth [1/m].
    times : DecisionTimes
        How long candidates took to be judged.
    """

    planning: Planning | None
    warm: WarmSearch
    is_warm: bool
    background: Background | None
    miss_price: float
    times: DecisionTimes = field(default_factory=DecisionTimes)

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        planning: Planning | None,
        executor: Executor | None,
        *,
        is_warm: bool | None,
        miss_price: float,
    ) -> Sources:
        """Return the sources of a mission.

        Parameters
        ----------
        scenario : Scenario
            Of the mission.
        planning : callable or None
            What plans.
        executor : Executor or None
            Where it plans for the next step; None asks it on the spot.
        is_warm : bool or None
            As in the record; None is with an executor.
        miss_price : float
            As in the record.
        """
        background = Background(planning, executor) if planning and executor else None
        always = background is not None if is_warm is None else is_warm
        return cls(planning, WarmSearch(scenario), always, background, miss_price)

    def prepare(self, leg: Leg, clock: Callable[[], float]) -> None:
        """Do before the first tick what else it would wait for, and try what every tick does.

        Parameters
        ----------
        leg : Leg
            In the air.
        clock : callable
            Returns seconds.
        """
        scenario = leg.plan.scenario
        controls = tuple(path.controls for path in leg.plan.trajectories)
        starts = [expected_start(v) for v in scenario.vehicles]
        left = left_of(scenario, 0, starts, scenario.risk_bound)
        if self.planning is not None and self.background is None:
            load_planning(self.planning)
            judge = partial(leg_judged, controls, Order(left, left, leg.began), leg.began, starts)
            self.times.in_time(judge, Timer(clock, float("inf")), left.horizon)
        if not self.is_warm or scenario.has_windows:
            return
        asked = Try(left, controls, is_safest=False, is_stopped=never)
        for _ in range(_REHEARSALS):
            self.warm.search(asked)
        if self.miss_price > 0.0:
            self.warm.search(replace(asked, miss_price=self.miss_price))

    def renew(self, leg: Leg, clock: Callable[[], float]) -> None:
        """Begin anew with a leg of another scenario.

        Parameters
        ----------
        leg, clock
            As in `prepare`.
        """
        self.close()
        self.warm = WarmSearch(leg.plan.scenario)
        self.prepare(leg, clock)

    def wait(self, seconds: float | None) -> bool:
        """Wait for the background; return whether nothing is left to wait for."""
        return self.background is None or self.background.wait(seconds)

    def close(self) -> None:
        """Give up what is planned in the background."""
        if self.background is not None:
            self.background.close()

    @property
    def is_idle(self) -> bool:
        """Whether nothing ever makes any."""
        return self.planning is None and self.background is None and not self.is_warm

    def offers(self, moment: Moment, grant: float, timer: Timer) -> Iterator[Candidate]:
        """Yield candidates, or why there are none; those that take longest come last.

        Parameters
        ----------
        moment : Moment
            What is known.
        grant : float
            What they may risk [-].
        timer : Timer
            How long it may take.
        """
        arrived = None
        if self.background is not None:
            now = moment.evidence.scale
            arrived = self.background.arrived(moment.step, moment.states, now)
            if arrived is not None:
                yield arrived
        # Half-spaces are turned between starts and goals: of visits these programs know nothing.
        if (self.is_warm or moment.is_unsafe) and not moment.leg.plan.scenario.has_windows:
            base = moment.leg if arrived is None or arrived.leg is None else arrived.leg
            yield from self._warm(moment, (base, grant), timer)
        if self.planning is not None and self.background is None:
            yield self._on_the_spot(self.planning, moment, grant, timer)

    def _warm(self, moment: Moment, asked: tuple[Leg, float], timer: Timer) -> Iterator[Candidate]:
        """Yield candidates near the paths in the air."""
        (leg, grant), warm = asked, self.warm
        if not self.is_warm:
            # Asked now and then, it is to find the same in a flight that was resumed in between.
            warm.forget()
        left = moment.left(grant)
        controls = leg.mean_controls(moment.step, moment.states)
        scale = moment.evidence.scale
        is_stopped = partial(self.times.is_too_late, timer, left.horizon)
        # Where no plan to the goals is affordable, one that ends beside them may be.
        tries: list[float | None] = [None] * _TRIES
        tries += [self.miss_price] * (_TRIES if self.miss_price > 0.0 else 0)
        for number, missing in enumerate(tries):
            if number and missing is None and warm.is_out_of_reach:
                continue
            this = Try(left, controls, moment.is_unsafe, is_stopped, scale, missing)
            try:
                found = warm.search(this)
            except Exception as error:
                yield failed(error)
                return
            if found is None:
                yield Candidate(None, None, "turned half-spaces left no plan")
                return
            order = Order(left, found[1], moment.step, scale)
            judge = partial(leg_judged, found[0], order, moment.step, moment.states, scale)
            offer = self.times.in_time(judge, timer, left.horizon)
            yield offer
            if offer.price is None or moment.is_unsafe or timer.is_over():
                return
            warm.learn(offer.price)
            if offer.leg is None or moment.account.affords(offer.price):
                return
            warm.dearer(this, offer.price)

    def begin(self, left: Scenario, step: int, scale: Scale, seconds: float | None) -> None:
        """Have the background plan for a step to come.

        Parameters
        ----------
        left : Scenario
            The steps that are left by then, from where vehicles will be on average.
        step : int
            Of the mission, for which it plans.
        scale : Scale
            What the scenario takes for known of the factor of covariances.
        seconds : float or None
            What planning may take [s].
        """
        if self.background is not None:
            self.background.begin(left, step, scale, seconds)

    def _on_the_spot(
        self, planning: Planning, moment: Moment, grant: float, timer: Timer
    ) -> Candidate:
        """Return what a planner finds in the time that is left."""
        left, scale = moment.left(grant), moment.evidence.scale
        seconds = self.times.planning_seconds(timer, left.horizon)
        if seconds == 0.0:
            return Candidate(None, None, NO_TIME)
        order = Order(left, widened(left), moment.step, scale, is_timed=seconds is not None)
        begun = timer.clock()
        try:
            answer = planning(order.asked, seconds)
        except Exception as error:
            return failed(error)
        if seconds is not None:
            self.times.note_overrun(timer.clock() - begun - seconds)
        judge = partial(judged, answer, order, moment.step, moment.states, scale)
        return self.times.in_time(judge, timer, left.horizon)
