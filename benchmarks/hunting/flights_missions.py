"""Missions of the hunt: flown in ways of all kinds, every tick looked at as it comes."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import radmpc
from hunting.catch import Notes
from hunting.flights_planners import Instant, Ticking, Vandal, quick
from hunting.flights_ticks import tick_problems
from hunting.flights_world import World, contacts_of
from radmpc.flying.tick import Contact, Tick
from radmpc.model.plan import Plan

__all__ = ["KINDS_OF_FLIGHT", "Flown", "flown", "is_repeated", "made"]

KINDS_OF_FLIGHT = (
    "kept", "warm", "replanned", "ahead", "vandal", "late", "windows", "blind", "again",
)  # fmt: skip
"""As planned; turned half-spaces; a planner; planned ahead; planners that break and are late; in
windows; with measurements that are lost, and the bound changed under way; started again."""

Anything = radmpc.Mission | radmpc.LongMission


@dataclass(slots=True)
class Flown:
    """What became of a mission.

    Attributes
    ----------
    ticks, adopted : int
        Decisions, and how many bought a leg.
    is_hit : bool
        Whether anything was hit before a control saturated.
    charged : float
        What the steps that were flown had been charged when they began, up to that hit or to a
        control that saturates [-]: hits happen at most as often.
    worth : float
        1 if something was hit, else the wealth at the end: on average at most Δ.
    far, unlikely, odd : int
        Alarms: a disturbance that is rare, several together, where there is no noise at all.
    digest : str
        Of all decisions.
    """

    ticks: int = 0
    adopted: int = 0
    is_hit: bool = False
    charged: float = 0.0
    worth: float = 0.0
    far: int = 0
    unlikely: int = 0
    odd: int = 0
    digest: str = ""


def made(kind: str, plan: Plan, rng: np.random.Generator) -> tuple[Anything, float | None]:
    """Return a mission of a kind, and the deadline of its decisions.

    Parameters
    ----------
    kind : str
        One of `KINDS_OF_FLIGHT`.
    plan : Plan
        What is flown first.
    rng : Generator
        Decides the rest.
    """
    if kind == "windows":
        return _in_windows(plan, rng), None
    deadline = None
    options: dict[str, Any] = {"planner": quick, "share": float(rng.choice([0.6, 0.6, 1.0, 0.05]))}
    if kind in {"kept", "warm"}:
        options |= {"planner": None, "warm": kind == "warm"}
    elif kind == "ahead":
        options |= {"executor": Instant(rng)}
    elif kind == "vandal":
        executor = Instant(rng) if rng.random() < 0.4 else None
        warm = bool(rng.random() < 0.3)
        options |= {"planner": Vandal(rng, plan), "executor": executor, "warm": warm}
    elif kind == "late":
        clock = Ticking(step=float(rng.choice([0.0, 1e-4, 2e-3])))
        options |= {"planner": Vandal(rng, plan, clock), "warm": True, "clock": clock}
        deadline = float(rng.choice([0.0, 1e-3, 0.05]))
    return radmpc.Mission(plan, **options), deadline


def _in_windows(plan: Plan, rng: np.random.Generator) -> radmpc.LongMission:
    """Return a mission in windows, toward the goals that the plan has or to choose from."""
    scenario = plan.scenario
    is_led = rng.random() < 0.7 or scenario.num_vehicles > 3
    if is_led:
        vehicles = tuple(replace(v, via=_timed(v.via, scenario.horizon)) for v in scenario.vehicles)
        scenario = replace(scenario, goals=(), vehicles=vehicles)
    window = int(rng.integers(2, scenario.horizon + 1))
    overlap, warm = int(rng.integers(1, window)), bool(rng.random() < 0.5)
    guide = _along(plan) if is_led else None
    return radmpc.LongMission(
        scenario, window=window, overlap=overlap, guide=guide, planner=quick, warm=warm
    )


def _timed(via: Sequence[radmpc.Visit], horizon: int) -> tuple[radmpc.Visit, ...]:
    """Return visits with windows, which a given guide asks for."""
    return tuple(replace(visit, between=visit.window(horizon)) for visit in via)


def _along(plan: Plan) -> Callable[[int], list[radmpc.Goal]]:
    """Return a guide along a plan."""

    def goals(step: int) -> list[radmpc.Goal]:
        vehicles = plan.scenario.vehicles
        if step == plan.scenario.horizon:
            return [v.goal for v in vehicles]
        places = [
            path.means[step][list(v.system.position)]
            for v, path in zip(vehicles, plan.trajectories, strict=True)
        ]
        return [radmpc.Goal.at(place, 0.3, None) for place in places]

    return goals


def flown(
    mission: Anything,
    world: World | radmpc.Model,
    notes: Notes,
    name: str,
    *,
    deadline: float | None = None,
    blind: np.random.Generator | None = None,
    is_restarted: bool = False,
) -> Flown:
    """Fly a mission, and look at every tick.

    Parameters
    ----------
    mission, world
        What is flown, in what.
    notes : Notes
        Gets what is wrong.
    name : str
        Of the mission.
    deadline : float or None
        As of `Mission.step`.
    blind : Generator or None
        Takes measurements away, and changes the risk bound; None does neither.
    is_restarted : bool
        Whether another account is opened in the middle.
    """
    result, is_sound = Flown(), True
    states, contacts = world.reset()
    digest = hashlib.sha256()
    scenario = mission.scenario
    told_exactly = all(v.measurement is None for v in scenario.vehicles) and all(
        o.spread is None for o in scenario.obstacles
    )
    while not mission.is_over:
        given = states if blind is None else _changed(mission, states, blind)
        if is_restarted and result.ticks == (scenario.horizon + 1) // 2:
            start_again(mission, states, result.ticks, notes, name)
        before = _balance(mission)
        tick = mission.step(given, deadline=deadline, contacts=contacts)
        failed = "planning failed" in tick.reason or "cannot be flown" in tick.reason
        if failed and name.startswith(("replanned", "windows", "again")):
            notes.add("planner", f"{name}: step {tick.step}: {tick.reason}")
        for problem in tick_problems(mission, tick, before):
            notes.add("tick", f"{name}: step {tick.step}: {problem}")
        is_sound &= not _count_alarms(result, tick)
        result.ticks, result.adopted = result.ticks + 1, result.adopted + (tick.choice != "tail")
        digest.update(repr([tick.choice, tick.reason, tick.wealth, tick.value]).encode())
        digest.update(b"".join(u.tobytes() for u in tick.controls))
        if tick.segments:
            if is_sound and not mission.contacts:
                result.charged += min(tick.next_step or 0.0, 1.0)
            before_states, (states, contacts) = states, world.advance(tick.segments)
            if isinstance(world, radmpc.Model) and told_exactly:
                now = before_states, states, tick.controls
                _compare(notes, name, scenario, (tick.step + 1, contacts), now)
            result.is_hit |= bool(contacts) and is_sound
    result.worth = 1.0 if mission.contacts else tick.wealth
    result.digest = digest.hexdigest()
    return result


def start_again(
    mission: Anything, states: Sequence[np.ndarray], step: int, notes: Notes, name: str
) -> None:
    """Plan what is left, or the same as a scenario of its own, and open another account with it."""
    scenario, left = mission.scenario, mission.scenario.horizon - step
    if left < 1 or isinstance(mission, radmpc.LongMission):
        return
    try:
        if step % 2 and not scenario.has_windows:
            rest = _as_stated(scenario, states, left)
        else:
            rest = mission.remainder(states, min(0.49, 1.5 * mission.balance.risk_bound))
            if rest.horizon != left:
                notes.add("planner", f"{name}: {rest.horizon} steps are left, not {left}")
        mission.start_again(quick(rest, None))
    except (radmpc.NoPlanError, radmpc.RiskError):
        return
    except radmpc.ScenarioError as error:
        if "learn of each other" not in str(error):
            raise


def _as_stated(
    scenario: radmpc.Scenario, states: Sequence[np.ndarray], left: int
) -> radmpc.Scenario:
    """Return the steps that are left as if nothing had been learned; without moving obstacles."""
    vehicles = [
        replace(v, start=x, initial_covariance=0.0 * v.initial_covariance)
        for v, x in zip(scenario.vehicles, states, strict=True)
    ]
    obstacles = [o for o in scenario.obstacles if not o.is_moving]
    return replace(scenario, horizon=left, vehicles=vehicles, obstacles=obstacles, goals=())


def _balance(mission: Anything) -> float | None:
    """Return the bank before a tick; None of missions in windows."""
    return None if isinstance(mission, radmpc.LongMission) else mission.balance.bank


def _changed(mission: Anything, states: Sequence[np.ndarray], rng: np.random.Generator) -> object:
    """Return what is measured, if it is; change the bound now and then."""
    kind = rng.random()
    if kind < 0.1 and isinstance(mission, radmpc.Mission):
        bound = mission.balance.risk_bound * rng.uniform(0.3, 1.2)
        with suppress(radmpc.RiskError):  # the leg in the air was bought with it
            mission.set_risk_bound(float(bound))
    if kind < 0.25:
        return None
    if kind < 0.4:
        return [np.full_like(x, np.nan) if i == 0 else x for i, x in enumerate(states)]
    names = [v.name for v in mission.scenario.vehicles]
    return dict(zip(names[::-1], list(states)[::-1], strict=True))


def _count_alarms(result: Flown, tick: Tick) -> bool:
    """Count alarms; return whether a control saturated."""
    result.far += sum("a disturbance of" in text for text in tick.alarms)
    result.unlikely += sum("the last" in text for text in tick.alarms)
    result.odd += sum("has no noise" in text for text in tick.alarms)
    return any("saturates" in text for text in tick.alarms)


def _compare(
    notes: Notes,
    name: str,
    scenario: radmpc.Scenario,
    told: tuple[int, Sequence[Contact]],
    path: tuple[Sequence[np.ndarray], Sequence[np.ndarray], Sequence[np.ndarray]],
) -> None:
    """Note contacts that the package's model does not tell, and those that it made up."""
    step, contacts = told
    before, after, controls = path
    if scenario.avoidance == "steps":
        found = contacts_of(scenario, step, after, after, None)
    else:
        found = contacts_of(scenario, step, before, after, controls)
    for each in {*found} - {*contacts}:
        notes.add("contact", f"{name}: not told: {each}")
    made_up = {*contacts} - {*found}
    if made_up and scenario.avoidance == "steps":
        notes.add("contact", f"{name}: made up: {made_up}")


def is_repeated(kind: str, plan: Plan, seed: Sequence[int]) -> bool:
    """Return whether the same seed makes the same flight.

    Parameters
    ----------
    kind : str
        Of the mission; no time limit may decide anything.
    plan : Plan
        What is flown.
    seed : sequence of int
        Of everything.
    """
    digests = set()
    for _ in range(2):
        mission, deadline = made(kind, plan, np.random.default_rng(seed))
        world = World(plan.scenario, seed)
        digests.add(flown(mission, world, Notes(), "", deadline=deadline).digest)
    return len(digests) == 1
