"""Why not, and what helps: each cure is planned before it is a button."""

from __future__ import annotations

from collections.abc import Iterator

from radmpc.errors import ScenarioError
from radmpc.io.native.decoding import decode_scenario
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.planners.cures.variants import MOST_RISK, WEIGHTS, longer_horizons
from radmpc.planning import plan
from radmpc.preflight import concerns_of, outlook_of
from radmpc.records import dataclass
from radmpc.serving.documents.content import changed
from radmpc.serving.protocol import Content, Cure, Remark
from radmpc.serving.work.concerns import (
    concern_remarks,
    feedback_changes,
    horizon_cure,
    risk_bound_cure,
)
from radmpc.serving.work.control import Control
from radmpc.serving.work.reasons import remarks_of

__all__ = ["why_not"]

_FIRST_SECONDS = 12.0
"""Seconds to plan the document as it is, explanation included [s]."""

_CURE_SECONDS = 5.0
"""Seconds that each cure is given to lead to a plan [s]."""

_MORE_RISK = (2.0, 4.0)
"""Multiples of Δ that are tried [-]."""

_SOFT = WEIGHTS[:3]
"""Weights R of the control that are tried for a regulator, with Q = 1 [-]."""


@dataclass(frozen=True, slots=True)
class _Trial:
    """A kind of cure, and candidates for it: the mildest first."""

    kind: str
    cures: tuple[Cure, ...]


def why_not(control: Control, content: Content) -> list[Remark]:
    """Say what stands in the way of a plan, and what was tried and helps.

    Parameters
    ----------
    control : Control
        Asked whether to end.
    content : mapping
        The document, which is a scenario.

    Returns
    -------
    list of Remark
        Where there is a plan, what to know before planning.
    """
    scenario = decode_scenario(content)
    failure = _failure(control, scenario, _FIRST_SECONDS)
    if failure is None:
        return concern_remarks(outlook_of(scenario), content)
    remarks = list(remarks_of(failure))
    tried = {_key(cure) for remark in remarks for cure in remark["cures"]}
    cures: list[Cure] = []
    failed: list[str] = []
    for trial in _trials(scenario, content):
        if control.is_stopped():
            break
        worked = next((cure for cure in trial.cures if _works(control, content, cure)), None)
        if worked is None:
            failed.append(trial.kind)
        elif _key(worked) not in tried:
            cures.append(worked)
    if remarks:
        remarks[0] = {**remarks[0], "cures": [*remarks[0]["cures"], *cures]}
    if failed and not cures:
        text = f"Did not help: {', '.join(failed)}."
        remarks.append(
            {
                "severity": "warning",
                "text": text,
                "path": [],
                "vehicles": [],
                "at": None,
                "cures": [],
            }
        )
    return remarks


def _trials(scenario: Scenario, content: Content) -> Iterator[_Trial]:
    """Yield what may help, the cheapest to carry out first."""
    tried = longer_horizons(scenario)
    if tried:
        advised = [c.horizon for c in concerns_of(outlook_of(scenario)) if c.horizon is not None]
        longer = sorted({*advised, *tried})
        yield _Trial("a longer horizon", tuple(horizon_cure(scenario, n) for n in longer))
    bounds = [round(f * scenario.risk_bound, 4) for f in _MORE_RISK]
    yield _Trial("a larger risk bound", tuple(risk_bound_cure(b) for b in bounds if b <= MOST_RISK))
    everyone = list(range(scenario.num_vehicles))
    if any(v.disturbance_covariance.any() for v in scenario.vehicles):
        has_gain = any(v.gain is not None for v in scenario.vehicles)
        word = "Soften feedback" if has_gain else "Add feedback"
        yield _Trial(
            "feedback",
            tuple(
                Cure(
                    label=f"{word} (lqr, Q = 1, R = {weight:g})",
                    changes=feedback_changes(content, scenario, everyone, weight),
                )
                for weight in _SOFT
            ),
        )


def _works(control: Control, content: Content, cure: Cure) -> bool:
    """Whether a cure leads to a plan within Δ, in little time."""
    if control.is_stopped():
        return False
    try:
        scenario = decode_scenario(changed(content, cure["changes"]))
    except ScenarioError:
        return False
    return _failure(control, scenario, _CURE_SECONDS) is None


def _failure(control: Control, scenario: Scenario, seconds: float) -> Plan | None:
    """Plan until there is a plan within Δ; return None then, else the record that says why not."""
    found: list[Plan] = []
    result = plan(
        scenario,
        time_limit=seconds,
        improved=found.append,
        stop=lambda: bool(found) or control.is_stopped(),
    )
    return None if found or result.is_certified else result.record


def _key(cure: Cure) -> str:
    """Return what a cure changes, to tell whether it is known."""
    return repr([(list(change["path"]), change.get("value")) for change in cure["changes"]])
