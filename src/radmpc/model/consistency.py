"""Whether the parts of a scenario fit together."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.errors import ScenarioError
from radmpc.model.dynamics import LinearSystem
from radmpc.model.obstacle import Obstacle
from radmpc.model.vehicle import Vehicle
from radmpc.model.workspace import Workspace

__all__ = [
    "check_dimensions",
    "check_distinct",
    "check_growth",
    "check_moving",
    "check_printable",
    "check_step",
    "check_windows",
    "check_workspace",
    "growth",
]

_MOST_GROWTH = 1e12
"""Largest factor from a state to a later one: solvers refuse coefficients from 1e15 on."""


def check_step(vehicles: tuple[Vehicle, ...], dt: float) -> None:
    """Check that double integrators, whose path between steps counts, belong to this dt.

    Parameters
    ----------
    vehicles : tuple of Vehicle
        At least one.
    dt : float
        Step [s].

    Raises
    ------
    ScenarioError
        With the vehicle whose step is another one.
    """
    checked: set[int] = set()
    for i, vehicle in enumerate(vehicles):
        system = vehicle.system
        if id(system) in checked:
            continue
        checked.add(id(system))
        rates = system.rates
        if rates is not None and abs(rates[1] - dt) > 1e-9 * dt:
            raise ScenarioError(
                f"is a double integrator of step {rates[1]:g} s, must be that of dt = {dt:g} s",
                ("vehicles", i, "dynamics"),
            )


def check_dimensions(
    vehicles: tuple[Vehicle, ...], obstacles: tuple[Obstacle, ...], pair_faces: int | None
) -> None:
    """Check that all parts live in one plane or space.

    Parameters
    ----------
    vehicles : tuple of Vehicle
        At least one.
    obstacles : tuple of Obstacle
        All of the scenario.
    pair_faces : int or None
        Faces around the relative position of a pair; None is the default.

    Raises
    ------
    ScenarioError
        With the vehicle or obstacle that has another number of coordinates, or with the faces.
    """
    d = vehicles[0].system.dimension
    for i, vehicle in enumerate(vehicles):
        if vehicle.system.dimension != d:
            raise ScenarioError(
                f"must be {d}-D like vehicle {vehicles[0].name!r}, "
                f"got {vehicle.system.dimension}-D",
                ("vehicles", i, "dynamics"),
            )
    for i, obstacle in enumerate(obstacles):
        if any(p.dimension != d for pieces in obstacle.steps for p in pieces):
            raise ScenarioError(
                f"must be {d}-D like the vehicles, got {obstacle.dimension}-D",
                ("obstacles", i),
            )
    least = 3 if d == 2 else 6
    if pair_faces is not None and (pair_faces < least or (d == 3 and pair_faces % 2)):
        kind = "an even number of at least 6" if d == 3 else "at least 3"
        raise ScenarioError(f"must be {kind} in {d}-D, got {pair_faces}", ("pair_faces",))


def growth(system: LinearSystem, gain: Matrix | None, horizon: int) -> float:
    """Return the largest factor from a state or a constant control to a state within the horizon.

    Parameters
    ----------
    system : LinearSystem
        The dynamics.
    gain : (m, n) array or None
        Feedback K; None is open loop.
    horizon : int
        Number of steps T.

    Returns
    -------
    float
        Largest entry of the powers up to T of ``[[F, B], [0, 1]]`` with ``F = A + B K``; inf where
        they overflow.
    """
    n, m = system.num_states, system.num_controls
    step = np.eye(n + m)
    step[:n, n:] = system.B
    with np.errstate(all="ignore"):
        step[:n, :n] = system.A if gain is None else system.A + system.B @ gain
        powers = step[None]
        while len(powers) < horizon:
            powers = np.concatenate([powers, powers[-1] @ powers])
        largest = float(np.abs(powers[:horizon]).max())
    return largest if np.isfinite(largest) else float("inf")


def check_growth(vehicles: tuple[Vehicle, ...], horizon: int, dt: float) -> None:
    """Refuse dynamics whose numbers no solver takes any more.

    Parameters
    ----------
    vehicles : tuple of Vehicle
        At least one.
    horizon : int
        Number of steps T.
    dt : float
        Step [s].

    Raises
    ------
    ScenarioError
        With the vehicle whose states grow too large.
    """
    # Vehicles of a fleet mostly have the same numbers, if seldom the same arrays.
    is_bounded: dict[tuple[bytes, ...], bool] = {}
    for i, vehicle in enumerate(vehicles):
        system = vehicle.system
        numbers = system.A.tobytes(), system.B.tobytes()
        for gain, field in ((None, "dynamics"), (vehicle.gain, "feedback")):
            key = numbers if gain is None else (*numbers, gain.tobytes())
            if key not in is_bounded:
                is_bounded[key] = growth(vehicle.system, gain, horizon) <= _MOST_GROWTH
            if not is_bounded[key]:
                raise ScenarioError(
                    f"must not let a state grow more than {_MOST_GROWTH:g} times within "
                    f"{horizon} steps of {dt:g} s",
                    ("vehicles", i, field),
                )


def check_workspace(vehicles: tuple[Vehicle, ...], workspace: Workspace | None) -> None:
    """Check that every goal can be reached without leaving the workspace.

    Parameters
    ----------
    vehicles : tuple of Vehicle
        At least one.
    workspace : Workspace or None
        None is unbounded.

    Raises
    ------
    ScenarioError
        With the vehicle whose goal is outside, or with the workspace.
    """
    if workspace is None:
        return
    d = vehicles[0].system.dimension
    if workspace.lower.size != d:
        raise ScenarioError(
            f"must have {d} coordinates like the vehicles, got {workspace.lower.size}",
            ("workspace",),
        )
    low, high = workspace.lower, workspace.upper
    for i, vehicle in enumerate(vehicles):
        goal = vehicle.goal
        if np.any(goal.lower > high) or np.any(goal.upper < low):
            raise ScenarioError(
                f"must touch the workspace {low.tolist()} to {high.tolist()}, "
                f"got {goal.lower.tolist()} to {goal.upper.tolist()}",
                ("vehicles", i, "goal"),
            )


def check_moving(obstacles: tuple[Obstacle, ...], horizon: int) -> None:
    """Check that moving obstacles are given at every step.

    Parameters
    ----------
    obstacles : tuple of Obstacle
        All of the scenario.
    horizon : int
        Number of steps T.

    Raises
    ------
    ScenarioError
        With the obstacle.
    """
    for i, obstacle in enumerate(obstacles):
        if obstacle.is_moving and len(obstacle.steps) != horizon + 1:
            raise ScenarioError(
                f"must have {horizon + 1} outlines, one per step 0..{horizon}, "
                f"got {len(obstacle.steps)}",
                ("obstacles", i, "moving"),
            )


def check_printable(name: str, path: tuple[str | int, ...]) -> None:
    """Refuse a name that a terminal would take for commands.

    Parameters
    ----------
    name : str
        Of a scenario, a vehicle or an obstacle.
    path : tuple of str or int
        Where it stands.

    Raises
    ------
    ScenarioError
        If it holds control characters.
    """
    if any(unicodedata.category(letter) == "Cc" for letter in name):
        raise ScenarioError(f"must not hold control characters, got {name!r}", path)


def check_distinct(names: list[str], field: str) -> None:
    """Refuse names that are empty, blank, unprintable or stand twice.

    Parameters
    ----------
    names : list of str
        In the order of the scenario.
    field : str
        Where they stand: ``vehicles`` or ``obstacles``.

    Raises
    ------
    ScenarioError
        With the first of them.
    """
    seen: set[str] = set()
    for i, name in enumerate(names):
        if not name:
            raise ScenarioError("must not be empty", (field, i, "name"))
        check_printable(name, (field, i, "name"))
        if not name.strip():
            raise ScenarioError(f"must not be blank, got {name!r}", (field, i, "name"))
        if name in seen:
            raise ScenarioError(f"must be unique, got {name!r} twice", (field, i, "name"))
        seen.add(name)


def check_windows(vehicles: Sequence[Vehicle], horizon: int, workspace: Workspace | None) -> None:
    """Check that arrivals and visits fit within the horizon, visits also within the workspace.

    Parameters
    ----------
    vehicles : sequence of Vehicle
        Of a scenario.
    horizon : int
        Number of steps T.
    workspace : Workspace or None
        None is unbounded.

    Raises
    ------
    ScenarioError
        With the first that does not.
    """
    for i, vehicle in enumerate(vehicles):
        last = 0 if vehicle.goal.within is None else vehicle.goal.within[1]
        if last > horizon:
            raise ScenarioError(
                f"must end at the horizon of {horizon} steps at the latest, got {last}",
                ("vehicles", i, "goal", "within"),
            )
        if vehicle.via:
            from radmpc.model.visits import check_visits  # noqa: PLC0415 - few visit anything

            try:
                check_visits(vehicle.via, horizon, workspace)
            except ScenarioError as error:
                raise error.under("vehicles", i) from error
