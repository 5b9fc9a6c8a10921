"""Grid worlds; first those of libMultiRobotPlanning: YAML with ``map`` and ``agents``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.importing.grid.cells import Cells, cell_obstacles
from radmpc.importing.problem import ForeignModel, ForeignProblem, ForeignVehicle
from radmpc.io.native.checking import validated
from radmpc.io.native.numbers import Text
from radmpc.io.text.document import Document
from radmpc.io.text.files import shown
from radmpc.model.scenario import Workspace
from radmpc.wording import count_text

__all__ = [
    "MOST_CELLS",
    "Task",
    "free_cell",
    "grid_problem",
    "is_multi_robot_grid",
    "read_multi_robot_grid",
]

MOST_CELLS = 4_000_000
"""Cells that a grid may have."""

_RADIUS = 0.25
"""Hull radius in a grid of cells of 1 m [m]: half a cell wide, it leaves a quarter of a meter on
either side between two blocked cells."""

_SPEED_LIMIT = 1.0
"""Largest mean speed per axis [m/s]: a cell per second."""

_CONTROL_LIMIT = 2.0
"""Largest acceleration per axis [m/s²]."""

Task = tuple[str, tuple[int, int], tuple[int, int]]
"""A vehicle's name, its first cell and its last one, each by column and row."""


class _Agent(ForeignModel):
    """An agent between two cells."""

    name: Text
    start: list[int]
    goal: list[int]


class _Map(ForeignModel):
    """Columns and rows, and the cells that are blocked."""

    dimensions: list[int]
    obstacles: list[list[int]] | None = None


class _File(ForeignModel):
    """A whole problem."""

    agents: list[_Agent]
    map: _Map


def is_multi_robot_grid(value: object) -> bool:
    """Whether a file's content looks like a grid world of libMultiRobotPlanning."""
    if not isinstance(value, Mapping) or "agents" not in value:
        return False
    room = value.get("map")
    return isinstance(room, Mapping) and "dimensions" in room


def read_multi_robot_grid(document: Document) -> ForeignProblem:
    """Return the problem in a grid world of libMultiRobotPlanning.

    Raises
    ------
    ScenarioError
        If something in it is missing or not known here; its path says where.
    """
    if not isinstance(document.value, Mapping):
        raise ScenarioError(f"must be a mapping, got {shown(document.value)}")
    _check_goals(document.value)
    file = validated(_File, document.value)
    blocked = _blocked(file.map)
    if not file.agents:
        raise ScenarioError("needs at least one agent, got none", ("agents",))
    tasks, names = [], set()
    for i, agent in enumerate(file.agents):
        if agent.name in names:
            raise ScenarioError(
                f"must be unique, got {shown(agent.name)} twice", ("agents", i, "name")
            )
        names.add(agent.name)
        ends = [
            free_cell(cell, blocked, ("agents", i, key))
            for key, cell in (("start", agent.start), ("goal", agent.goal))
        ]
        tasks.append((agent.name, ends[0], ends[1]))
    return grid_problem(document, "libMultiRobotPlanning", blocked, tasks)


def grid_problem(
    document: Document,
    name: str,
    blocked: Cells,
    tasks: Sequence[Task],
    reasons: tuple[tuple[str, str], ...] = (),
    usual_agents: int | None = None,
) -> ForeignProblem:
    """Return the problem of a grid world.

    Parameters
    ----------
    document : Document
        Where it stands.
    name : str
        What its format is called.
    blocked : (width, height) array of bool
        By column and row.
    tasks : sequence of Task
        Between cells that are free.
    reasons : tuple of (str, str)
        More choices and why.
    usual_agents : int or None
        How many of the vehicles are taken, unless asked otherwise; None is all.
    """
    pieces = cell_obstacles(blocked)
    return ForeignProblem(
        name=Path(document.name).stem,
        format=name,
        file=Path(document.name).name,
        vehicles=tuple(_vehicle(*task) for task in tasks),
        obstacles=pieces,
        workspace=Workspace(np.zeros(2), np.array(blocked.shape, dtype=float)),
        bounds_hulls=True,
        usual_vehicles=usual_agents,
        reasons=(
            (
                "cells",
                "1 m wide, vehicles start and end in their middle and move freely between; "
                "y counts rows as the file does",
            ),
            *_describe_obstacles(int(blocked.sum()), len(pieces)),
            ("radius", f"{_RADIUS:g} m: half a cell wide"),
            (
                "limits",
                f"speed {_SPEED_LIMIT:g} m/s, a cell per second, and acceleration "
                f"{_CONTROL_LIMIT:g} m/s² per axis",
            ),
            *reasons,
        ),
    )


def _describe_obstacles(cells: int, pieces: int) -> tuple[tuple[str, str], ...]:
    """Return what blocked cells became, if any are."""
    if not cells:
        return ()
    told = f"{count_text(cells, 'blocked cell')} joined into {count_text(pieces, 'rectangle')}"
    return (("obstacles", told),)


def _check_goals(value: Mapping[str, object]) -> None:
    """Refuse agents with goals to choose from: each has its own, a scenario shares them."""
    agents = value.get("agents")
    for i, agent in enumerate(agents if isinstance(agents, list) else []):
        if isinstance(agent, Mapping) and "potentialGoals" in agent and "goal" not in agent:
            raise ScenarioError(
                "is not read: state a 'goal' for each agent, and in the imported scenario "
                "'assign: true' and the 'goals' that all of its vehicles choose from",
                ("agents", i, "potentialGoals"),
            )


def _blocked(room: _Map) -> Cells:
    """Return which cells are blocked, (width, height)."""
    path = ("map", "dimensions")
    if len(room.dimensions) != 2 or min(room.dimensions) < 1:
        raise ScenarioError(
            f"must be 2 whole numbers > 0, got {shown(list(room.dimensions))}", path
        )
    width, height = room.dimensions
    if width * height > MOST_CELLS:
        raise ScenarioError(
            f"must be at most {MOST_CELLS:,} cells, got {width:,} x {height:,}", path
        )
    blocked = np.zeros((width, height), dtype=bool)
    for i, cell in enumerate(room.obstacles or []):
        blocked[_cell(cell, blocked, ("map", "obstacles", i))] = True
    return blocked


def _cell(cell: Sequence[int], grid: Cells, path: tuple[str | int, ...]) -> tuple[int, int]:
    """Return a cell that lies in a grid."""
    width, height = grid.shape
    if len(cell) != 2:
        raise ScenarioError(f"must have 2 whole numbers, got {len(cell)}", path)
    x, y = cell
    if not (0 <= x < width and 0 <= y < height):
        raise ScenarioError(
            f"must be a cell from [0, 0] to [{width - 1}, {height - 1}], got {shown([x, y])}", path
        )
    return x, y


def free_cell(cell: Sequence[int], blocked: Cells, path: tuple[str | int, ...]) -> tuple[int, int]:
    """Return a cell that lies in a grid and is not blocked.

    Parameters
    ----------
    cell : sequence of int
        Column and row.
    blocked : (columns, rows) bool array
        The grid.
    path : tuple of str or int
        Where it stands in the file.
    """
    found = _cell(cell, blocked, path)
    if blocked[found]:
        raise ScenarioError(f"must be a free cell, got the blocked {list(found)}", path)
    return found


def _vehicle(name: str, start: tuple[int, int], goal: tuple[int, int]) -> ForeignVehicle:
    """Return a vehicle between the middles of two cells."""
    return ForeignVehicle(
        name=name,
        start=np.array(start) + 0.5,
        goal=np.array(goal) + 0.5,
        start_velocity=np.zeros(2),
        goal_velocity=np.zeros(2),
        radius=_RADIUS,
        speed_limit=_SPEED_LIMIT,
        control_limit=_CONTROL_LIMIT,
    )
