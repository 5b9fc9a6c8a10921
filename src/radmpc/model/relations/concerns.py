"""Which vehicles obstacles concern: shallows do not concern boats of little draught."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_parts, field_text
from radmpc.errors import ScenarioError
from radmpc.model.obstacle import Obstacle
from radmpc.model.obstacle_shapes import Concerns

__all__ = [
    "all_but",
    "among",
    "check_concerns",
    "concerned",
    "is_for",
    "met_by",
    "only_for",
]


def only_for(obstacle: Obstacle, vehicles: Iterable[str]) -> Obstacle:
    """Return an obstacle that concerns some vehicles only; all others pass through it.

    Parameters
    ----------
    obstacle : Obstacle
        For everybody.
    vehicles : iterable of str
        Names, at least one.

    Returns
    -------
    Obstacle
        The same in everything else.

    Raises
    ------
    ScenarioError
        If these are no names.
    """
    return replace(obstacle, concerns=Concerns(_names(vehicles, "for")))


def all_but(obstacle: Obstacle, vehicles: Iterable[str]) -> Obstacle:
    """Return an obstacle that concerns all vehicles but some, which pass through it.

    Parameters
    ----------
    obstacle : Obstacle
        For everybody.
    vehicles : iterable of str
        Names, at least one.

    Returns
    -------
    Obstacle
        The same in everything else.

    Raises
    ------
    ScenarioError
        If these are no names.
    """
    return replace(obstacle, concerns=Concerns(_names(vehicles, "except"), are_exempt=True))


def _names(given: Iterable[str], key: str) -> tuple[str, ...]:
    """Return names, checked."""
    names = field_parts(given, "a sequence of names", (key,))
    for k, name in enumerate(names):
        field_text(name, (key, k))
    if not names or len(set(names)) < len(names):
        raise ScenarioError(f"must name vehicles, each once, got {list(names)}", (key,))
    return tuple(str(name) for name in names)


def is_for(obstacle: Obstacle, vehicle: str) -> bool:
    """Return whether a vehicle has to stay out of an obstacle.

    Parameters
    ----------
    obstacle : Obstacle
        The obstacle.
    vehicle : str
        The vehicle's name.
    """
    concerns = obstacle.concerns
    return concerns is None or (vehicle in concerns.names) != concerns.are_exempt


def concerned(
    obstacles: Sequence[Obstacle], vehicles: Sequence[str]
) -> npt.NDArray[np.bool_] | None:
    """Return which obstacles concern which vehicles, (N, O) bool; None if all concern all.

    Parameters
    ----------
    obstacles : sequence of Obstacle
        O of them.
    vehicles : sequence of str
        Names of N vehicles.
    """
    if all(obstacle.concerns is None for obstacle in obstacles):
        return None
    return np.array([[is_for(obstacle, name) for obstacle in obstacles] for name in vehicles])


def check_concerns(obstacles: Sequence[Obstacle], vehicles: Sequence[str]) -> None:
    """Check that obstacles name vehicles that there are.

    Parameters
    ----------
    obstacles : sequence of Obstacle
        Of a scenario.
    vehicles : sequence of str
        Names of its vehicles.

    Raises
    ------
    ScenarioError
        With the first that does not.
    """
    known = set(vehicles)
    for i, obstacle in enumerate(obstacles):
        concerns = obstacle.concerns
        if concerns is None:
            continue
        for k, name in enumerate(concerns.names):
            if name not in known:
                key = "except" if concerns.are_exempt else "for"
                raise ScenarioError(
                    f"must name vehicles of the scenario, got {name!r}", ("obstacles", i, key, k)
                )


def among(obstacle: Obstacle, vehicles: Collection[str]) -> Obstacle:
    """Return an obstacle that names no other vehicles than these.

    Parameters
    ----------
    obstacle : Obstacle
        As it is for a whole fleet.
    vehicles : collection of str
        Names of a part of it.
    """
    concerns = obstacle.concerns
    if concerns is None:
        return obstacle
    names = tuple(name for name in concerns.names if name in vehicles)
    return replace(obstacle, concerns=replace(concerns, names=names))


def met_by(obstacles: Iterable[Obstacle], vehicle: str) -> tuple[Obstacle, ...]:
    """Return the obstacles that concern a vehicle.

    Parameters
    ----------
    obstacles : iterable of Obstacle
        Of a scenario.
    vehicle : str
        Its name.
    """
    return tuple(o for o in obstacles if o.concerns is None or is_for(o, vehicle))
