"""A mission under way: measured states in; controls out, and what was decided and why."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor

import numpy.typing as npt

from radmpc.arguments import check_callable
from radmpc.arrays import Vector
from radmpc.errors import ArgumentError
from radmpc.flying.account import Account
from radmpc.flying.candidates.judging import Planning, planning_with
from radmpc.flying.candidates.sources import Moment, Sources
from radmpc.flying.candidates.times import Timer
from radmpc.flying.commanding import commanded
from radmpc.flying.deciding import (
    MISS_PRICE,
    SHARE,
    Decision,
    Later,
    Rule,
    decided,
    opened,
    plan_ahead,
)
from radmpc.flying.knowing import expected_start
from radmpc.flying.locking import one_at_a_time
from radmpc.flying.logbook import Logbook
from radmpc.flying.measuring import (
    check_contacts,
    check_continues,
    check_number,
    check_options,
    measured,
    plan_of,
)
from radmpc.flying.sensing.gaps import flown_by, unmeasured
from radmpc.flying.sensing.measurements import Sensing
from radmpc.flying.tick import Contact, Tick
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.result import Result
from radmpc.wording import distinct_texts

__all__ = ["Mission"]


class Mission(Logbook):
    """A plan that is flown, and made anew from what is measured as far as its risk bound allows.

    The probability of any collision in the mission is at most Δ, by whatever planner and however
    often it is planned anew, as long as the model and its filters hold and controls do not saturate
    (docs/flying.md). The leg in the air, the tail, may always be flown on. Threads that call it at
    once wait for each other.

    Parameters
    ----------
    result : Result or Plan
        What is flown first.
    planner : str, callable or None
        A preset's name, or what makes a plan (or a result, or None) of a scenario and of the
        seconds there are; None never plans anew.
    share : float
        φ, what a candidate may use of the remaining risk, above 0 and at most 1 [-].
    miss_price : float
        Effort that missing goals by a meter is worth, at least 0 [1/m].
    seed : int
        Of every plan.
    executor : Executor or None
        Where the planner plans for the next step while this one is flown, its owner's to shut down;
        None asks it on the spot.
    warm : bool or None
        Whether half-spaces are turned to the paths in the air at each step; None: with an executor.
    clock : callable
        Returns seconds; only differences count.

    Raises
    ------
    ArgumentTypeError
        If an argument is of another kind.
    ArgumentError
        If a number is out of its range.
    NoPlanError
        If the result holds no plan.
    RiskError
        If the plan's certificate exceeds Δ.
    ScenarioError
        If there is no such planner.
    """

    _bound_name = "Δ = "  # what alarms call the risk bound

    def __init__(
        self,
        result: Result | Plan,
        *,
        planner: str | Planning | None = "certified",
        share: float = SHARE,
        miss_price: float = MISS_PRICE,
        seed: int = 0,
        executor: Executor | None = None,
        warm: bool | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        plan = plan_of(result)
        check_callable(clock, "clock")
        check_options(seed, executor, warm)
        planning = planning_with(planner, seed)
        self._sources = Sources.of(
            plan.scenario, planning, executor, is_warm=warm, miss_price=miss_price
        )
        self._rule = Rule(self._sources, share, miss_price)
        self._clock = clock
        super().__init__(plan.scenario, *opened(plan, 0))
        self._sensing = Sensing.of(plan.scenario)
        self._sources.prepare(self._leg, self._clock)
        self._enter("opened", self._account.tail)
        self._known = self._expected = tuple(expected_start(v) for v in plan.scenario.vehicles)

    @one_at_a_time
    def step(
        self,
        states: Mapping[str, npt.ArrayLike | None] | Sequence[npt.ArrayLike | None] | None,
        *,
        deadline: float | None = None,
        contacts: Sequence[Contact] = (),
    ) -> Tick:
        """Decide what to do until the next step.

        Parameters
        ----------
        states : mapping, sequence of (n,) array or None, or None
            Measured or, with a `measurement`, estimated; by vehicle or in the scenario's order.
            None, or what is not finite, is no measurement: that vehicle flies as expected.
        deadline : float or None
            Seconds from now until which the decision is needed; None plans without a limit.
        contacts : sequence of Contact
            What was hit since the last step.

        Returns
        -------
        Tick
            Controls, and what was decided and why.

        Raises
        ------
        ArgumentError
            If the mission is over, or the deadline is no time.
        ScenarioError
            If states do not fit the vehicles.
        """
        begun = self._clock()
        if self.is_over:
            raise ArgumentError(f"the mission of {self._scenario.horizon} steps is over")
        check_number(0.0 if deadline is None else deadline, "deadline")
        check_contacts(contacts)
        given = measured(self._scenario, states)
        self._contacts += contacts
        if given is None:
            known, alarms = flown_by(self._scenario, self._expected, states)
            decision = Decision(None, unmeasured(self._scenario, states), None, None, None)
        else:
            known, alarms = self._looked(given)
            end = float("inf") if deadline is None else begun + deadline
            decision = self._decided(known, alarms, Timer(self._clock, end))
        self._known = known
        tick = self._flown(known, decision, alarms, begun)
        if decision.next_step is not None and not self.has_failed:
            now = self._account, self._sensing.evidence
            later = Later(self._step, self._leg, self._expected, *now)
            plan_ahead(self._rule, later, decision.next_step, is_timed=deadline is not None)
        return tick

    def wait(self, seconds: float | None = None) -> bool:
        """Wait for what is planned in the background: then the same seed makes the same flight.

        Parameters
        ----------
        seconds : float or None
            At most; None is as long as it takes.

        Returns
        -------
        bool
            Whether it is there, or nothing is being planned.
        """
        return self._sources.wait(seconds)

    @one_at_a_time
    def close(self) -> None:
        """Give up what is planned in the background; the executor is its owner's to shut down."""
        self._sources.close()

    @one_at_a_time
    def remainder(
        self,
        states: Mapping[str, npt.ArrayLike] | Sequence[npt.ArrayLike],
        risk_bound: float | None = None,
    ) -> Scenario:
        """Return the steps that are left as a scenario: what to plan before `start_again`.

        Parameters
        ----------
        states : mapping or sequence of (n,) array
            Measured or estimated now, as `step` takes them next.
        risk_bound : float or None
            What the rest may risk [-]; None is Δ of the mission.

        Returns
        -------
        Scenario
            From all that is known of vehicles, visits that are made left out. Add to it what the
            mission did not know of.

        Raises
        ------
        ArgumentError
            If no step is left, the states are not finite, or others were measured at this step.
        RiskError
            If the bound is no risk bound.
        ScenarioError
            If states do not fit the vehicles.
        """
        if self._step >= self._scenario.horizon:
            raise ArgumentError(f"no step of the {self._scenario.horizon} is left to plan")
        if (given := measured(self._scenario, states)) is None:
            raise ArgumentError("states must be finite: the rest begins with them")
        account = self._account if risk_bound is None else Account(risk_bound, 0.0, 0.0)
        known, _ = self._looked(given)
        return self._sensing.evidence.left(self._leg, self._step, known, account.risk_bound)

    @one_at_a_time
    def start_again(self, result: Result | Plan) -> None:
        """Open the account anew after an event that the plan did not model, such as a new obstacle.

        What is promised then is promised from here on, whatever was hit: the log says "new grant".
        A plan of the `remainder` goes on with all that is known by then. Of any other, or with
        other noise, vehicles and their filters begin with what its scenario says.

        Parameters
        ----------
        result : Result or Plan
            A plan of the steps that are left, from where the vehicles are.

        Raises
        ------
        NoPlanError
            If the result holds no plan.
        RiskError
            If its certificate exceeds its Δ.
        ScenarioError
            If it is of another number of steps than are left, or of other vehicles; if vehicles
            learn of each other's states, and it is no plan of the remainder.
        """
        plan = plan_of(result)
        check_continues(plan, self._scenario, self._scenario.horizon - self._step)
        leg, account = opened(plan, self._step)
        self._leg, self._expected = self._sensing.begin_again(leg, self._leg, self._expected)
        self._account, self._past = account, len(self._contacts)
        self._sources.renew(self._leg, self._clock)
        self._enter("new grant", self._account.tail)

    def _looked(self, given: tuple[Vector, ...]) -> tuple[tuple[Vector, ...], list[str]]:
        """Take note of a measurement, once a step; return what is known by it, and alarms."""
        is_certain = not self._ticks or self._ticks[-1].value is not None
        seen = self._step, self._expected, given, self._leg
        return self._sensing.look(*seen, is_certain=is_certain)

    def _decided(self, states: tuple[Vector, ...], alarms: list[str], timer: Timer) -> Decision:
        """Value the tail, and decide what is flown."""
        value = self._leg.value(self._step, states, self._sensing.evidence.scale)
        self._account = self._account.kept(value.least)
        if value.total > self._account.risk_bound:
            risks, allowed = distinct_texts(value.total, self._account.risk_bound)
            alarms.append(f"what is left risks {risks}, more than {self._bound_name}{allowed}")
        if self.has_failed:
            return Decision(None, self._failure(), value.total, None, value.next_step)
        moment = Moment(self._step, states, self._leg, value, self._account, self._sensing.evidence)
        return decided(self._rule, moment, timer)

    def _flown(
        self, states: tuple[Vector, ...], decision: Decision, alarms: list[str], begun: float
    ) -> Tick:
        """Book a decision, and return what vehicles do by it."""
        wealth = self._account.wealth
        if decision.leg is None or decision.price is None:
            self._enter("kept", None)
        else:
            self._account, self._leg = self._account.adopted(decision.price), decision.leg
            self._enter("adopted", decision.price)
            self._known = states = self._leg.begun(states)
        found = commanded(self._leg, self._step, states, alarms)
        tick = decision.tick(self._step, found.segments, wealth, (alarms, self._clock() - begun))
        self._ticks.append(tick)
        self._expected = found.expected
        self._step += 1
        return tick
