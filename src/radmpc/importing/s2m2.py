"""Problems of s2m2: YAML with ``agents``, ``starts``, ``goals``, ``limits`` and ``obstacles``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from scipy.optimize import linprog

from radmpc.arrays import Vector, as_matrix
from radmpc.errors import ScenarioError
from radmpc.geometry import Polytope, halfspaces
from radmpc.importing.problem import ForeignModel, ForeignProblem, ForeignVehicle
from radmpc.importing.rounding import rounded
from radmpc.io.native.checking import validated
from radmpc.io.native.numbers import Matrix, Number, Text
from radmpc.io.native.numbers import Vector as Numbers
from radmpc.io.text.document import Document
from radmpc.io.text.files import shown
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Workspace
from radmpc.ranges import check_range

__all__ = ["is_s2m2", "read_s2m2"]

_KEYS = ("agents", "starts", "goals", "limits")


class _Agent(ForeignModel):
    """An agent. Its tracking gains ``k`` are ignored with a warning."""

    type: Text
    size: Number
    velocity: Number


class _File(ForeignModel):
    """A whole problem; regions are rows of a normal and an offset."""

    name: Text | None = None
    agents: list[_Agent]
    starts: list[Numbers]
    goals: list[Matrix]
    limits: list[Numbers]
    obstacles: list[Matrix] | None = None


def is_s2m2(value: object) -> bool:
    """Whether a file's content looks like one of s2m2's problems."""
    return isinstance(value, Mapping) and all(key in value for key in _KEYS)


def read_s2m2(document: Document) -> ForeignProblem:
    """Return the problem in an s2m2 file.

    Regions ``[a…, b]``, meaning ``a · x <= b``, become obstacles and goals; limits the workspace;
    an agent's size its radius.

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
    for key, given in (("starts", file.starts), ("goals", file.goals)):
        if len(given) != len(file.agents):
            raise ScenarioError(
                f"must be as many as agents ({len(file.agents)}), got {len(given)}", (key,)
            )
    workspace = _workspace(file.limits)
    d = workspace.lower.size
    types = ", ".join(sorted({agent.type for agent in file.agents}))
    return ForeignProblem(
        name=Path(document.name).stem if file.name is None else file.name,
        format="s2m2",
        file=Path(document.name).name,
        vehicles=tuple(_vehicle(i, file, d) for i in range(len(file.agents))),
        obstacles=tuple(_obstacle(i, rows, d) for i, rows in enumerate(file.obstacles or [])),
        workspace=workspace,
        reasons=(
            ("radius", "the agents' size"),
            (
                "limits",
                "the agents' velocity as speed per axis; acceleration: full speed after half a "
                "radius from rest (none is published)",
            ),
            ("goals", _goal_reason(file.goals)),
        ),
        warnings=(f"flown as double integrators, their tracking gains ignored: {types}",),
    )


def _workspace(limits: list[Numbers]) -> Workspace:
    """Return the room from a lower and an upper limit per axis."""
    path = ("limits",)
    if len(limits) not in (2, 3):
        raise ScenarioError(f"must be of 2 or 3 axes, got {len(limits)}", path)
    for axis, pair in enumerate(limits):
        if len(pair) != 2:
            raise ScenarioError(f"must have 2 numbers, got {len(pair)}", (*path, axis))
        if not pair[0] < pair[1]:
            raise ScenarioError(f"must be a lower, then a higher number, got {pair}", (*path, axis))
    low, high = np.array(limits).T
    return Workspace(low, high)


def _region(rows: Matrix, dimension: int, path: tuple[str | int, ...]) -> tuple[Vector, Vector]:
    """Return normals (f, d) and offsets (f,) of a region."""
    table = as_matrix(rows, path=path) if rows else np.empty((0, 0))
    if table.shape[1] != dimension + 1:
        raise ScenarioError(
            f"must have rows of {dimension + 1} numbers, a normal and an offset, "
            f"got {table.shape[1]}",
            path,
        )
    return table[:, :-1], table[:, -1]


def _obstacle(index: int, rows: Matrix, dimension: int) -> Obstacle:
    """Return an obstacle."""
    path = ("obstacles", index)
    normals, offsets = _region(rows, dimension, path)
    try:
        return Obstacle.halfspaces(f"obstacle{index + 1}", normals, offsets)
    except ScenarioError as error:
        raise ScenarioError(error.message, path) from error


def _vehicle(index: int, file: _File, dimension: int) -> ForeignVehicle:
    """Return an agent."""
    agent, start = file.agents[index], file.starts[index]
    for key, value, unit in (("size", agent.size, "m"), ("velocity", agent.velocity, "m/s")):
        check_range(value, unit, ("agents", index, key))
    # v² / (2 a) is the way from rest to full speed.
    acceleration = agent.velocity**2 / agent.size
    try:
        check_range(acceleration, "m/s²", ("agents", index, "velocity"))
    except ScenarioError as error:
        raise ScenarioError(f"its square over the size {error.message}", error.path) from error
    if len(start) < dimension:
        raise ScenarioError(
            f"must have at least {dimension} numbers, got {len(start)}", ("starts", index)
        )
    path = ("goals", index)
    normals, offsets = _region(file.goals[index], dimension, path)
    try:
        low, high = _inner_box(halfspaces(normals, offsets))
    except ScenarioError as error:
        raise ScenarioError(error.message, path) from error
    return ForeignVehicle(
        name=f"agent{index + 1}",
        start=np.array(start[:dimension]),
        goal=0.5 * (low + high),
        start_velocity=np.zeros(dimension),
        goal_velocity=np.zeros(dimension),
        radius=agent.size,
        speed_limit=agent.velocity,
        control_limit=float(rounded(np.array(acceleration))),
        goal_half_width=0.5 * (high - low),
    )


def _is_box(region: Polytope) -> bool:
    """Whether a region is parallel to the axes."""
    return bool(np.all(np.count_nonzero(region.normals, axis=1) == 1))


def _inner_box(region: Polytope) -> tuple[Vector, Vector]:
    """Return the corners of a region that is a box, or of the largest cube in it."""
    if _is_box(region):
        return region.vertices.min(axis=0), region.vertices.max(axis=0)
    reach = np.abs(region.normals).sum(axis=1)
    d = region.dimension
    # Center and half width of a cube: its corner farthest out along each normal stays within.
    answer = linprog(
        np.append(np.zeros(d), -1.0),
        A_ub=np.column_stack([region.normals, reach]),
        b_ub=region.offsets,
        bounds=[(None, None)] * d + [(0.0, None)],
    )
    if answer.x is None:
        raise ScenarioError("must hold a box, found none in it")
    return answer.x[:-1] - answer.x[-1], answer.x[:-1] + answer.x[-1]


def _goal_reason(goals: list[Matrix]) -> str:
    """Return what becomes of goals that are regions."""
    text = "the published regions"
    if any(sum(value != 0.0 for value in row[:-1]) != 1 for rows in goals for row in rows):
        text += " (of those not parallel to the axes the largest cube within)"
    return text
