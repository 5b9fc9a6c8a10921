"""What the view in a notebook is told: the values that the page's server sends, too."""

from __future__ import annotations

from typing import TypedDict

from radmpc.errors import ArgumentTypeError
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.result import Result
from radmpc.serving.protocol import PlanView, ScenarioView
from radmpc.serving.views.plan import plan_summary, plan_view
from radmpc.serving.views.scenario import scenario_view

__all__ = ["ViewContent", "Viewable", "view_content"]

Viewable = Result | Plan | Scenario
"""What there is a view of."""


class ViewContent(TypedDict):
    """A scenario and, where there is one, its plan, as plain data."""

    scenario: ScenarioView
    plan: PlanView | None


def view_content(value: Viewable) -> ViewContent:
    """Return what the view shows of a value.

    Parameters
    ----------
    value : Result or Plan or Scenario
        A result without a plan shows its scenario, and why there is none.

    Returns
    -------
    ViewContent
        Plain data, places rounded to what a screen shows.

    Raises
    ------
    ArgumentTypeError
        If there is no view of values of this type.
    """
    if isinstance(value, Scenario):
        return {"scenario": scenario_view(value), "plan": None}
    if not isinstance(value, Result | Plan):
        raise ArgumentTypeError(
            f"value must be a Result, a Plan or a Scenario, got {type(value).__name__}"
        )
    plan = value.record if isinstance(value, Result) else value
    scenario = scenario_view(plan.scenario)
    return {
        "scenario": scenario,
        "plan": plan_view(plan, plan_summary(plan, "plan", 0), scenario),
    }
