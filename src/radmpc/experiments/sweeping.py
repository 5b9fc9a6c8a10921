"""One scenario planned at many values of its keys: what risk, noise or time cost."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from itertools import product

from radmpc.arguments import check_integer, check_path, check_time_limit, is_number, value_text
from radmpc.errors import ArgumentError, ArgumentTypeError, ScenarioError, SolverError
from radmpc.io.native.changes import changed
from radmpc.io.native.decoding import decode_scenario
from radmpc.io.native.encoding import encode_scenario
from radmpc.io.native.plain import plain_mapping
from radmpc.io.native.scenario_file import read_scenario_document
from radmpc.model.scenario import Scenario
from radmpc.planners import Planner
from radmpc.planners.presets import DEFAULT, parse_planner
from radmpc.planning import plan
from radmpc.records import dataclass
from radmpc.result import Result

__all__ = ["MOST_POINTS", "NOISE", "SweepPoint", "sweep", "sweep_scenarios"]

NOISE = "noise"
"""The one axis that is no key of a file: a factor on the standard deviation of every noise."""

MOST_POINTS = 10_000
"""Combinations of values in one sweep: a guard against slips."""

_COVARIANCES = frozenset({"covariance", "disturbance_covariance", "initial_covariance"})

Values = tuple[str, ...]
"""A value per axis, as JSON spells it."""


@dataclass(frozen=True, slots=True, eq=False)
class SweepPoint:
    """What planning made of one combination of values.

    Attributes
    ----------
    values : tuple of str
        One per axis, in the order asked for, as JSON spells them.
    scenario : Scenario
        What was planned.
    result : Result or None
        The answer; None where the solver gave up.
    problem : str or None
        What the solver said where it gave up.
    """

    values: Values
    scenario: Scenario
    result: Result | None
    problem: str | None = None


def sweep_scenarios(
    source: str | os.PathLike[str] | Scenario, over: Mapping[str, Sequence[object]]
) -> dict[Values, Scenario]:
    """Return the scenarios of every combination of values.

    Parameters
    ----------
    source : path or Scenario
        A scenario file, in which ``defaults`` are keys of their own, or a scenario.
    over : mapping of str to sequence
        Values by key, as in `load_scenario`; ``noise`` scales all standard deviations.

    Returns
    -------
    dict of tuple of str to Scenario
        By their values, as JSON spells them; those of the last axis change first.

    Raises
    ------
    FileFormatError
        If the file is no scenario.
    ScenarioError
        If a key or a value is none.
    ArgumentError
        If there is no axis, an axis without values, or more than 10,000 combinations.
    """
    axes = _checked(over)
    content = _content(source)
    scenarios = {}
    for values in product(*axes.values()):
        changes = dict(zip(axes, values, strict=True))
        factor = changes.pop(NOISE, 1.0)
        try:
            scenario = decode_scenario(changed(content, changes)[0])
        except ScenarioError as error:
            raise ScenarioError(f"{error} (at {_told(axes, values)})") from error
        words = tuple(json.dumps(value) for value in values)
        scenarios[words] = scenario if factor == 1.0 else _scaled(scenario, factor)
    return scenarios


def sweep(
    scenarios: Mapping[Values, Scenario],
    planner: str | Planner = DEFAULT,
    *,
    rng: int = 0,
    time_limit: float | None = None,
    done: Collection[Values] = (),
    executor: Executor | None = None,
    progress: Callable[[str, int, int | None], None] | None = None,
    stop: Callable[[], bool] | None = None,
) -> Iterator[SweepPoint]:
    """Plan one scenario after the other.

    Parameters
    ----------
    scenarios : mapping of tuple to Scenario
        By their values, see `sweep_scenarios`.
    planner : str or Planner
        A preset's name, or a record of choices.
    rng : int
        Seed of every random choice, the same for each.
    time_limit : float or None
        Seconds for each.
    done : collection of tuple
        Values to leave out.
    executor : Executor or None
        Where independent sets are planned.
    progress : callable or None
        Called with the stage, the scenarios done and their number.
    stop : callable or None
        Once it returns True, the scenario at work is left as it is, and none follows.

    Returns
    -------
    iterator of SweepPoint
        Each as soon as it is there; none whose planning was stopped.

    Raises
    ------
    ScenarioError
        If there is no such planner; before anything is planned.
    ArgumentError
        If the seed or the time limit is none.
    """
    record = parse_planner(planner) if isinstance(planner, str) else planner
    rng = check_integer(rng, "rng", 0)
    check_time_limit(time_limit)

    def run() -> Iterator[SweepPoint]:
        for number, (values, scenario) in enumerate(scenarios.items()):
            if values in done:
                continue
            if progress is not None:
                progress("scenarios", number, len(scenarios))
            try:
                result = plan(
                    scenario, record, rng=rng, time_limit=time_limit, executor=executor, stop=stop
                )
            except SolverError as error:
                yield SweepPoint(values, scenario, None, str(error))
                continue
            if stop is not None and stop():
                return
            yield SweepPoint(values, scenario, result)

    return run()


def _content(source: str | os.PathLike[str] | Scenario) -> object:
    """Return a valid scenario's content as its file has it."""
    if isinstance(source, Scenario):
        return encode_scenario(source)
    check_path(source)
    document = read_scenario_document(source)
    try:
        decode_scenario(document.value)
    except ScenarioError as error:
        raise document.failure(error) from error
    return document.value


def _checked(over: Mapping[str, Sequence[object]]) -> dict[str, list[object]]:
    """Return the axes, all of them with plain values."""
    if not isinstance(over, Mapping) or not over:
        raise ArgumentTypeError(f"over must be a mapping of keys to values, got {value_text(over)}")
    axes: dict[str, list[object]] = {}
    count = 1
    for key, entry in plain_mapping(over, ()).items():
        if not isinstance(entry, list) or not entry:
            raise ArgumentError(f"{key}: must be a sequence of values, got {value_text(over[key])}")
        if key == NOISE:
            wrong = [v for v in entry if not (is_number(v) and 0.0 <= v < float("inf"))]
            if wrong:
                raise ArgumentError(f"{NOISE}: must be factors >= 0, got {value_text(wrong[0])}")
        twice = [value for i, value in enumerate(entry) if value in entry[:i]]
        if twice:
            raise ArgumentError(f"{key}: has {value_text(twice[0])} twice")
        axes[key] = entry
        count *= len(entry)
    if count > MOST_POINTS:
        raise ArgumentError(f"must be at most {MOST_POINTS:,} combinations, got {count:,}")
    return axes


def _told(axes: Iterable[str], values: Iterable[object]) -> str:
    """Return which combination it is."""
    return ", ".join(f"{key}={value}" for key, value in zip(axes, values, strict=True))


def _scaled(scenario: Scenario, factor: object) -> Scenario:
    """Return a scenario with the standard deviation of every noise times a factor."""
    squared = float(str(factor)) ** 2
    return decode_scenario(_with_covariances(encode_scenario(scenario), squared))


def _with_covariances(content: object, squared: float) -> object:
    """Return plain content with every covariance in it times a number."""
    if isinstance(content, Mapping):
        return {
            key: _times(entry, squared)
            if key in _COVARIANCES
            else entry
            if key == "source"
            else _with_covariances(entry, squared)
            for key, entry in content.items()
        }
    if isinstance(content, list):
        return [_with_covariances(entry, squared) for entry in content]
    return content


def _times(entry: object, squared: float) -> object:
    """Return a number, a diagonal or a matrix times a number."""
    if isinstance(entry, list):
        return [_times(part, squared) for part in entry]
    return entry * squared if is_number(entry) else entry
