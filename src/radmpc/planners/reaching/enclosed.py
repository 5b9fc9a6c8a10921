"""Vehicles that have no way to a box, however long it takes: what stands around it or them.

Every plan keeps the mean hull clear of obstacles, since half of the noise goes either way and Δ is
less than a half; along intervals it does so all the time. So what closes a way for a hull of its
radius, in the plane and at all steps, rules out every plan.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.geometry import Polytope
from radmpc.geometry.openings import Barriers, Opening
from radmpc.model.obstacle import Obstacle
from radmpc.model.relations.concerns import met_by
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass
from radmpc.wording import place_text

__all__ = ["BarriersOfAll", "Closed", "at_all_steps", "closed_text"]

_TIGHT = 1e-6
"""Share of the radius by which an opening has to be too narrow, which no rounding is [-]."""

_SHUT = 1e-9
"""Width up to which there is no opening at all [m]."""

_NAMED = 4
"""Obstacles around a place that are named at most [-]."""


@dataclass(frozen=True, slots=True)
class Closed:
    """A way that is closed.

    Attributes
    ----------
    visit : int or None
        The visit that it leads to; None for the goal.
    radius : float
        That of the largest hull that fits through the widest opening [m]; 0 where there is none.
    beside : tuple of (str or None)
        What is beside that opening; None is the workspace's border.
    position : tuple of float
        Its middle [m].
    around : tuple of (str or None)
        All that closes the way.
    """

    visit: int | None
    radius: float
    beside: tuple[str | None, ...]
    position: tuple[float, ...]
    around: tuple[str | None, ...]

    @property
    def is_shut(self) -> bool:
        """Whether there is no opening for a hull of any size."""
        return 2.0 * self.radius <= _SHUT


class BarriersOfAll:
    """What stands still in a scenario, as barriers for hulls; vehicles alike share them.

    Parameters
    ----------
    scenario : Scenario
        The scenario.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._known: dict[tuple[float, tuple[str, ...]], Barriers | None] = {}

    def closed(self, vehicle: Vehicle) -> Closed | None:
        """Return the first way to a visit or the goal that is closed for a vehicle.

        Parameters
        ----------
        vehicle : Vehicle
            Of the scenario.

        Returns
        -------
        Closed or None
            None where there are ways, or nothing is known: in space, and at steps, between which
            vehicles pass through walls.
        """
        scenario, place = self._scenario, vehicle.start_position
        if scenario.dimension != 2 or scenario.avoidance != "intervals":
            return None
        met = met_by(scenario.obstacles, vehicle.name)
        named = [(o.name, piece) for o in met for piece in at_all_steps(o)]
        if not named:
            return None
        border = scenario.workspace
        if border is not None and not np.all((place >= border.lower) & (place <= border.upper)):
            return None
        barriers = self._barriers([o.name for o in met], [p for _, p in named], vehicle.radius)
        if barriers is None:
            return None
        boxes = [(j, v.lower, v.upper) for j, v in enumerate(vehicle.via)]
        for visit, lower, upper in (*boxes, (None, vehicle.goal.lower, vehicle.goal.upper)):
            low, high = lower, upper
            if border is not None:
                low, high = np.maximum(lower, border.lower), np.minimum(upper, border.upper)
            opening = barriers.opening(place, (low, high)) if np.all(low <= high) else None
            if opening is not None:
                return _closed(visit, opening, [name for name, _ in named])
        return None

    def _barriers(
        self, names: Sequence[str], pieces: Sequence[Polytope], radius: float
    ) -> Barriers | None:
        """Return the barriers for a hull among some obstacles."""
        key = (radius, tuple(names))
        if key not in self._known:
            border = self._scenario.workspace
            box = None if border is None else (border.lower, border.upper)
            most = max((1.0 - _TIGHT) * radius - _SHUT, 0.5 * _SHUT)
            self._known[key] = Barriers.of(pieces, box, most)
        return self._known[key]


def closed_text(vehicle: Vehicle, closed: Closed) -> str:
    """Say that a way is closed for a vehicle.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    closed : Closed
        What closes the way.

    Returns
    -------
    str
        What follows the vehicle's name, without a full stop.
    """
    target = "its goal" if closed.visit is None else f"the box of its visit via[{closed.visit}]"
    return f"has no way to {target}, however long it takes: {_what_closes(vehicle, closed)}"


def _what_closes(vehicle: Vehicle, closed: Closed) -> str:
    """Say what closes a way."""
    if closed.is_shut:
        from radmpc.planners.wording import listed  # noqa: PLC0415 - loads what checks do without

        named = [_named(name) for name in closed.around[:_NAMED]]
        if len(closed.around) > _NAMED:
            named.append(f"{len(closed.around) - _NAMED} more")
        leaves = "leave" if len(named) > 1 else "leaves"
        return f"{listed(named)} {leaves} no opening, for a hull of any size"
    near = f"near {place_text(closed.position)}"
    if None in closed.beside:
        other = next(name for name in closed.beside if name is not None)
        return (
            f"the widest opening, {near}, is {closed.radius:.4g} m from obstacle {other!r} to the "
            f"workspace border, up to which its center may go (radius {vehicle.radius:g} m)"
        )
    first, *others = (f"obstacle {name!r}" for name in dict.fromkeys(closed.beside))
    beside = f"between {first} and {others[0]}" if others else f"between sides of {first}"
    return (
        f"the widest opening, {beside} {near}, is {2.0 * closed.radius:.4g} m wide (its hull "
        f"{2.0 * vehicle.radius:g} m)"
    )


def _named(name: str | None) -> str:
    """Name what is beside a way."""
    return "the workspace border" if name is None else f"obstacle {name!r}"


def _closed(visit: int | None, opening: Opening, names: Sequence[str]) -> Closed:
    """Name what closes a way."""
    known: list[str | None] = [*names, None]
    around = dict.fromkeys(known[i] for i in opening.around)
    # The border last, as it is told.
    ordered = [name for name in around if name is not None]
    return Closed(
        visit=visit,
        radius=opening.radius if 2.0 * opening.radius > _SHUT else 0.0,
        beside=tuple(known[i] for i in opening.between),
        position=opening.position,
        around=(*ordered, *([None] if None in around else [])),
    )


def at_all_steps(obstacle: Obstacle) -> Sequence[Polytope]:
    """Return the pieces of an obstacle that are where they are at all steps, without doubt.

    Parameters
    ----------
    obstacle : Obstacle
        Any.
    """
    if obstacle.spread is not None:
        return ()
    first, *later = obstacle.steps
    if any(len(pieces) != len(first) for pieces in later):
        return ()
    return [
        piece
        for k, piece in enumerate(first)
        if all(np.array_equal(piece.vertices, pieces[k].vertices) for pieces in later)
    ]
