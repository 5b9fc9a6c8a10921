"""Scenarios and plans given to public functions, and what to do with what is neither."""

from __future__ import annotations

import os

from radmpc.arguments import check_kind
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario

__all__ = ["check_plan", "check_scenario"]

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

    Raises
    ------
    ArgumentTypeError
        If it is something else; it says what to do instead.
    """
    hint = "radmpc.load_plan reads files" if _is_path(value) else ""
    hint = hint or _PLAN_HINTS.get(type(value).__name__, "")
    check_kind(value, Plan, name, "a Plan", hint)


def _is_path(value: object) -> bool:
    """Whether a value names a file."""
    return isinstance(value, str | os.PathLike)
