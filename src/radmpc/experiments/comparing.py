"""Several planners on one scenario, judged by the same referee."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor

from radmpc.arguments import check_integer, check_time_limit, value_text
from radmpc.errors import ArgumentTypeError, ScenarioError, SolverError
from radmpc.model.given import check_scenario
from radmpc.model.scenario import Scenario
from radmpc.planners import Planner
from radmpc.planners.presets import parse_planner
from radmpc.planning import plan
from radmpc.records import dataclass
from radmpc.referee import Simulation, simulate
from radmpc.referee.simulation.simulation import check_samples
from radmpc.result import Result

__all__ = ["Comparison", "compare"]


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """One planner's answer.

    Attributes
    ----------
    planner : str
        As it was asked for.
    result : Result or None
        The answer; None where its solver gave up, or it does not plan such a scenario.
    simulation : Simulation or None
        The plan flown; None without one.
    problem : str or None
        What was said then.
    """

    planner: str
    result: Result | None
    simulation: Simulation | None
    problem: str | None = None

    @property
    def is_within(self) -> bool:
        """Whether there is a plan certified within the risk bound."""
        return self.result is not None and self.result.is_certified


def compare(
    scenario: Scenario,
    planners: Sequence[str],
    *,
    rng: int = 0,
    time_limit: float | None = None,
    samples: int = 100_000,
    executor: Executor | None = None,
    progress: Callable[[str, int, int | None], None] | None = None,
    stop: Callable[[], bool] | None = None,
) -> Iterator[Comparison]:
    """Plan a scenario with one planner after the other, and fly every plan.

    Parameters
    ----------
    scenario : Scenario
        The scenario to plan.
    planners : sequence of str
        Names, with arguments where they take one.
    rng : int
        Seed of every random choice, the same for each planner and each simulation.
    time_limit : float or None
        Seconds for each planner.
    samples : int
        Samples per plan.
    executor : Executor or None
        Where separate sets are planned.
    progress : callable or None
        Called with the planner and its stage, the parts done and their number.
    stop : callable or None
        Once it returns True, the planner at work returns what it has, and none follows.

    Returns
    -------
    iterator of Comparison
        Each as soon as it is there, in the order asked for.

    Raises
    ------
    ScenarioError
        If there is no such planner; before any is run.
    ArgumentError
        If an argument is of another kind, or ``samples`` not from 1 to 10⁹; before any is run.
    """
    check_scenario(scenario)
    if isinstance(planners, str) or not isinstance(planners, Iterable):
        raise ArgumentTypeError(f"planners must be a sequence of names, got {value_text(planners)}")
    records = [(parse_planner(name), name.strip()) for name in planners]
    rng = check_integer(rng, "rng", 0)
    check_time_limit(time_limit)
    samples = check_samples(samples)
    return _compared(scenario, records, rng, time_limit, samples, executor, progress, stop)


def _compared(
    scenario: Scenario,
    records: list[tuple[Planner, str]],
    rng: int,
    time_limit: float | None,
    samples: int,
    executor: Executor | None,
    progress: Callable[[str, int, int | None], None] | None,
    stop: Callable[[], bool] | None,
) -> Iterator[Comparison]:
    """Plan and fly with one planner after the other, as `compare` tells."""
    tell = progress or (lambda stage, done, total: None)
    for record, name in records:
        if stop is not None and stop():
            return

        def progressed(stage: str, done: int, total: int | None, name: str = name) -> None:
            tell(f"{name}: {stage}", done, total)

        try:
            result = plan(
                scenario,
                record,
                rng=rng,
                time_limit=time_limit,
                executor=executor,
                progress=progressed,
                stop=stop,
            )
        except (SolverError, ScenarioError) as error:
            yield Comparison(name, None, None, str(error))
            continue
        flown = None
        if result.plan is not None:
            progressed("samples", 0, None)
            flown = simulate(result.plan, samples, rng=rng)
        yield Comparison(name, result, flown)
