"""The scenario's own model as something to fly in: what `simulate` draws, one mission at a time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from radmpc.arguments import check_rng
from radmpc.arrays import Matrix, Vector
from radmpc.errors import ArgumentError
from radmpc.flying.nature import Nature, root_of
from radmpc.flying.tick import Contact, Segment
from radmpc.model.given import check_scenario
from radmpc.model.relations.concerns import is_for
from radmpc.model.relations.keep import keep_pairs
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.nearby import near_pairs
from radmpc.referee.simulation.collisions import (
    leaves_workspace,
    loses_range,
    meets_origin,
    meets_solid,
)
from radmpc.referee.simulation.sweep import resting, swept

__all__ = ["Backend", "Model"]


class Backend(Protocol):
    """What a mission is flown with: a model, a simulator, vehicles."""

    def reset(self) -> tuple[Sequence[Vector], Sequence[Contact]]:
        """Begin; return the states at step 0 and what is hit there."""
        ...

    def advance(self, segments: Sequence[Segment]) -> tuple[Sequence[Vector], Sequence[Contact]]:
        """Fly one step; return the states after it and what was hit on the way."""
        ...


class Model:
    """The scenario's dynamics with Gaussian noise; collisions by the referee's exact geometry.

    States of vehicles with a `measurement` are returned as the estimates of their Kalman filters;
    contacts follow from where they are.

    Parameters
    ----------
    scenario : Scenario
        What is flown.
    rng : Generator or int or None
        Source of the noise, or its seed.

    Raises
    ------
    ArgumentTypeError
        If an argument is of another kind.
    ArgumentError
        If the seed is negative.
    """

    def __init__(self, scenario: Scenario, rng: np.random.Generator | int | None = None) -> None:
        check_scenario(scenario)
        check_rng(rng)
        self._scenario = scenario
        self._rng = np.random.default_rng(rng)
        vehicles = scenario.vehicles
        self._initial = _factors([v.initial_covariance for v in vehicles])
        self._disturbance = _factors([v.disturbance_covariance for v in vehicles])
        self._states: tuple[Vector, ...] = tuple(v.start for v in vehicles)
        self._nature, self._larger = Nature(scenario, self._rng), 1.0
        self._strays: tuple[dict[int, Vector], dict[int, Vector]] = {}, {}
        self._step = 0

    def reset(self) -> tuple[tuple[Vector, ...], tuple[Contact, ...]]:
        """Draw where vehicles begin.

        Returns
        -------
        states : tuple of (n,) array
            In the scenario's order; for vehicles with a measurement, the estimates.
        contacts : tuple of Contact
            What is hit there already.
        """
        self._step = 0
        starts = [v.start for v in self._scenario.vehicles]
        normal = self._drawn(self._initial, 1.0)
        self._larger = self._nature.begin()
        self._states = _sums(starts, [self._larger * each for each in normal])
        known = self._nature.estimated(self._states, None)
        self._strays = self._now_straying(), {}
        if self._scenario.avoidance == "intervals":
            return known, ()
        return known, self._contacts(self._states, self._states, None)

    def advance(
        self, segments: Sequence[Segment]
    ) -> tuple[tuple[Vector, ...], tuple[Contact, ...]]:
        """Fly one step.

        Parameters
        ----------
        segments : sequence of Segment
            What every vehicle does, in the scenario's order.

        Returns
        -------
        states : tuple of (n,) array
            After it; for vehicles with a measurement, the estimates.
        contacts : tuple of Contact
            What was hit on the way, or under ``steps`` at its end.

        Raises
        ------
        ArgumentError
            If they are not of the scenario's vehicles in its order.
        """
        vehicles = [vehicle.name for vehicle in self._scenario.vehicles]
        parts = segments if isinstance(segments, Sequence) else ()
        named = [getattr(segment, "name", None) for segment in parts]
        if named != vehicles:
            raise ArgumentError(f"segments must be of {vehicles} in this order, got {named}")
        controls = [segment.control for segment in segments]
        pairs = zip(self._scenario.vehicles, self._states, controls, strict=True)
        pushed = [_moved(v, x, u) for v, x, u in pairs]
        added = self._nature.disturbed(self._drawn(self._disturbance, self._larger))
        before, self._states = self._states, _sums(pushed, added)
        known = self._nature.estimated(self._states, controls)
        self._strays = self._now_straying(), self._strays[0]
        self._step += 1
        if self._scenario.avoidance == "intervals":
            return known, self._contacts(before, self._states, controls)
        return known, self._contacts(self._states, self._states, None)

    def _now_straying(self) -> dict[int, Vector]:
        """Return how far obstacles are from where they are expected."""
        found = {i: self._nature.stray(i) for i in range(len(self._scenario.obstacles))}
        return {i: place for i, place in found.items() if place is not None}

    def _drawn(self, factors: Sequence[Matrix], larger: float) -> list[Vector]:
        """Return noise of all vehicles, drawn in one go as `simulate` does."""
        normals = self._rng.standard_normal(sum(len(f) for f in factors))
        starts = np.cumsum([0, *(len(f) for f in factors)])
        pairs = zip(factors, starts, strict=False)
        return [larger * (f @ normals[a : a + len(f)]) for f, a in pairs]

    def _contacts(
        self,
        before: Sequence[Vector],
        after: Sequence[Vector],
        controls: Sequence[Vector] | None,
    ) -> tuple[Contact, ...]:
        """Return what is hit between two moments, on the path that is flown."""
        scenario = self._scenario
        vehicles = scenario.vehicles
        axes = [list(v.system.position) for v in vehicles]
        begin = np.array([x[a] for x, a in zip(before, axes, strict=True)])
        end = np.array([x[a] for x, a in zip(after, axes, strict=True)])
        sagittas = np.zeros_like(begin)
        if controls is not None:
            pairs = zip(vehicles, controls, strict=True)
            sagittas = np.array([v.system.sagitta @ u for v, u in pairs])
        radii = np.array([v.radius for v in vehicles])
        met = [
            Contact(self._step, "pair", vehicles[i].name, vehicles[j].name)
            for i, j in _met_pairs(begin, end, sagittas, radii)
        ]
        for number, obstacle in enumerate(scenario.obstacles):
            hits = self._obstacle_hits(number, (begin, end, sagittas), radii)
            met += [
                Contact(self._step, "obstacle", vehicles[i].name, obstacle.name)
                for i in np.flatnonzero(hits)
                if is_for(obstacle, vehicles[i].name)
            ]
        if scenario.workspace is not None:
            out = leaves_workspace(begin, end, sagittas, scenario.workspace)
            met += [Contact(self._step, "workspace", vehicles[i].name) for i in np.flatnonzero(out)]
        return (*met, *self._lost(begin, end, sagittas))

    def _lost(self, begin: Matrix, end: Matrix, sagittas: Matrix) -> tuple[Contact, ...]:
        """Return which vehicles lose a range that they keep, on paths between two moments."""
        if not self._scenario.keep:
            return ()
        names = [v.name for v in self._scenario.vehicles]
        pairs = keep_pairs(self._scenario.keep, names)
        one, two = [i for i, _, _ in pairs], [j for _, j, _ in pairs]
        reaches = np.array([within for _, _, within in pairs])
        apart = begin[one] - begin[two], end[one] - end[two], sagittas[one] - sagittas[two]
        lost = np.flatnonzero(loses_range(*apart, reaches))
        return tuple(Contact(self._step, "range", names[one[k]], names[two[k]]) for k in lost)

    def _obstacle_hits(
        self, number: int, path: tuple[Matrix, Matrix, Matrix], radii: Vector
    ) -> Vector:
        """Return which vehicles hit an obstacle, (N,) bool."""
        obstacle = self._scenario.obstacles[number]
        hits = np.zeros(len(radii), dtype=bool)
        sweeps = obstacle.is_moving and self._scenario.avoidance == "intervals"
        first = self._step - 1 if sweeps else self._step
        begin, end, sagittas = path
        now, then = self._strays
        if number in now:
            begin = begin - (then if sweeps else now)[number]
            end = end - now[number]
        for piece, shape in enumerate(obstacle.at(first)):
            parts = swept(shape, obstacle.at(first + 1)[piece]) if sweeps else resting(shape)
            hits |= meets_solid(begin, end, sagittas, radii, parts)
        return hits


def _met_pairs(
    begin: Matrix, end: Matrix, sagittas: Matrix, radii: Vector
) -> list[tuple[int, int]]:
    """Return the pairs that meet between two moments, in ascending order."""
    # No path is farther from its beginning than its chord and its sagitta are long.
    spans = radii + np.linalg.norm(end - begin, axis=1) + np.linalg.norm(sagittas, axis=1)
    pairs = near_pairs(begin, 2.0 * float(spans.max()))
    one, two = pairs[:, 0], pairs[:, 1]
    apart = begin[one] - begin[two], end[one] - end[two]
    hits = meets_origin(*apart, sagittas[one] - sagittas[two], radii[one] + radii[two])
    return [(i, j) for i, j in pairs[hits].tolist()]


def _factors(covariances: Sequence[Matrix]) -> list[Matrix]:
    """Return factors ``L Lᵀ`` of covariances that may be singular."""
    return [root_of(covariance) for covariance in covariances]


def _sums(first: Sequence[Vector], second: Sequence[Vector]) -> tuple[Vector, ...]:
    """Return sums vehicle by vehicle."""
    return tuple(a + b for a, b in zip(first, second, strict=True))


def _moved(vehicle: Vehicle, state: Vector, control: Vector) -> Vector:
    """Return the state after a step without noise."""
    moved = vehicle.system.A @ state + vehicle.system.B @ control
    return moved if vehicle.drift is None else moved + vehicle.drift
