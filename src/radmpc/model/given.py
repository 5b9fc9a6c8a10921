"""Checks of scenarios and plans that are passed to public functions."""

from __future__ import annotations

import os
from dataclasses import replace

from radmpc.arguments import check_kind, value_text
from radmpc.errors import ArgumentError
from radmpc.model.plan import Plan
from radmpc.model.scenario import Avoidance, Scenario

__all__ = ["check_plan", "check_scenario", "plan_under"]

# By name: what results and imports are is not known on this floor.
_SCENARIO_HINTS = {
    "ImportedScenario": "its scenario is .scenario",
    "Plan": "its question is .scenario",
    "Result": "its question is .record.scenario",
    "dict": "radmpc.from_dict makes one of plain data",
}
_PLAN_HINTS = {
    "Result": "its plan is .require(), or .record where there may be none",
    "Scenario": "radmpc.plan makes one",
    "dict": "radmpc.from_dict makes one of plain data",
}


def check_scenario(value: object, name: str = "scenario") -> None:
    """Refuse what is no scenario.

    Parameters
    ----------
    value : object
        The argument.
    name : str
        What it is called.

    Raises
    ------
    ArgumentTypeError
        If it is something else; it says what to do instead.
    """
    hint = "radmpc.load_scenario reads files" if _is_path(value) else ""
    hint = hint or _SCENARIO_HINTS.get(type(value).__name__, "")
    check_kind(value, Scenario, name, "a Scenario", hint)


def check_plan(value: object, name: str = "plan") -> None:
    """Refuse what is no plan, as `check_scenario` does.

    Parameters
    ----------
    value : object
        The argument.
    name : str
        Its name, for the message.

    Raises
    ------
    ArgumentTypeError
        If it is something else; it says what to do instead.
    """
    hint = "radmpc.load_plan reads files" if _is_path(value) else ""
    hint = hint or _PLAN_HINTS.get(type(value).__name__, "")
    check_kind(value, Plan, name, "a Plan", hint)


def plan_under(plan: Plan, avoidance: Avoidance | None) -> Plan:
    """Return a plan as judged where another avoidance counts than its scenario's.

    Parameters
    ----------
    plan : Plan
        Any.
    avoidance : {'intervals', 'steps'} or None
        Where collisions count; None is as in its scenario.

    Returns
    -------
    Plan
        The same trajectories. What the plan states of its risk it states of its own scenario, and
        so is left out where that is another.

    Raises
    ------
    ArgumentTypeError
        If the first is no plan.
    ArgumentError
        If there is no such avoidance.
    """
    check_plan(plan)
    if avoidance is None:
        return plan
    if not (isinstance(avoidance, str) and avoidance in {"intervals", "steps"}):
        raise ArgumentError(
            f"avoidance must be 'intervals', 'steps' or None, got {value_text(avoidance)}"
        )
    if avoidance == plan.scenario.avoidance:
        return plan
    scenario = replace(plan.scenario, avoidance=avoidance)
    return replace(plan, scenario=scenario, risk=replace(plan.risk, certified=None, ledger=()))


def _is_path(value: object) -> bool:
    """Whether a value names a file."""
    return isinstance(value, str | os.PathLike)
