"""The latest path of every vehicle of a fleet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor
from radmpc.nearby import near_pairs_ever
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.program.visits.columns import windows_of

__all__ = ["Paths", "SavedPaths", "arched", "evenly", "timed", "timed_anyhow", "timed_by_visits"]

_TINY = 1e-9
"""Stands for a length of 0 where one divides by it [m]."""


SavedPaths = tuple[Sequence[Matrix], Tensor, Tensor]
"""Controls, mean positions and sagittas of all vehicles."""


class Paths:
    """Where every vehicle is on average, by its latest controls; changed in place.

    Parameters
    ----------
    hazards : Hazards
        The fleet.

    Attributes
    ----------
    controls : list of (T, m) array
        Nominal controls of each vehicle.
    means : (N, T+1, d) array
        Mean positions [m]; of a reference without controls, where one was set.
    sagittas : (N, T, d) array
        How far each path hangs off its chords at mid-step [m]; 0 where steps alone count.
    """

    def __init__(self, hazards: Hazards) -> None:
        self._hazards, self._models = hazards, hazards.models
        self.controls: list[Matrix] = [np.zeros(m.control_bounds.shape) for m in hazards.models]
        self._time = sum(
            model.time_cost * model.vehicle.goal.window(model.horizon)[1] / model.horizon
            for model in hazards.models
        )
        self.means: Tensor = np.array([model.drift_position for model in hazards.models])
        self.sagittas: Tensor = np.zeros((hazards.count, hazards.horizon, hazards.dimension))

    def fly(self, vehicle: int, controls: Matrix) -> None:
        """Give a vehicle new controls.

        Parameters
        ----------
        vehicle : int
            Its number.
        controls : (T, m) array
            Nominal controls.
        """
        model = self._models[vehicle]
        self.controls[vehicle] = controls
        self.means[vehicle] = model.path(controls)
        if self._hazards.intervals:
            self.sagittas[vehicle] = controls @ model.vehicle.system.sagitta.T

    def refer(self, vehicle: int, positions: Matrix) -> None:
        """Give a vehicle a path to turn half-spaces to, whether or not any controls follow it.

        Parameters
        ----------
        vehicle : int
            Its number.
        positions : (T+1, d) array
            Positions at the steps [m].
        """
        self.means[vehicle] = positions
        self.sagittas[vehicle] = 0.0

    def lead(self, paths: Paths, before: SavedPaths, vehicles: Sequence[int]) -> None:
        """Be where vehicles would be after a share of their last move again.

        Parameters
        ----------
        paths : Paths
            The latest.
        before : tuple
            Those before, as `state` returned them.
        vehicles : sequence of int
            Who moved.
        """
        i, share = list(vehicles), TUNING.ahead
        _, means, sagittas = before
        self.means[i] = paths.means[i] + share * (paths.means[i] - means[i])
        self.sagittas[i] = paths.sagittas[i] + share * (paths.sagittas[i] - sagittas[i])

    def mix(self, other: SavedPaths, share: float) -> None:
        """Give every vehicle controls between its own and others.

        Parameters
        ----------
        other : tuple
            The others, as `state` returned them.
        share : float
            Of the others, in [0, 1] [-].
        """
        for i, (mine, theirs) in enumerate(zip(tuple(self.controls), other[0], strict=True)):
            self.fly(i, mine + share * (theirs - mine))

    def near_pairs(self, clearance: float, reach: float) -> tuple[Indices, Indices]:
        """Return the vehicles that may be near each other in any window, lower number first.

        Parameters
        ----------
        clearance : float
            Standard deviations that are kept [-].
        reach : float
            Room beyond them up to which something counts as near [m].
        """
        hazards = self._hazards
        steps = np.linalg.norm(np.diff(self.means, axis=1), axis=2).max(initial=0.0)
        spread = np.sqrt(2.0 * hazards.variances.max(initial=0.0))
        distance = float(2.0 * hazards.radii.max() + clearance * spread + reach + steps)
        one, two = near_pairs_ever(self.means, np.full(self.means.shape[1], distance)).T
        return one, two

    def cost(self) -> float:
        """Return the effort of all controls, and what the time until arrival costs."""
        pairs = zip(self._models, self.controls, strict=True)
        return sum(
            (model.vehicle.cost_weight * float(np.abs(u).sum()) for model, u in pairs), self._time
        )

    def state(self) -> SavedPaths:
        """Return what `restore` takes to come back to these paths."""
        return tuple(self.controls), self.means.copy(), self.sagittas.copy()

    def restore(self, state: SavedPaths) -> None:
        """Come back to paths that `state` returned."""
        controls, means, sagittas = state
        self.controls = list(controls)
        self.means, self.sagittas = means.copy(), sagittas.copy()


def timed(route: Matrix, horizon: int, begin: float, end: float) -> Matrix:
    """Return where one is at each step on a route, at even speed between two times, (T+1, d) [m].

    Parameters
    ----------
    route : (p, d) array
        Its corners [m].
    horizon : int
        Steps T.
    begin, end : float
        When one leaves and arrives, as shares of the horizon [-].
    """
    lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(route, axis=0), axis=1)))
    shares = np.clip((np.linspace(0.0, 1.0, horizon + 1) - begin) / (end - begin), 0.0, 1.0)
    along = shares * lengths[-1]
    return np.stack([np.interp(along, lengths, route[:, a]) for a in range(route.shape[1])], axis=1)


def timed_by_visits(model: CondensedModel, route: Matrix) -> Matrix:
    """Return where a vehicle is at each step on a route, at even speed from visit to visit.

    Parameters
    ----------
    model : CondensedModel
        The vehicle; of a visit whose step is open the time follows from the route.
    route : (p, d) array
        Its corners, middles of all visits among them [m].

    Returns
    -------
    (T+1, d) array
        Positions [m].
    """
    horizon, goal = model.horizon, model.vehicle.goal
    lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(route, axis=0), axis=1)))
    steps, along, at = [0], [0.0], 0
    for visit, (first, last) in zip(model.vehicle.via, windows_of(model), strict=True):
        at += int((route[at:] == visit.center).all(axis=1).argmax())
        if first == last:
            steps.append(first)
            along.append(float(lengths[at]))
    first, last = goal.window(horizon)
    steps.append(first if first == last else horizon)
    along.append(float(lengths[-1]))
    there = np.interp(np.arange(horizon + 1), steps, along)
    return np.stack([np.interp(there, lengths, route[:, a]) for a in range(route.shape[1])], axis=1)


def evenly(ticks: Matrix, horizon: int) -> Matrix:
    """Return where one is at each step if ticks are spread evenly, straight between, (T+1, d) [m].

    Parameters
    ----------
    ticks : (K+1, d) array
        Positions, tick by tick [m].
    horizon : int
        Steps T.
    """
    at = np.linspace(0.0, len(ticks) - 1.0, horizon + 1)
    every = np.arange(len(ticks))
    return np.stack([np.interp(at, every, ticks[:, a]) for a in range(ticks.shape[1])], axis=1)


def arched(hazards: Hazards, i: int, offset: float) -> Matrix:
    """Return places at even speed on an arc to the right of the straight route, (T+1, d) [m].

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    i : int
        A vehicle's number.
    offset : float
        How far the arc strays from the straight route [largest radii].
    """
    model = hazards.models[i]
    start = model.drift_position[0]
    goal = 0.5 * (model.vehicle.goal.lower + model.vehicle.goal.upper)
    share = np.linspace(0.0, 1.0, hazards.horizon + 1)[:, None]
    right = np.zeros(start.size)
    right[:2] = (goal - start)[1], (start - goal)[0]
    right *= offset * float(hazards.radii.max()) / max(float(np.linalg.norm(right)), _TINY)
    return np.asarray(start + share * (goal - start) + np.sin(np.pi * share) * right)


def timed_anyhow(hazards: Hazards, i: int, route: Matrix, rng: np.random.Generator) -> Matrix:
    """Return where one is at each step on a route, from one drawn time to another, (T+1, d) [m].

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    i : int
        A vehicle's number.
    route : (p, d) array
        Its corners [m].
    rng : Generator
        Draws the times.
    """
    length = float(np.linalg.norm(np.diff(route, axis=0), axis=1).sum())
    # What cannot but stay goes no way at all.
    reach = float(hazards.reaches[i]) * hazards.horizon
    least = min(length / reach, TUNING.fastest) if reach > 0.0 else TUNING.fastest
    taken = least + (1.0 - least) * rng.random()
    first = (1.0 - taken) * rng.random()
    return timed(route, hazards.horizon, first, first + taken)
