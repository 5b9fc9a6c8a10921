"""One method on one problem: planned, certified, simulated; and the row of its results."""

from __future__ import annotations

import os
import platform
import re
import time
from collections.abc import Callable

from radmpc.errors import SolverError
from radmpc.experiments.families import paper
from radmpc.model.plan import Plan, Status
from radmpc.planners import Couplings, Planner
from radmpc.planning import plan
from radmpc.records import dataclass
from radmpc.referee import simulate
from radmpc.result import Result

__all__ = ["Missed", "Row", "Task", "run_task"]

_SIMULATION_SEED = 1
"""Other than the planners', so that no sample repeats a choice of theirs."""


@dataclass(frozen=True, slots=True)
class Task:
    """What is to be done.

    Attributes
    ----------
    method : str
        Name of the method.
    planner : Planner
        Its record.
    vehicles : int
        Fleet size N of the problem.
    seed : int
        Seed of the problem, and of the planner.
    samples : int
        Samples to simulate.
    cap : float
        Seconds after which planning is ended.
    """

    method: str
    planner: Planner
    vehicles: int
    seed: int
    samples: int
    cap: float

    @property
    def key(self) -> tuple[str, str, int, int, int, float]:
        """What makes two rows answers to the same task."""
        planner = _without_nodes(str(self.planner))
        return (self.method, planner, self.vehicles, self.seed, self.samples, self.cap)


@dataclass(frozen=True, slots=True)
class Missed:
    """Two vehicles in different sets whose plans may collide.

    Attributes
    ----------
    one, other : str
        The vehicles.
    risk : float
        Bound on their collision probability over the whole mission.
    """

    one: str
    other: str
    risk: float


@dataclass(frozen=True, slots=True)
class Row:
    """How one task went; its fields are the keys of a line of the journal.

    Attributes
    ----------
    method, planner : str
        The method's name, and its record as text.
    vehicles, seed, samples : int
        As in the task.
    cap : float
        As in the task [s].
    status : str
        Of the plan; ``error`` where the solver gave up.
    cost, lower_bound, certified : float or None
        Of the plan.
    rate, rate_low, rate_high : float or None
        Simulated collision rate and its 95 % interval.
    sets : tuple of tuple of str
        Vehicles that were planned together.
    missed : tuple of Missed
        Pairs in different sets above the coupling threshold Ψ, the largest risk first.
    seconds : float
        Planning, certificate included [s].
    is_capped : bool
        Whether the cap ended it: the seconds are then a lower bound.
    explanation : str or None
        Why there is no plan.
    versions, machine : dict
        What it ran with, and on.
    """

    method: str
    planner: str
    vehicles: int
    seed: int
    samples: int
    cap: float
    status: str
    cost: float | None
    lower_bound: float | None
    certified: float | None
    rate: float | None
    rate_low: float | None
    rate_high: float | None
    sets: tuple[tuple[str, ...], ...]
    missed: tuple[Missed, ...]
    seconds: float
    is_capped: bool
    explanation: str | None
    versions: dict[str, str]
    machine: dict[str, str]

    @property
    def key(self) -> tuple[str, str, int, int, int, float]:
        """What makes two rows answers to the same task."""
        planner = _without_nodes(self.planner)
        return (self.method, planner, self.vehicles, self.seed, self.samples, self.cap)

    @property
    def has_plan(self) -> bool:
        """Whether there is a plan."""
        return self.cost is not None

    def is_success(self, bound: float) -> bool:
        """Whether the plan collides in at most this share of the samples, as the paper counts."""
        return self.rate is not None and self.rate <= bound


def _without_nodes(planner: str) -> str:
    """Return a planner's line without its limit of nodes, which older journals do not tell."""
    return re.sub(r"\(max_nodes=\d+\)", "", planner)


def run_task(task: Task, stop: Callable[[], bool] | None = None) -> Row:
    """Plan a problem by a method, and fly the plan.

    Parameters
    ----------
    task : Task
        What to do.
    stop : callable or None
        Asked often; planning ends early once it returns True.

    Returns
    -------
    Row
        Also where there is no plan, or the solver failed.
    """
    scenario = paper(task.vehicles, task.seed)
    begun = time.perf_counter()
    try:
        result = plan(scenario, task.planner, rng=task.seed, time_limit=task.cap, stop=stop)
    except SolverError as error:
        return _row(task, time.perf_counter() - begun, None, str(error))
    return _row(task, result.seconds["total"], result, result.explanation)


def _row(task: Task, seconds: float, result: Result | None, explanation: str | None) -> Row:
    """Return the row of a task."""
    record = None if result is None else result.record
    found = None if result is None else result.plan
    flown = None if found is None else simulate(found, task.samples, rng=_SIMULATION_SEED)
    return Row(
        method=task.method,
        planner=str(task.planner),
        vehicles=task.vehicles,
        seed=task.seed,
        samples=task.samples,
        cap=task.cap,
        status="error" if record is None else record.status.value,
        cost=None if record is None else record.cost,
        lower_bound=None if record is None else record.lower_bound,
        certified=None if record is None else record.risk.certified,
        rate=None if flown is None else flown.rate,
        rate_low=None if flown is None else flown.rate_low,
        rate_high=None if flown is None else flown.rate_high,
        sets=() if record is None else record.sets,
        missed=() if found is None else _missed(found, task.planner),
        seconds=seconds,
        # A proof is an end of its own; whatever else took as long was ended by the cap.
        is_capped=seconds >= task.cap and (record is None or record.status is not Status.OPTIMAL),
        explanation=explanation,
        versions={} if record is None else dict(record.versions),
        machine=_machine(),
    )


def _missed(plan: Plan, planner: Planner) -> tuple[Missed, ...]:
    """Return the pairs of different sets that risk more than the coupling threshold."""
    threshold = Couplings().threshold
    if isinstance(planner.decomposition, Couplings):
        threshold = planner.decomposition.threshold
    number = {name: i for i, members in enumerate(plan.sets) for name in members}
    risks: dict[tuple[str, str], float] = {}
    for row in plan.risk.ledger:
        if row.cause == "pair" and row.other is not None:
            pair = (min(row.vehicle, row.other), max(row.vehicle, row.other))
            risks[pair] = risks.get(pair, 0.0) + row.risk
    found = [
        Missed(*pair, risk)
        for pair, risk in risks.items()
        if risk > threshold and number.get(pair[0]) != number.get(pair[1])
    ]
    return tuple(sorted(found, key=lambda missed: -missed.risk))


def _machine() -> dict[str, str]:
    """Return the machine's properties, without its name."""
    return {
        "system": platform.system(),
        "architecture": platform.machine(),
        "processors": str(os.cpu_count() or 0),
    }
