"""One scene of the hunt: planned in several ways, certified, flown, and held against itself."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping

from calibrating.report import lower_limit
from hunting.answers import PLANNERS, Answer, Effort
from hunting.bounds import simple_bounds
from hunting.catch import Catch, Notes, clock, watched
from hunting.contradictions import check_answer, check_time
from hunting.flight import plain_collisions
from hunting.norms import with_norms
from hunting.scenes import draw_scene
from radmpc.model.scenario import Scenario
from radmpc.planners import Planner
from radmpc.planning import plan
from radmpc.referee import Certificate, simulate
from radmpc.result import Result

__all__ = ["examine", "run_scene", "scene_of"]

_LEVEL = 1e-6
"""Chance of calling a sound certificate unsafe, per plan and simulation."""

_TELLING = 1e-5
"""Certificate from which on a plan is flown in full; a tenth of the flights below it."""

_LOOSE = 1.01
"""What a certificate may be of simple bounds: it has more half-spaces to choose from."""


def run_scene(seed: int, index: int, effort: Effort) -> Catch:
    """Draw a scene and examine it."""
    return examine(scene_of(seed, index, effort), seed, index, effort)


def scene_of(seed: int, index: int, effort: Effort) -> Scenario:
    """Draw a scene, with limits of norms where these are asked for.

    Parameters
    ----------
    seed, index : int
        Decide everything.
    effort : Effort
        What is asked for.
    """
    scenario = draw_scene(seed, index)
    return with_norms(scenario, seed, index) if effort.has_norms else scenario


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
    answers: dict[str, Answer] = {}
    for name in effort.planners:
        limit = effort.time_limit if name == "certified" else effort.other_limit
        with watched(notes, name, limit + effort.hang), clock(effort.by_processor):
            answers[name] = _planned(scenario, PLANNERS[name], limit, index)
    if effort.samples:
        for name, answer in answers.items():
            with watched(notes, f"flying {name}'s", 2.0 * effort.hang):
                _fly(notes, name, answer.result, effort.samples, index)
    for name, answer in answers.items():
        check_time(notes, name, answer, effort)
        certificate = answer.result.certificate
        if certificate is not None and certificate.certified > _LOOSE * answer.simple + 1e-12:
            text = f"{certificate.certified:.4g} against {answer.simple:.4g} by simple bounds"
            notes.add("loose", f"{name}: {text}, Δ {scenario.risk_bound:.3g}")
    main = answers.get("certified")
    if main is not None:
        check_answer(notes, main, answers, effort)
    return _caught(scenario, (seed, index), effort, answers, notes, time.perf_counter() - begun)


def _planned(scenario: Scenario, planner: Planner, limit: float, index: int) -> Answer:
    """Return a planner's answer."""
    begun, cpu = time.perf_counter(), time.process_time()
    result = plan(scenario, planner, rng=index, time_limit=limit)
    taken = time.perf_counter() - begun, time.process_time() - cpu
    simple = math.inf if result.plan is None else simple_bounds(result.plan)
    return Answer(result, *taken, simple)


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


def _caught(
    scenario: Scenario,
    key: tuple[int, int],
    effort: Effort,
    answers: Mapping[str, Answer],
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


def _line(name: str, answer: Answer) -> str:
    """Return one planner's answer in short."""
    certificate = answer.result.certificate
    if answer.result.plan is None or certificate is None:
        return f"{name} {answer.result.status.value}"
    sign = "" if certificate.holds else "!"
    return f"{name} {answer.cost:.7g} @{sign}{certificate.certified:.3g}"
