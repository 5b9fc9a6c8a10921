"""A whole mission, flown with a backend."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import ArgumentError, ArgumentTypeError
from radmpc.flying.measuring import States, check_number, heard
from radmpc.flying.model import Backend
from radmpc.flying.tick import Contact, Entry, Tick
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass
from radmpc.result import Result
from radmpc.wording import count_text, value_text

__all__ = ["PATIENCE", "Flight", "Flyable", "fly"]

PATIENCE = 600.0
"""Longest wait for a worker where no other is given [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """A mission as it was flown.

    Attributes
    ----------
    ticks : tuple of Tick
        Every decision.
    account : tuple of Entry
        Every change of the account.
    contacts : tuple of Contact
        What was hit.
    states : tuple of tuple of (n,) array
        Of all vehicles at k = 0..T, as measured; nan of one that was not.
    effort : float
        ``Σ weight · ‖u‖₁`` as flown.
    """

    ticks: tuple[Tick, ...]
    account: tuple[Entry, ...]
    contacts: tuple[Contact, ...]
    states: tuple[tuple[Vector, ...], ...]
    effort: float

    @property
    def has_collided(self) -> bool:
        """Whether anything was hit."""
        return bool(self.contacts)

    def __repr__(self) -> str:
        """Return it in one line."""
        adopted = sum(entry.what == "adopted" for entry in self.account)
        hit = count_text(len(self.contacts), "contact") if self.contacts else "no collision"
        steps = count_text(len(self.states) - 1, "step")
        replans = count_text(adopted, "replan")
        return f"Flight({steps}; {replans} adopted; {hit}; effort {self.effort:.6g})"


class Flyable(Protocol):
    """What `fly` flies: a mission, or one of many windows."""

    @property
    def scenario(self) -> Scenario:
        """What it is about."""
        ...

    @property
    def ticks(self) -> tuple[Tick, ...]:
        """Every decision, in order."""
        ...

    @property
    def account(self) -> tuple[Entry, ...]:
        """Every change of the account, in order."""
        ...

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """What was hit."""
        ...

    def wait(self, seconds: float | None = None) -> bool:
        """Wait for what is planned in the background; return whether it is there."""
        ...

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
        states : sequence of (n,) array or None
            What is measured.
        deadline : float or None
            Seconds from now.
        contacts : sequence of Contact
            What was hit since the last step.
        """
        ...


def fly(
    mission: Flyable,
    backend: Backend,
    *,
    deadline: float | None = None,
    patience: float = PATIENCE,
) -> Flight:
    """Fly a mission to its end, also after a collision.

    Parameters
    ----------
    mission : Mission or LongMission
        At its beginning. What it has planned in the background is waited for at every step, so
        that the same seed makes the same flight.
    backend : Backend
        What it is flown with; measured states are taken as exact.
    deadline : float or None
        Seconds that each decision may take; None is no limit.
    patience : float
        Seconds that the background is waited for at most; inf is as long as it takes. An order that
        took longer is not waited for again: the mission flies on without it, and judges its plan
        whenever it comes.

    Returns
    -------
    Flight
        Decisions, account, states and what was hit.

    Raises
    ------
    ArgumentTypeError
        If there is no mission, or no backend.
    ArgumentError
        If patience is below 0, or the mission has flown steps already.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> result = radmpc.plan(paper(2, seed=1), rng=0)
    >>> mission = radmpc.Mission(result, planner=None)  # the plan as it is
    >>> flight = radmpc.fly(mission, radmpc.Model(result.record.scenario, rng=1))
    >>> flight.contacts, len(flight.ticks)
    ((), 11)
    """
    _check_flyable(mission, backend)
    check_number(patience, "patience")
    flown = sum(bool(tick.segments) for tick in mission.ticks)
    if flown:
        steps = count_text(flown, "step")
        raise ArgumentError(f"mission must be at its beginning, got one that has flown {steps}")
    vehicles = mission.scenario.vehicles
    states, contacts = backend.reset()
    visited = [_seen(mission.scenario, states)]
    effort, is_there = 0.0, True
    most = None if patience == float("inf") else patience
    while True:
        is_there = mission.wait(most if is_there else 0.0)
        tick = mission.step(states, deadline=deadline, contacts=contacts)
        if not tick.segments:
            break
        pairs = zip(vehicles, tick.controls, strict=True)
        effort += sum(v.cost_weight * float(np.abs(u).sum()) for v, u in pairs)
        states, contacts = backend.advance(tick.segments)
        visited.append(_seen(mission.scenario, states))
    return Flight(mission.ticks, mission.account, mission.contacts, tuple(visited), effort)


def _seen(scenario: Scenario, states: States) -> tuple[Vector, ...]:
    """Return states in the scenario's order, nan of vehicles that were not measured."""
    pairs = zip(scenario.vehicles, heard(scenario, states), strict=True)
    return tuple(np.full(v.start.size, np.nan) if x is None else x for v, x in pairs)


def _check_flyable(mission: object, backend: object) -> None:
    """Refuse objects without the methods of a mission, or of a backend."""
    if not (hasattr(mission, "step") and hasattr(mission, "wait")):
        is_planned = isinstance(mission, Plan | Result)
        hint = ": radmpc.Mission makes one" if is_planned else ""
        raise ArgumentTypeError(
            f"mission must be a Mission or a LongMission, got {value_text(mission)}{hint}"
        )
    if not (hasattr(backend, "reset") and hasattr(backend, "advance")):
        raise ArgumentTypeError(
            f"backend must have reset and advance, as radmpc.Model has, got {value_text(backend)}"
        )
