"""A mission longer than a window: every window a mission of its own, all from one account."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from threading import RLock
from typing import Any

from radmpc.arguments import check_callable, check_integer, value_text
from radmpc.arrays import Vector
from radmpc.errors import ArgumentError, ArgumentTypeError, NoPlanError
from radmpc.flying.candidates.judging import Order, Planning, answered, planning_with
from radmpc.flying.locking import one_at_a_time
from radmpc.flying.measuring import check_contacts, measured
from radmpc.flying.receding.itinerary import Guide, Itinerary, Progress
from radmpc.flying.receding.reserve import Reserve
from radmpc.flying.receding.window import Handover, Window, scene_of
from radmpc.flying.tick import Contact, Entry, Tick, failure, progress_text
from radmpc.flying.warm.goals import widened
from radmpc.model.given import check_scenario
from radmpc.model.scenario import Scenario
from radmpc.wording import count_text, distinct_texts

__all__ = ["LongMission"]

_LEAST_GRANT = 1e-5
"""Risk below which no window is planned [-]."""

_MOST = 0.49
"""Largest risk bound of a window [-]: scenarios take no more."""


class LongMission:
    """A mission that is planned to a window's end and extended before it gets there.

    The probability of any collision, in all windows together, is at most Δ of the scenario: windows
    are given shares of one account (docs/flying.md). That a next window can be planned is *not*
    promised: where none was by the end of the last one, the mission `is_stranded`.

    Parameters
    ----------
    scenario : Scenario
        All of the mission.
    window : int
        Steps that are planned at once, at least 2.
    overlap : int
        Steps left of a window from which on the next one is planned, at least 1.
    guide : callable or None
        Takes a step of the mission before its end, and returns a list of goals where vehicles are
        to be by then; None plans in coarse steps first, visits included, and assigns goals to
        choose from. With a guide, a visit is due by the last step of its window.
    planner : str or callable
        What plans windows, and within them, as in `Mission`; not None.
    seed : int
        Of every plan.
    **options
        As in `Mission`, of every window.

    Raises
    ------
    ArgumentTypeError
        If an argument is of another kind, or what the guide returns is.
    ArgumentError
        If the window is shorter than 2 steps, or the overlap is none of it.
    NoPlanError
        If there is no plan in coarse steps, or no first window.
    ScenarioError
        If a guide is given for goals to choose from, or for visits without windows.
    """

    def __init__(
        self,
        scenario: Scenario,
        *,
        window: int,
        overlap: int,
        guide: Guide | None = None,
        planner: str | Planning = "certified",
        seed: int = 0,
        **options: Any,
    ) -> None:
        check_scenario(scenario)
        check_integer(window, "window", 2)
        check_integer(overlap, "overlap", 1)
        if overlap >= window:
            told = value_text(overlap)
            raise ArgumentError(f"overlap must be below the window of {window}, got {told}")
        check_callable(guide, "guide")
        check_integer(seed, "seed", 0)
        planning = planning_with(planner, seed)
        if planning is None:
            raise ArgumentTypeError("planner must be a name or a function, got None")
        self._window, self._overlap = window, overlap
        self._itinerary = (
            Itinerary.planned(scenario, window)
            if guide is None
            else Itinerary.given(scenario, guide)
        )
        self._scenario = self._itinerary.scenario
        self._asked = Progress.none(len(scenario.vehicles))
        self._planning = planning
        self._options = {"planner": planner, "seed": seed, **options}
        self._ticks: list[Tick] = []
        self._entries: list[Entry] = []
        self._contacts: list[Contact] = []
        self._reserve = Reserve(scenario.risk_bound)
        self._lock = RLock()
        self._why_none = ""  # why there is no next window, in a clause
        found = self._opened(0, None)
        if found is None:
            raise NoPlanError(
                f"no plan of the first {min(window, scenario.horizon)} steps was found within "
                f"their risk: {self._why_none}"
            )
        self._mission, self._seen = found, 0

    @property
    def scenario(self) -> Scenario:
        """All of the mission, goals assigned."""
        return self._scenario

    @property
    def ticks(self) -> tuple[Tick, ...]:
        """Every decision, in order."""
        return tuple(self._ticks)

    @property
    def account(self) -> tuple[Entry, ...]:
        """Every change of the account, in order; the reserve counts as unallocated (`bank`)."""
        return tuple(self._entries)

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """What was hit."""
        return tuple(self._contacts)

    @property
    def is_stranded(self) -> bool:
        """Whether the last window is over, and the mission is not."""
        return self._mission.is_over and len(self._ticks) <= self._scenario.horizon

    @property
    def is_over(self) -> bool:
        """Whether there is nothing left to fly."""
        return self._mission.is_over

    def wait(self, seconds: float | None = None) -> bool:
        """Wait for the background; see `Mission.wait`.

        Parameters
        ----------
        seconds : float or None
            At most; None is as long as it takes.

        Returns
        -------
        bool
            Whether it is there, or nothing is being planned.
        """
        return self._mission.wait(seconds)

    @one_at_a_time
    def close(self) -> None:
        """Give up what is planned in the background."""
        self._mission.close()

    @one_at_a_time
    def step(
        self,
        states: Sequence[Vector] | None,
        *,
        deadline: float | None = None,
        contacts: Sequence[Contact] = (),
    ) -> Tick:
        """Decide what to do until the next step; see `Mission.step`.

        Parameters
        ----------
        states : mapping, sequence of (n,) array, or None
            What is measured.
        deadline : float or None
            Seconds from now; the next window is planned within it, too.
        contacts : sequence of Contact
            What was hit since the last step.

        Returns
        -------
        Tick
            Of the long mission's step.

        Raises
        ------
        ArgumentError
            If the mission is over or stranded, or the deadline is no time.
        ScenarioError
            If states do not fit the vehicles.
        """
        step = len(self._ticks)
        if self.is_over:
            raise ArgumentError(self._end())
        check_contacts(contacts)
        known = measured(self._scenario, states)
        self._contacts += contacts
        if self._is_due(step):
            self._extend(step, known, deadline)
        tick = self._mission.step(states, deadline=deadline, contacts=contacts)
        tick = replace(tick, step=step, wealth=tick.wealth + self._reserve.amount)
        self._take_entries()
        self._ticks.append(tick)
        if self.is_stranded:
            self._ticks[-1] = tick = replace(tick, reason=self._end())
        return tick

    def __repr__(self) -> str:
        """Return how far it is in one line."""
        end = None
        if self.is_over:
            flown = count_text(len(self._ticks) - 1, "step")
            end = f"{'stranded' if self.is_stranded else 'over'} after {flown}"
        wealth = self._entries[-1].wealth if self._entries else self._scenario.risk_bound
        told = progress_text(self._scenario, len(self._ticks), wealth, end)
        return f"LongMission({told}; {failure(self._contacts) or 'no collision'})"

    def _end(self) -> str:
        """Return in a few words that no step is left to fly."""
        horizon = self._scenario.horizon
        if self.is_stranded:
            flown = len(self._ticks) - 1
            why = failure(self._contacts) or self._why_none
            where = f"after {flown} of {horizon} steps"
            return f"the mission is stranded {where}: no next window: {why}"
        return f"the mission of {count_text(horizon, 'step')} is over"

    def _is_due(self, step: int) -> bool:
        """Whether the next window is to be planned."""
        end = self._mission.began + self._mission.scenario.horizon
        return not self._contacts and end < self._scenario.horizon and end - step <= self._overlap

    def _extend(self, step: int, states: tuple[Vector, ...] | None, deadline: float | None) -> None:
        """Plan the next window from here; fly this one on where that fails."""
        if states is None:
            self._why_none = "not all vehicles were measured"
            return
        found = self._opened(step, self._mission.handover(states), deadline)
        if found is not None:
            self._mission.close()
            self._mission, self._seen = found, 0

    def _opened(
        self, step: int, before: Handover | None, deadline: float | None = None
    ) -> Window | None:
        """Return the mission of a window, its bound taken from the account; None without a plan."""
        end = min(step + self._window, self._scenario.horizon)
        wealth = 0.0 if before is None else before.wealth
        grant = self._reserve.grant(wealth, end - step, self._scenario.horizon - step, _MOST)
        if grant < _LEAST_GRANT:
            self._why_none = f"it might risk {grant:.3g}, too little to plan with"
            return None
        ahead = self._itinerary.until(end)
        scene, known, scale = scene_of(ahead, step, grant, before)
        done = self._asked if before is None else self._asked.less(before.visits, before.arrived)
        scene = self._itinerary.asked(scene, step, done)
        order = Order(scene, widened(scene), 0, scale, is_timed=deadline is not None)
        found = answered(self._planning, order, deadline, known)
        if found.leg is None:
            self._why_none = found.reason
            return None
        if (price := found.leg.price) > grant:
            costs, share = distinct_texts(price, grant)
            self._why_none = f"the plan costs {costs}, its share of Δ is {share}"
            return None
        mission = Window(found.leg.plan, ahead, step, before, **self._options)
        self._reserve = self._reserve.given(wealth, grant)
        self._asked = self._itinerary.due(end, done)
        return mission

    def _take_entries(self) -> None:
        """Write down what the window's account did, the reserve in its bank."""
        kept = self._reserve.amount
        for entry in self._mission.account[self._seen :]:
            self._entries.append(
                replace(
                    entry,
                    step=entry.step + self._mission.began,
                    what="window" if entry.what == "opened" and self._mission.began else entry.what,
                    risk_bound=self._scenario.risk_bound,
                    bank=entry.bank + kept,
                    wealth=entry.wealth + kept,
                )
            )
        self._seen = len(self._mission.account)
