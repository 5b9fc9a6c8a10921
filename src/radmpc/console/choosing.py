"""The planner that a command line asks for."""

from __future__ import annotations

from dataclasses import replace

from radmpc.errors import ScenarioError
from radmpc.planners.planner import Planner
from radmpc.planners.presets import parse_planner

__all__ = ["planner_with"]


def planner_with(name: str, gap: float | None) -> Planner:
    """Return a preset, with another gap where ``--gap`` asks for one.

    Parameters
    ----------
    name : str
        The preset's name.
    gap : float or None
        Relative gap that ends the search [-]; None is the preset's own.

    Raises
    ------
    ScenarioError
        If there is no such preset, or the gap is none.
    """
    try:
        known = parse_planner(name)
    except ScenarioError as error:
        raise ScenarioError(f"--planner: {error}") from error
    if gap is None:
        return known
    try:
        return replace(known, gap=gap)
    except ScenarioError as error:
        raise ScenarioError(f"--{error}") from error
