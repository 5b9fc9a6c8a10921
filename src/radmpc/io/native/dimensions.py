"""In the plane or in space: which goal is the odd one out in a scenario file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from radmpc.errors import ScenarioError
from radmpc.io.native.schema import GoalSpec, ScenarioSpec, VehicleSpec

__all__ = ["blaming_goal", "odd_goal", "usual_axes"]

_AXES = {2: 2, 3: 3, 4: 2, 6: 3}
"""Axes of a position or of a double integrator's state, by how many numbers it has [-]."""


def usual_axes(spec: ScenarioSpec) -> int | None:
    """Return how many axes more of a file's places have than not; None where as many do not.

    Parameters
    ----------
    spec : ScenarioSpec
        What the file gives.
    """
    found = Counter(axes for axes in _axes(spec) if axes in (2, 3))
    plane, space = found[2], found[3]
    return None if plane == space else 2 if plane > space else 3


def odd_goal(goal: GoalSpec | None, usual: int | None) -> ScenarioError | None:
    """Return that a goal has other axes than most of a file; None where it has not.

    Parameters
    ----------
    goal : GoalSpec or None
        Of a vehicle.
    usual : int or None
        As `usual_axes` returns it.

    Returns
    -------
    ScenarioError or None
        With a path within the vehicle.
    """
    count = _goal_axes(goal)
    if usual is None or count not in (2, 3) or count == usual:
        return None
    text = f"must be {usual}-D like most places of the scenario, got {count}-D"
    return ScenarioError(text, ("goal",))


def blaming_goal(error: ScenarioError, spec: ScenarioSpec) -> ScenarioError:
    """Return the error of a vehicle whose dynamics have other axes, at its goal if that says so.

    Of a named model the goal says how many axes there are; of matrices they do themselves.

    Parameters
    ----------
    error : ScenarioError
        Of the scenario.
    spec : ScenarioSpec
        What the file gives.

    Returns
    -------
    ScenarioError
        The same, or one of another path.
    """
    path = error.path
    if path[2:] != ("dynamics",) or not isinstance(path[1], int):
        return error
    vehicle = spec.vehicles[path[1]]
    is_own = "dynamics" in vehicle.model_fields_set
    is_named = (vehicle if is_own else spec.defaults).dynamics.model is not None
    if not (is_named and error.message.endswith("-D")):
        return error
    return ScenarioError(error.message, (*path[:2], "goal"))


def _axes(spec: ScenarioSpec) -> Iterator[int | None]:
    """Yield how many axes each place has."""
    if spec.workspace is not None:
        yield len(spec.workspace.min)
    for obstacle in spec.obstacles:
        corners = obstacle.vertices or obstacle.line
        yield len(corners[0]) if corners else len(obstacle.min or ())
    for vehicle in spec.vehicles:
        yield _start_axes(vehicle, spec.defaults)
        yield _goal_axes(vehicle.goal)


def _start_axes(vehicle: VehicleSpec, defaults: VehicleSpec) -> int | None:
    """Return how many axes a start has, None where dynamics of the file's own tell."""
    given = vehicle if "dynamics" in vehicle.model_fields_set else defaults
    return _AXES.get(len(vehicle.start)) if given.dynamics.A is None else None


def _goal_axes(goal: GoalSpec | None) -> int | None:
    """Return how many axes a goal has."""
    if goal is None:
        return None
    corner = goal.min if goal.center is None else goal.center
    return None if corner is None else len(corner)
