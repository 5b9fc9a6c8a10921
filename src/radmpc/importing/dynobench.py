"""Problems of dynobench and db-CBS: YAML with ``environment`` and ``robots``."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import ScenarioError
from radmpc.importing.completion import ImportedScenario, overlay
from radmpc.importing.options import ImportOptions
from radmpc.importing.problem import (
    ForeignModel,
    ForeignProblem,
    ForeignShape,
    ForeignVehicle,
)
from radmpc.importing.rounding import rounded
from radmpc.io.native.checking import validated
from radmpc.io.native.numbers import Text
from radmpc.io.native.numbers import Vector as Numbers
from radmpc.io.native.schema import FileModel
from radmpc.io.text.document import Document, read_document
from radmpc.io.text.files import shown
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Workspace

__all__ = ["import_dynobench", "is_dynobench", "read_dynobench"]

_SPEED_LIMIT = 0.5
"""Largest mean speed per axis [m/s], of RobotDoubleIntegrator2D in db-CBS."""

_CONTROL_LIMIT = 2.0
"""Largest acceleration per axis [m/s²], of the same."""

_DOUBLE_INTEGRATOR = r"[Ii]ntegrator2_[23]d(_v\d+)?"
"""What dynobench itself calls them; its older models begin with a capital."""

_BOX = "their boxes of 0.5 x 0.25 m"
"""Hull of most unicycles and cars."""

_HULLS: tuple[tuple[str, float, str], ...] = (
    (
        rf"(single|double)_integrator(_[23]d)?(_\d+)?|integrator1_2d(_v\d+)?|{_DOUBLE_INTEGRATOR}",
        0.1,
        "",
    ),
    (r"unicycle_first_order(_\d+)?_sphere|unicycle1_sphere(_v\d+)?", 0.4, ""),
    # Half the diagonal, rounded up: it covers the box at any angle.
    (
        r"unicycle_(first|second)_order(_\d+)?|unicycle[12](_v\d+)?|car_first_order(_\d+)?"
        r"|car2(_v\d+)?",
        0.2796,
        _BOX,
    ),
    # A box of 0.3 x 0.25 m, its middle 0.5 m from the robot's at any angle: to its far corners
    # it is hypot(0.5 + 0.15, 0.125) m.
    (
        r"car_first_order_with_1_trailers(_\d+)?|car1(_v\d+)?",
        0.662,
        f"{_BOX} and the trailers behind them at any angle",
    ),
)
"""Types of dynobench's models by pattern, the radius of the disc that is or covers the hull [m],
and what it covers; nothing where the hull is that disc."""

_OTHER_RADIUS = 0.1
"""Radius of the discs that other hulls are flown as [m], that of the double integrators in their
place: problems are made for hulls that turn, and many have no plan for discs that cover these."""


class _Obstacle(FileModel):
    """A box. Unknown keys are refused: they may be a rotation."""

    type: Text
    center: Numbers
    size: Numbers


class _Environment(ForeignModel):
    """Bounds and boxes."""

    min: Numbers
    max: Numbers
    obstacles: list[_Obstacle] | None = None


class _Robot(ForeignModel):
    """A robot; its state starts with the position."""

    type: Text
    start: Numbers
    goal: Numbers


class _File(ForeignModel):
    """A whole problem."""

    environment: _Environment
    robots: list[_Robot]


def is_dynobench(value: object) -> bool:
    """Whether a file's content looks like one of dynobench's problems."""
    return isinstance(value, Mapping) and "environment" in value and "robots" in value


def import_dynobench(
    path: str | os.PathLike[str], options: ImportOptions | None = None
) -> ImportedScenario:
    """Return a scenario of a dynobench or db-CBS problem.

    Boxes become obstacles and the environment's bounds the workspace. A double integrator keeps
    its state; any other robot is flown as one from its position, with a warning.

    Parameters
    ----------
    path : path
        The problem.
    options : ImportOptions or None
        What is not to be chosen by the importer.

    Returns
    -------
    ImportedScenario
        With every choice and its reason.

    Raises
    ------
    FileFormatError
        With one line that names file, line and field.
    """
    document = read_document(path)
    try:
        return overlay(read_dynobench(document), options or ImportOptions())
    except ScenarioError as error:
        raise document.failure(error) from error


def read_dynobench(document: Document) -> ForeignProblem:
    """Return the problem in a dynobench file.

    Raises
    ------
    ScenarioError
        If something in it is missing or not known here; its path says where.
    """
    if not isinstance(document.value, Mapping):
        raise ScenarioError(f"must be a mapping, got {shown(document.value)}")
    _check_obstacles(document.value)
    file = validated(_File, document.value)
    if not file.robots:
        raise ScenarioError("needs at least one robot, got none", ("robots",))
    workspace = _workspace(file.environment)
    d = workspace.lower.size
    others = sorted({robot.type for robot in file.robots if not _is_integrator(robot)})
    warnings = (
        (f"flown as double integrators from their positions: {', '.join(others)}",)
        if others
        else ()
    )
    return ForeignProblem(
        name=Path(document.name).stem,
        format="dynobench",
        file=Path(document.name).name,
        vehicles=tuple(_vehicle(i, robot, d) for i, robot in enumerate(file.robots)),
        obstacles=tuple(_box(i, o) for i, o in enumerate(file.environment.obstacles or [])),
        workspace=workspace,
        reasons=(("radius", _radius_reason(file.robots)), ("limits", _limits_reason())),
        warnings=warnings,
    )


def _hull(robot: _Robot) -> tuple[float, ForeignShape | None]:
    """Return the radius of a robot's disc, and its hull if that is another."""
    for pattern, radius, parts in _HULLS:
        if re.fullmatch(pattern, robot.type):
            if not parts:
                return radius, None
            return _OTHER_RADIUS, ForeignShape(robot.type, parts, radius)
    return _OTHER_RADIUS, ForeignShape(robot.type, None, None)


def _radius_reason(robots: list[_Robot]) -> str:
    """Return the radii and where they are from."""
    hulls = [_hull(robot) for robot in robots]
    known = sorted({radius for radius, shape in hulls if not shape})
    parts = []
    if known:
        text = f"{' or '.join(f'{radius:g}' for radius in known)} m, from dynobench's models"
        if any(_is_integrator(robot) for robot in robots):
            # By dynobench's model a plan is judged; db-CBS's search keeps some distance more.
            text += (
                ", by which db-CBS checks its plans (double integrators it searches with 0.15 m)"
            )
        parts.append(text)
    if any(shape for _, shape in hulls):
        parts.append(f"{_OTHER_RADIUS:g} m, that of double integrators, in place of other hulls")
    return "; ".join(parts)


def _limits_reason() -> str:
    """Return the limits and where they are from."""
    return (
        f"speed {_SPEED_LIMIT:g} m/s and acceleration {_CONTROL_LIMIT:g} m/s² per axis, "
        "those of db-CBS's double integrator"
    )


def _is_integrator(robot: _Robot) -> bool:
    """Whether a robot is a double integrator already, by the name of db-CBS or of dynobench."""
    return robot.type.startswith("double_integrator") or bool(
        re.fullmatch(_DOUBLE_INTEGRATOR, robot.type)
    )


def _workspace(environment: _Environment) -> Workspace:
    """Return the bounds."""
    path = ("environment",)
    if len(environment.min) not in (2, 3):
        raise ScenarioError(
            f"must have 2 or 3 coordinates, got {len(environment.min)}", (*path, "min")
        )
    try:
        return Workspace(np.array(environment.min), np.array(environment.max))
    except ScenarioError as error:
        raise error.under(*path) from error


def _check_obstacles(value: Mapping[str, object]) -> None:
    """Refuse obstacles of other types, before their keys are: those are not a box's either."""
    environment = value.get("environment")
    obstacles = environment.get("obstacles") if isinstance(environment, Mapping) else None
    for i, spec in enumerate(obstacles if isinstance(obstacles, list) else []):
        kind = spec.get("type") if isinstance(spec, Mapping) else None
        if isinstance(kind, str) and kind != "box":
            # Leaving it out would make an unsafe scenario look safe.
            path = ("environment", "obstacles", i, "type")
            raise ScenarioError(f"must be 'box', got {shown(kind)}", path)


def _box(index: int, spec: _Obstacle) -> Obstacle:
    """Return an obstacle."""
    path = ("environment", "obstacles", index)
    if len(spec.size) != len(spec.center):
        raise ScenarioError(
            f"must have {len(spec.center)} numbers like center, got {len(spec.size)}",
            (*path, "size"),
        )
    center, half = np.array(spec.center), 0.5 * np.array(spec.size)
    if not np.all(half > 0.0):
        raise ScenarioError(f"must be > 0 m, got {spec.size}", (*path, "size"))
    try:
        return Obstacle.box(f"box{index}", rounded(center - half), rounded(center + half))
    except ScenarioError as error:
        raise error.under(*path) from error


def _vehicle(index: int, robot: _Robot, dimension: int) -> ForeignVehicle:
    """Return a robot as a double integrator."""
    length = 2 * dimension if _is_integrator(robot) else dimension
    states: list[Vector] = []
    for key, given in (("start", robot.start), ("goal", robot.goal)):
        if len(given) < length:
            raise ScenarioError(
                f"must have at least {length} numbers, got {len(given)}", ("robots", index, key)
            )
        states.append(np.array([*given[:length], *[0.0] * (2 * dimension - length)]))
    start, goal = states
    radius, shape = _hull(robot)
    return ForeignVehicle(
        name=f"robot{index}",
        start=start[:dimension],
        goal=goal[:dimension],
        start_velocity=start[dimension:],
        goal_velocity=goal[dimension:],
        radius=radius,
        speed_limit=_SPEED_LIMIT,
        control_limit=_CONTROL_LIMIT,
        shape=shape,
    )
