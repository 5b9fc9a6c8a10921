"""What contradicts itself among the answers to one scene of the hunt."""

from __future__ import annotations

from collections.abc import Mapping

from hunting.answers import Answer, Effort
from hunting.catch import Notes
from radmpc.model.plan import Status
from radmpc.result import Result

__all__ = ["check_answer", "check_time"]

_EARLY = 0.7
"""Share of the time limit before which planning that ended was not ended by it."""

_ROUNDING = 1e-6
"""Relative difference of costs and bounds that solvers' tolerances make."""

_GAP = 1e-3


def check_time(notes: Notes, name: str, answer: Answer, effort: Effort) -> None:
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


def check_answer(notes: Notes, main: Answer, answers: Mapping[str, Answer], effort: Effort) -> None:
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
            if main.cost > best.cost * (1.0 + max(_GAP, main.gap)) + _ROUNDING:
                text = f"gap {main.gap:.2g}, {main.seconds:.1f} s"
                notes.add(kind, f"{main.cost:.9g} against {name}'s {best.cost:.9g}, {text}")
    is_open = result.plan is not None and main.gap > _GAP * (1.0 + _ROUNDING)
    if is_open and main.cost > _ROUNDING and ended:
        notes.add("given_up", f"gap {main.gap:.3g} after {main.seconds:.1f} s")
    _check_bound(notes, result, answers)


def _check_bound(notes: Notes, result: Result, answers: Mapping[str, Answer]) -> None:
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
