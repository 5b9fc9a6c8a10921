"""One scene of the hunt: planned in several ways, certified, flown, and held against itself."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from calibration_report import lower_limit
from hunt_bounds import simple_bounds
from hunt_catch import Catch, Notes, clock, watched
from hunt_flight import plain_collisions
from hunt_scenes import draw_scene
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners import Centralized, Ira, Planner, Sigmas, Uniform
from radmpc.planners.presets import PRESETS
from radmpc.planning import plan
from radmpc.referee import Certificate, simulate
from radmpc.result import Result
from radmpc.solvers.branch.branch import Branch

__all__ = ["PLANNERS", "Effort", "examine", "run_scene"]

PLANNERS: Mapping[str, Planner] = MappingProxyType(
    {
        "certified": PRESETS["certified"].planner,
        "ira": Planner(Ira(), Branch(), Centralized()),
        "uniform": Planner(Uniform(), Branch(), Centralized()),
        "radmpc": PRESETS["radmpc"].planner,
        "distance": PRESETS["distance"].planner,
        "sigmas": Planner(Sigmas(3.0), Branch(), Centralized()),
        "dlp": PRESETS["dlp"].planner,
    }
)
"""Who plans each scene: the planner that is hunted, and others to hold its answers against."""

_LEVEL = 1e-6
"""Chance of calling a sound certificate unsafe, per plan and simulation."""

_TELLING = 1e-5
"""Certificate from which on a plan is flown in full; a tenth of the flights below it."""

_EARLY = 0.7
"""Share of the time limit before which planning that ended was not ended by it."""

_ROUNDING = 1e-6
"""Relative difference of costs and bounds that solvers' tolerances make."""

_GAP = 1e-3

_LOOSE = 1.01
"""What a certificate may be of simple bounds: it has more half-spaces to choose from."""


@dataclass(frozen=True, slots=True)
class Effort:
    """What a scene may cost.

    Attributes
    ----------
    time_limit : float
        Seconds for the certified planner.
    other_limit : float
        Seconds for each of the others.
    samples : int
        Flights of a plan; 0 flies none.
    hang : float
        Seconds after which a call counts as hung, beyond its limit.
    planners : tuple of str
        Who plans, keys of `PLANNERS`.
    by_processor : bool
        Whether seconds of planning are the processor's, which other jobs do not stretch.
    """

    time_limit: float = 4.0
    other_limit: float = 2.0
    samples: int = 20_000
    hang: float = 30.0
    planners: tuple[str, ...] = tuple(PLANNERS)
    by_processor: bool = False


@dataclass(frozen=True, slots=True)
class _Answer:
    """One planner's answer, what it took, and what its plan's simple bounds sum to."""

    result: Result
    seconds: float
    cpu: float
    simple: float = math.inf

    @property
    def is_simple(self) -> bool:
        """Whether there is a sound plan whose simple bounds sum to Δ at most."""
        certificate = self.result.certificate
        if certificate is None or certificate.problems:
            return False
        return self.simple <= certificate.bound

    @property
    def is_certified(self) -> bool:
        """Whether there is a plan within Δ."""
        return self.result.is_certified

    @property
    def cost(self) -> float:
        """Of the plan; inf without one."""
        return math.inf if self.result.cost is None else self.result.cost


def run_scene(seed: int, index: int, effort: Effort) -> Catch:
    """Draw a scene and examine it."""
    return examine(draw_scene(seed, index), seed, index, effort)


def examine(scenario: Scenario, seed: int, index: int, effort: Effort) -> Catch:
    """Plan a scene in several ways, fly what comes of it, and look for contradictions.

    Parameters
    ----------
    scenario : Scenario
        The scene.
    seed, index : int
        Its names in the table; the index is also the seed of planners and flights.
    effort : Effort
        Limits.

    Returns
    -------
    Catch
        What was found; never raises for what planners do.
    """
    begun, notes = time.perf_counter(), Notes()
    answers: dict[str, _Answer] = {}
    for name in effort.planners:
        limit = effort.time_limit if name == "certified" else effort.other_limit
        with watched(notes, name, limit + effort.hang), clock(effort.by_processor):
            answers[name] = _planned(scenario, PLANNERS[name], limit, index)
    if effort.samples:
        for name, answer in answers.items():
            with watched(notes, f"flying {name}'s", 2.0 * effort.hang):
                _fly(notes, name, answer.result, effort.samples, index)
    for name, answer in answers.items():
        _check_time(notes, name, answer, effort)
        certificate = answer.result.certificate
        if certificate is not None and certificate.certified > _LOOSE * answer.simple + 1e-12:
            text = f"{certificate.certified:.4g} against {answer.simple:.4g} by simple bounds"
            notes.add("loose", f"{name}: {text}, Δ {scenario.risk_bound:.3g}")
    main = answers.get("certified")
    if main is not None:
        _check_answer(notes, main, answers, effort)
    return _caught(scenario, (seed, index), effort, answers, notes, time.perf_counter() - begun)


def _planned(scenario: Scenario, planner: Planner, limit: float, index: int) -> _Answer:
    """Return a planner's answer."""
    begun, cpu = time.perf_counter(), time.process_time()
    result = plan(scenario, planner, rng=index, time_limit=limit)
    taken = time.perf_counter() - begun, time.process_time() - cpu
    simple = math.inf if result.plan is None else simple_bounds(result.plan)
    return _Answer(result, *taken, simple)


def _fly(notes: Notes, name: str, result: Result, samples: int, index: int) -> None:
    """Fly a plan twice, by the referee's simulation and by a plain one."""
    record, certificate = result.plan, result.certificate
    if record is None or certificate is None:
        return
    number = samples if certificate.certified >= _TELLING else max(samples // 10, 1)
    flown = simulate(record, number, rng=index).collisions
    few = max(number // 4, 1)
    plain = plain_collisions(record, few, index)
    allowed = certificate.certified + certificate.saturation
    for way, hits, flights in (("simulated", flown, number), ("plain", plain, few)):
        if lower_limit(hits, flights, _LEVEL) > allowed + 1e-12:
            text = f"{hits} of {flights} {way} against {_risks(certificate)}"
            notes.add("unsafe", f"{name}: {text}")
    low = lower_limit(plain, few, 0.1 * _LEVEL)
    high = 1.0 - lower_limit(number - flown, number, 0.1 * _LEVEL)
    if low > high:
        notes.add("unlike", f"{name}: {flown} of {number} simulated, {plain} of {few} plain")


def _risks(certificate: Certificate) -> str:
    """Return what a certificate allows."""
    return f"{certificate.certified:.4g} + saturation {certificate.saturation:.4g}"


def _check_time(notes: Notes, name: str, answer: _Answer, effort: Effort) -> None:
    """Note limits that were overrun, and limits that were not."""
    limit = effort.time_limit if name == "certified" else effort.other_limit
    judging = answer.result.seconds["certificate"]
    if answer.seconds - judging > limit + 1.0:
        notes.add("late", f"{name}: {answer.seconds - judging:.1f} s of {limit:g}")
    if answer.cpu - judging > limit + 1.0:
        notes.add("late_cpu", f"{name}: {answer.cpu - judging:.1f} s of {limit:g}")
    if answer.seconds < _EARLY * limit and answer.result.status is Status.LIMIT:
        reason = f"after {answer.seconds:.1f} s of {limit:g}: {answer.result.explanation or ''}"
        notes.add("early", f"{name}: {reason}")


def _check_answer(
    notes: Notes, main: _Answer, answers: Mapping[str, _Answer], effort: Effort
) -> None:
    """Hold the certified planner's answer against those of the others."""
    result = main.result
    others = {n: a for n, a in answers.items() if n != "certified" and a.is_certified}
    if result.plan is not None and not main.is_certified:
        certificate = result.certificate
        assert certificate is not None
        notes.add("broken", "; ".join([certificate.summary, *certificate.problems]))
    if others and result.plan is None:
        name, best = min(others.items(), key=lambda item: item[1].cost)
        kind = "infeasible" if result.status is Status.INFEASIBLE else "lost"
        sums = f"simple bounds sum to {best.simple:.3g} of {result.record.scenario.risk_bound:.3g}"
        reason = f"{sums}; after {main.seconds:.1f} s: {result.explanation or ''}"
        notes.add(kind, f"{name} has {best.cost:.9g}; {reason}")
    ended = main.seconds < _EARLY * effort.time_limit
    for kind, group in (
        ("dear" if ended else "dear_late", {n: a for n, a in others.items() if a.is_simple}),
        ("dear_exact", {n: a for n, a in others.items() if not a.is_simple}),
    ):
        if group and result.plan is not None:
            name, best = min(group.items(), key=lambda item: item[1].cost)
            if main.cost > best.cost * (1.0 + max(_GAP, _gap(result))) + _ROUNDING:
                text = f"gap {_gap(result):.2g}, {main.seconds:.1f} s"
                notes.add(kind, f"{main.cost:.9g} against {name}'s {best.cost:.9g}, {text}")
    is_open = result.plan is not None and _gap(result) > _GAP * (1.0 + _ROUNDING)
    if is_open and main.cost > _ROUNDING and ended:
        notes.add("given_up", f"gap {_gap(result):.3g} after {main.seconds:.1f} s")
    _check_bound(notes, result, answers)


def _gap(result: Result) -> float:
    """Return the relative gap that is left open."""
    if result.cost is None or result.lower_bound is None:
        return 1.0
    return (result.cost - result.lower_bound) / max(abs(result.cost), 1e-9)


def _check_bound(notes: Notes, result: Result, answers: Mapping[str, _Answer]) -> None:
    """Note a lower bound, or a proof that there is nothing, that some plan refutes.

    Both speak of plans whose simple bounds sum to Δ at most, wherever such a plan comes from; the
    bound on any certified plan speaks of all that are certified.
    """
    bound, on_any = result.lower_bound, result.certified_lower_bound
    for name, answer in answers.items():
        is_below = on_any is not None and on_any > answer.cost * (1.0 + _ROUNDING) + _ROUNDING
        if answer.is_certified and is_below:
            notes.add("bound", f"{on_any:.9g} on any plan above {name}'s {answer.cost:.9g}")
        if name == "certified" or not answer.is_simple or bound is None:
            continue
        if bound > answer.cost * (1.0 + _ROUNDING) + _ROUNDING:
            notes.add("bound", f"{bound:.9g} above {name}'s {answer.cost:.9g}")


def _caught(
    scenario: Scenario,
    key: tuple[int, int],
    effort: Effort,
    answers: Mapping[str, _Answer],
    notes: Notes,
    seconds: float,
) -> Catch:
    """Return the line of the table."""
    main = answers.get("certified")
    lines = " | ".join(_line(name, a) for name, a in answers.items() if name != "certified")
    result = None if main is None else main.result
    nothing = float("nan")
    return Catch(
        seed=key[0],
        index=key[1],
        time_limit=effort.time_limit,
        avoidance=scenario.avoidance,
        dimension=scenario.dimension,
        vehicles=scenario.num_vehicles,
        obstacles=len(scenario.obstacles),
        horizon=scenario.horizon,
        bound=scenario.risk_bound,
        status="none" if result is None else result.status.value,
        cost=nothing if result is None or result.cost is None else result.cost,
        lower_bound=(
            nothing if result is None or result.lower_bound is None else result.lower_bound
        ),
        certified=(
            nothing
            if result is None or result.certificate is None
            else result.certificate.certified
        ),
        seconds=seconds,
        others=lines,
        kinds=" ".join(notes.kinds),
        notes=" | ".join(" ".join(text.split()) for text in notes.texts),
    )


def _line(name: str, answer: _Answer) -> str:
    """Return one planner's answer in short."""
    certificate = answer.result.certificate
    if answer.result.plan is None or certificate is None:
        return f"{name} {answer.result.status.value}"
    sign = "" if certificate.holds else "!"
    return f"{name} {answer.cost:.7g} @{sign}{certificate.certified:.3g}"
