"""Missions of the LSC planner: JSON with ``quadrotors``, ``world`` and ``agents``.

Those of swarm_simulator, by the same group, are read too: they state no world, an agent's ``name``
is its type, and it may have a radius of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from pydantic import Field

from radmpc.arrays import Vector
from radmpc.errors import ScenarioError
from radmpc.importing.problem import ForeignModel, ForeignProblem, ForeignVehicle
from radmpc.io.native.checking import validated
from radmpc.io.native.numbers import Number, Text
from radmpc.io.native.numbers import Vector as Numbers
from radmpc.io.text.document import Document
from radmpc.io.text.files import shown
from radmpc.model.scenario import Workspace
from radmpc.ranges import check_range

__all__ = ["is_lsc", "read_lsc"]

_DIMENSION = 3
"""Coordinates of the format's positions."""


_NO_WORLD = (
    "trees and walls are not read: the octomap (world/*.bt) that a mission is flown in is named "
    "where it is launched, not in its file"
)
"""Said of every mission: none states which octomap it is flown in."""


_NO_ROOM = (
    "the file states no world: its bounds, and the downwash, are named where it is launched; the "
    "workspace is unbounded"
)
"""Said of missions of swarm_simulator."""


class _Quadrotor(ForeignModel):
    """A type of agent. Downwash is ignored with a warning."""

    max_vel: Numbers
    max_acc: Numbers
    radius: Number
    downwash: Number = 1.0


class _World(ForeignModel):
    """The room: lower corner, then upper corner."""

    dimension: Numbers


class _Agent(ForeignModel):
    """An agent, at rest at both ends; its own radius replaces its type's."""

    type: Text | None = None
    name: Text | None = None
    radius: Number | None = None
    start: Numbers
    goal: Numbers


class _File(ForeignModel):
    """A whole mission."""

    quadrotors: dict[str, _Quadrotor]
    world: list[_World] | None = Field(default=None, min_length=1)
    agents: list[_Agent]
    obstacles: list[object] = Field(default_factory=list)


def is_lsc(value: object) -> bool:
    """Whether a file's content looks like a mission of the LSC planner."""
    return isinstance(value, Mapping) and "quadrotors" in value and "agents" in value


def read_lsc(document: Document) -> ForeignProblem:
    """Return the problem in an LSC mission.

    Agents become spheres with their type's radius and limits per axis; the world's box is the
    workspace.

    Raises
    ------
    ScenarioError
        If something in it is missing or not known here; its path says where.
    """
    if not isinstance(document.value, Mapping):
        raise ScenarioError(f"must be a mapping, got {shown(document.value)}")
    file = validated(_File, document.value)
    if not file.agents:
        raise ScenarioError("needs at least one agent, got none", ("agents",))
    if file.obstacles:
        # Leaving them out would make an unsafe scenario look safe.
        raise ScenarioError(
            f"must be empty: moving obstacles of LSC missions are not read, got "
            f"{len(file.obstacles)}",
            ("obstacles",),
        )
    if file.world is not None and len(file.world) != 1:
        raise ScenarioError(f"must hold one box, got {len(file.world)}", ("world",))
    return ForeignProblem(
        name=Path(document.name).stem,
        format="LSC",
        file=Path(document.name).name,
        vehicles=tuple(_vehicle(i, agent, file) for i, agent in enumerate(file.agents)),
        workspace=None if file.world is None else _workspace(file.world[0].dimension),
        reasons=(
            ("radius", _radius_reason(file.agents)),
            ("limits", "max_vel and max_acc of the mission's quadrotors, the least of the axes"),
        ),
        warnings=tuple(_warnings(file)),
    )


def _warnings(file: _File) -> list[str]:
    """Return where the problem differs from its mission."""
    warnings = [_NO_WORLD]
    if file.world is None:
        warnings.append(_NO_ROOM)
    used = sorted({_type(agent) for agent in file.agents} & file.quadrotors.keys())
    washed = [name for name in used if file.quadrotors[name].downwash != 1.0]
    if washed:
        warnings.append(
            "downwash is ignored, hulls are spheres: keep vehicles at different heights "
            f"apart otherwise ({', '.join(washed)})"
        )
    return warnings


def _type(agent: _Agent) -> str:
    """Return the name of an agent's type, nothing if it states none."""
    return agent.type or agent.name or ""


def _radius_reason(agents: list[_Agent]) -> str:
    """Return where the radii are from."""
    own = sum(agent.radius is not None for agent in agents)
    if own == len(agents):
        return "from the mission's agents"
    return "from the mission's agents and quadrotors" if own else "from the mission's quadrotors"


def _workspace(dimension: Numbers) -> Workspace:
    """Return the room."""
    path = ("world", 0, "dimension")
    if len(dimension) != 2 * _DIMENSION:
        raise ScenarioError(f"must have 6 numbers, got {len(dimension)}", path)
    try:
        return Workspace(np.array(dimension[:_DIMENSION]), np.array(dimension[_DIMENSION:]))
    except ScenarioError as error:
        raise error.under(*path) from error


def _vehicle(index: int, agent: _Agent, file: _File) -> ForeignVehicle:
    """Return an agent."""
    path: tuple[str | int, ...] = ("agents", index)
    name = _type(agent)
    if not name:
        raise ScenarioError("is required", (*path, "type"))
    if name not in file.quadrotors:
        raise ScenarioError(
            f"must be one of {', '.join(sorted(file.quadrotors))}, got {shown(name)}",
            (*path, "name" if agent.type is None else "type"),
        )
    kind = file.quadrotors[name]
    if agent.radius is not None:
        check_range(agent.radius, "m", (*path, "radius"))
    path = ("quadrotors", name)
    check_range(kind.radius, "m", (*path, "radius"))
    limits = (("max_vel", kind.max_vel, "m/s"), ("max_acc", kind.max_acc, "m/s²"))
    for key, given, unit in limits:
        if len(given) != _DIMENSION or min(given) <= 0.0:
            raise ScenarioError(f"must be 3 numbers > 0, got {list(given)}", (*path, key))
        check_range(min(given), unit, (*path, key))
    places: list[Vector] = []
    for key, given in (("start", agent.start), ("goal", agent.goal)):
        if len(given) != _DIMENSION:
            raise ScenarioError(f"must have 3 numbers, got {len(given)}", ("agents", index, key))
        places.append(np.array(given))
    return ForeignVehicle(
        name=f"agent{index + 1}",
        start=places[0],
        goal=places[1],
        start_velocity=np.zeros(_DIMENSION),
        goal_velocity=np.zeros(_DIMENSION),
        radius=kind.radius if agent.radius is None else agent.radius,
        speed_limit=min(kind.max_vel),
        control_limit=min(kind.max_acc),
    )
