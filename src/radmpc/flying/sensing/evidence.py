"""Measurements of the factor up to which a mission's covariances are known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.flying.knowing import remembers
from radmpc.flying.leg import Leg
from radmpc.flying.remainder import left_of, surrounded
from radmpc.flying.visiting import still_due
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass, replace
from radmpc.referee.conditional.scales import Scale, squares_of

__all__ = ["Evidence"]


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """What the disturbances so far say about a scenario's covariances.

    Attributes
    ----------
    scenario : Scenario
        With covariances as stated.
    began : int
        The mission's step at which it begins.
    scale : Scale
        What is known of the factor by now.
    measured : int or None
        The last step, from the scenario's first on, at which states were measured; None is none.
    moved : tuple of (int, Scenario, Scale), or None
        The mission's step from which on goals and surroundings are those of another scenario, that
        scenario, and what was known of the factor by then; None is never.
    """

    scenario: Scenario
    began: int
    scale: Scale
    measured: int | None = None
    moved: tuple[int, Scenario, Scale] | None = None

    @classmethod
    def of(cls, scenario: Scenario, began: int = 0) -> Evidence:
        """Return what is known before anything is measured.

        Parameters
        ----------
        scenario : Scenario
            Of the steps from one on.
        began : int
            The mission's step at which it begins.
        """
        return cls(scenario, began, Scale(scenario.covariance_samples))

    def after(
        self,
        step: int,
        expected: Sequence[Vector],
        states: Sequence[Vector],
        corrections: Sequence[Matrix | None],
        together: tuple[Matrix, Vector] | None = None,
    ) -> Evidence:
        """Return what is known after a measurement.

        Parameters
        ----------
        step : int
            Of the mission.
        expected : sequence of (n,) or (2 n,) array
            What was expected to be known.
        states : sequence of (n,) array
            Measured states, or estimates.
        corrections : sequence of (n, n) array or None
            By how much estimates were to move; None where states are measured exactly.
        together : tuple of (p, p) and (p,) array, or None
            Deviation from what was expected of all vehicles that are estimated together, its
            covariance first; None of none.
        """
        if self.scale.samples is None:
            return self
        at, scale = step - self.began, self.scale
        deviations = [x - hoped[: x.size] for x, hoped in zip(states, expected, strict=True)]
        missed = at - (0 if self.measured is None else self.measured + 1)
        for members in self._together():
            chosen = [self.scenario.vehicles[i] for i in members]
            if missed and any(remembers(vehicle) for vehicle in chosen):
                continue  # what estimates then move by is no longer known
            if together is not None and chosen[0].shared:
                covariance, apart = together
            else:
                covariance = _covariance(
                    chosen, [corrections[i] for i in members], self.measured, at
                )
                apart = np.concatenate([deviations[i] for i in members])
            squares, components = squares_of(covariance, apart[None])
            scale = scale.learned(float(squares[0]), components)
        return replace(self, scale=scale, measured=at)

    def shaken(
        self, step: int, expected: Sequence[Vector], states: Sequence[Vector]
    ) -> tuple[Matrix, Vector] | None:
        """Return by how much one step moved all that share disturbances, its covariance first.

        Parameters
        ----------
        step, expected, states
            As in `after`; of vehicles known exactly at the step before.

        Returns
        -------
        (p, p) and (p,) array, or None
            About what was expected; None where none share.
        """
        at, [members, *_] = step - self.began, self._together()
        chosen = [self.scenario.vehicles[i] for i in members]
        if not chosen[0].shared:
            return None
        covariance = _covariance(chosen, [None] * len(chosen), at - 1 if at else None, at)
        apart = [states[i] - expected[i][: states[i].size] for i in members]
        return covariance, np.concatenate(apart)

    def left(self, leg: Leg, step: int, states: Sequence[Vector], risk_bound: float) -> Scenario:
        """Return the scenario of the steps that are left; see `left_of`.

        Parameters
        ----------
        leg : Leg
            In the air.
        step : int
            Of the mission.
        states : sequence of (n,) or (2 n,) array
            What is known.
        risk_bound : float
            What the rest may risk [-].
        """
        # From the first step on: the same digits, whatever legs were flown before.
        rest = left_of(self.scenario, step - self.began, states, risk_bound, self.scale)
        if self.moved is not None:
            began, scenario, scale = self.moved
            times = float(self.scale.factor / scale.factor)
            rest = surrounded(rest, scenario, step - began, times)
        return still_due(rest, leg, step)

    def elsewhere(self, scenario: Scenario, step: int) -> Evidence:
        """Return the same of vehicles in other surroundings.

        Parameters
        ----------
        scenario : Scenario
            Of the steps that are left, its covariances those that are known by now.
        step : int
            Of the mission, at which it begins.
        """
        return replace(self, moved=(step, scenario, self.scale))

    def _together(self) -> list[list[int]]:
        """Return the vehicles that share disturbances, and each of the others."""
        vehicles = self.scenario.vehicles
        sharing = [i for i, vehicle in enumerate(vehicles) if vehicle.shared]
        alone = [[i] for i, vehicle in enumerate(vehicles) if not vehicle.shared]
        return [sharing, *alone] if sharing else alone


def _covariance(
    vehicles: Sequence[Vehicle], corrections: Sequence[Matrix | None], last: int | None, at: int
) -> Matrix:
    """Return by how much the states of some vehicles were to differ from what was expected."""
    sizes = [vehicle.start.size for vehicle in vehicles]
    ends = np.cumsum([0, *sizes])
    own, onward, first = np.zeros((3, ends[-1], ends[-1]))
    for i, vehicle in enumerate(vehicles):
        block, by_filter = slice(ends[i], ends[i + 1]), corrections[i]
        onward[block, block] = vehicle.system.A
        first[block, block] = vehicle.initial_covariance
        own[block, block] = vehicle.disturbance_covariance if by_filter is None else by_filter
    if any(each is not None for each in corrections):
        return np.asarray(own)
    for part in {part.name: part for vehicle in vehicles for part in vehicle.shared}.values():
        acts = np.zeros((ends[-1], part.size))
        for i, vehicle in enumerate(vehicles):
            for mine in vehicle.shared:
                if mine.name == part.name:
                    acts[ends[i] : ends[i + 1]] = mine.matrix
        own += acts @ part.covariance @ acts.T
    # Nothing is steered by what was not measured.
    found = first if last is None else np.zeros_like(first)
    for _ in range(at - (0 if last is None else last)):
        found = onward @ found @ onward.T + own
    return np.asarray(found)
