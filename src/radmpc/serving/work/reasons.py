"""Why a search ended without a plan within Δ, at the places it is about."""

from __future__ import annotations

import re

from radmpc.io.native.encoding import encode_scenario
from radmpc.model.ledger import bound_texts
from radmpc.model.plan import LedgerRow, Plan
from radmpc.model.scenario import Scenario
from radmpc.planners.presets import DEFAULT
from radmpc.preflight import outlook_of
from radmpc.serving.protocol import Cure, Remark
from radmpc.serving.wording import for_page
from radmpc.serving.work.concerns import concern_remarks, horizon_cure, risk_bound_cure
from radmpc.wording import names_of_choices

__all__ = ["remarks_of"]

_WORST = 3
"""Lines of the ledger that are told of a plan that risks too much [-]."""

_SENTENCE = re.compile(r"(?<=[.!?])\s+(?=[A-Z])")
_HORIZON = re.compile(r"lengthen the horizon to (\d+) steps")
_BOUND = re.compile(r"[Rr]aise risk_bound to ([0-9.e-]+[0-9])")
_QUOTED = re.compile(r"'([^']+)'")


def remarks_of(plan: Plan) -> tuple[Remark, ...]:
    """Return why a plan is none, or not within its bound.

    Parameters
    ----------
    plan : Plan
        As a search ended with it.
    """
    if plan.trajectories:
        return tuple(_spender(plan, row) for row in _worst(plan))
    scenario = plan.scenario
    said = _explained(scenario, for_page(plan.explanation or plan.status_sentence))
    told = " ".join(remark["text"] for remark in said)
    concerns = concern_remarks(outlook_of(scenario), encode_scenario(scenario))
    return (*said, *(one for one in concerns if one["text"] not in told))


def _worst(plan: Plan) -> list[LedgerRow]:
    """Return what takes most of the risk."""
    return sorted(plan.risk.ledger, key=lambda row: -row.risk)[:_WORST]


def _spender(plan: Plan, row: LedgerRow) -> Remark:
    """Return a line of the ledger as a remark."""
    names = [vehicle.name for vehicle in plan.scenario.vehicles]
    vehicle = plan.scenario.vehicles[names.index(row.vehicle)]
    means = plan.trajectory(row.vehicle).means[:, list(vehicle.system.position)]
    place = means[min(row.step, len(means) - 1)]
    other = row.other or ("the workspace border" if row.cause == "workspace" else "all that is far")
    certified, bound = bound_texts(plan.risk.certified or 0.0, plan.risk.bound)
    text = (
        f"{row.vehicle} and {other} at step {row.step}: a risk of {row.risk:.2g} of "
        f"{certified}, the bound is {bound}"
    )
    if DEFAULT not in names_of_choices(plan.planner):
        text += f"; this planner does not keep to it, {DEFAULT} does"
    is_pair = row.cause == "pair" and row.other is not None
    return {
        "severity": "warning",
        "text": text,
        "path": ["vehicles", names.index(row.vehicle)],
        "vehicles": [row.vehicle, row.other] if is_pair and row.other else [row.vehicle],
        "at": [round(float(x), 4) for x in place],
        "cures": [],
    }


def _explained(scenario: Scenario, explanation: str) -> list[Remark]:
    """Return an explanation sentence by sentence: each at the first thing that it names."""
    remarks: list[Remark] = []
    for sentence in _SENTENCE.split(explanation.strip()):
        if not sentence:
            continue
        path, names, at = _subject(scenario, sentence)
        cures = _cures(scenario, sentence)
        if remarks and not names and not at:
            # It goes on about what the sentence before is about.
            last = remarks[-1]
            last["text"] = f"{last['text']} {sentence}"
            last["cures"] = [*last["cures"], *cures]
            continue
        remarks.append(
            {
                "severity": "fatal",
                "text": sentence,
                "path": path,
                "vehicles": names,
                "at": at,
                "cures": cures,
            }
        )
    return remarks


def _subject(
    scenario: Scenario, sentence: str
) -> tuple[list[str | int], list[str], list[float] | None]:
    """Return what a sentence is about: path, vehicles, place."""
    numbers = {vehicle.name: i for i, vehicle in enumerate(scenario.vehicles)}
    quoted = _QUOTED.findall(sentence)
    names = [name for name in dict.fromkeys(quoted) if name in numbers]
    obstacles = {obstacle.name: i for i, obstacle in enumerate(scenario.obstacles)}
    met = [obstacles[name] for name in quoted if name in obstacles]
    if met:
        corners = scenario.obstacles[met[0]].steps[0][0].vertices
        at = [round(float(x), 4) for x in corners.mean(axis=0)]
        path: list[str | int] = ["obstacles", met[0]]
        return (["vehicles", numbers[names[0]]] if names else path), names, at
    if not names:
        return [], [], None
    vehicle = scenario.vehicles[numbers[names[0]]]
    is_at_goal = "goal" in sentence and "start" not in sentence
    place = vehicle.goal.center if is_at_goal else vehicle.start_position
    return ["vehicles", numbers[names[0]]], names, [round(float(x), 4) for x in place]


def _cures(scenario: Scenario, sentence: str) -> list[Cure]:
    """Return what a sentence says was tried and helps."""
    cures = [horizon_cure(scenario, int(steps)) for steps in _HORIZON.findall(sentence)]
    for bound in _BOUND.findall(sentence):
        if 0.0 < float(bound) < 0.5:
            cures.append(risk_bound_cure(float(bound)))
    return cures
