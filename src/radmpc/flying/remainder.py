"""The steps that are left of a mission as a scenario of their own."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from radmpc.arrays import Vector, frozen
from radmpc.errors import ScenarioError
from radmpc.model.obstacle import MovingShape, Obstacle, TrackShape
from radmpc.model.scenario import Scenario

__all__ = ["changed", "later", "left_of"]

Record = TypeVar("Record")


def left_of(
    scenario: Scenario, passed: int, states: Sequence[Vector], risk_bound: float
) -> Scenario:
    """Return the scenario of the steps that are left, from measured states.

    Parameters
    ----------
    scenario : Scenario
        Of all steps.
    passed : int
        Steps that have been flown, below its horizon.
    states : sequence of (n,) array
        Measured states, known without error.
    risk_bound : float
        What the rest may risk [-].

    Returns
    -------
    Scenario
        With the same goals, and moving obstacles where they are by then.

    Raises
    ------
    ScenarioError
        If vehicles have visits or windows of arrival: what a flight has done, states do not tell.
    """
    if scenario.has_windows:
        raise ScenarioError(
            "a mission with visits or windows of arrival is not planned anew under way",
            ("vehicles",),
        )
    vehicles = tuple(
        changed(v, start=state, initial_covariance=0.0 * v.initial_covariance)
        for v, state in zip(scenario.vehicles, states, strict=True)
    )
    return changed(
        scenario,
        horizon=scenario.horizon - passed,
        risk_bound=risk_bound,
        vehicles=vehicles,
        obstacles=tuple(later(o, passed) for o in scenario.obstacles),
    )


def changed(value: Record, **fields: object) -> Record:
    """Return a copy of a frozen value with other fields, unchecked.

    What is measured was checked, and checking all of a scenario takes longer than a linear program.

    Parameters
    ----------
    value : Record
        A scenario or a part of one.
    **fields
        What differs, of the right kind; arrays are frozen.
    """
    made = copy.copy(value)
    for name, entry in fields.items():
        if isinstance(entry, np.ndarray):
            frozen(entry)
        object.__setattr__(made, name, entry)
    return made


def later(obstacle: Obstacle, passed: int) -> Obstacle:
    """Return an obstacle as it is some steps later.

    Parameters
    ----------
    obstacle : Obstacle
        At rest, or with an outline per step.
    passed : int
        The steps.
    """
    if isinstance(obstacle.shape, TrackShape) and obstacle.dt is not None:
        track = obstacle.shape.later(passed, obstacle.dt)
        # The outlines stay those of the plan that is flown, to the last digit.
        left = len(obstacle.steps) - 1 - passed
        spread = None if obstacle.spread is None else obstacle.spread.since(passed, left)
        return replace(obstacle, shape=track, steps=obstacle.steps[passed:], spread=spread)
    if not isinstance(obstacle.shape, MovingShape):
        return obstacle
    shape = MovingShape(obstacle.shape.outlines[passed:])
    return replace(obstacle, shape=shape, steps=obstacle.steps[passed:])
