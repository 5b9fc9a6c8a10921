"""Updates what is known of vehicles by what is measured."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.flying.knowing import kept_learning, remembers
from radmpc.model.noise.filtering import Learning, learning_of
from radmpc.model.noise.fleet import FleetLearning, fleet_learning
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass

__all__ = ["Observer"]


@dataclass(frozen=True, slots=True, eq=False)
class Observer:
    """Turns measured states, or estimates, into what is known of vehicles.

    Attributes
    ----------
    began : int
        The mission's step at which its scenario begins.
    scenario : Scenario
        Of the steps from there on.
    learning : tuple of Learning or None
        Of each vehicle's own filter, where it has one, and of what lasts of others of which no
        others tell; None of all others.
    fleet : FleetLearning or None
        Of the vehicles that tell of each other; None where none do.
    """

    began: int
    scenario: Scenario
    learning: tuple[Learning | None, ...]
    fleet: FleetLearning | None = None

    @classmethod
    def of(cls, scenario: Scenario, began: int = 0) -> Observer:
        """Return the observer of a mission.

        Parameters
        ----------
        scenario : Scenario
            Of the steps from one on.
        began : int
            The mission's step at which it begins.
        """
        fleet = fleet_learning(scenario.vehicles, scenario.horizon)
        tied = () if fleet is None else fleet.members
        own = (
            learning_of(v.system, v.noise, scenario.horizon)
            if remembers(v) and (i not in tied or v.measurement is not None)
            else None
            for i, v in enumerate(scenario.vehicles)
        )
        return cls(began, scenario, tuple(own), fleet)

    def observed(
        self,
        step: int,
        expected: Sequence[Vector],
        states: Sequence[Vector],
        acting: tuple[int, Scenario] | None = None,
    ) -> tuple[Vector, ...]:
        """Return what is known after a measurement.

        Parameters
        ----------
        step : int
            Of the mission.
        expected : sequence of (n,), (2 n + s,) or (3 (2 n + s),) array
            What was expected to be known.
        states : sequence of (n,) array
            Measured states, or estimates.
        acting : tuple of int and Scenario, or None
            The mission's step at which the leg in the air began, and its scenario; None is the
            first one.
        """
        began, scenario = (self.began, self.scenario) if acting is None else acting
        changes = self._changes(step, expected, states)
        made = []
        for i, (learning, hoped, state) in enumerate(
            zip(self.learning, expected, states, strict=True)
        ):
            n = state.size
            if i in changes and learning is None:
                rest = hoped[n:]
                made.append(np.concatenate([state, rest + changes[i][n : n + rest.size]]))
            elif learning is None:
                made.append(state)
            elif i not in changes:
                carried = learning.carried(step - self.began, state - hoped[:n])
                made.append(np.concatenate([state, hoped[n:] + carried]))
            else:
                vehicle = scenario.vehicles[i]
                own, acted, best = np.split(hoped, 3)
                moved = state - own[:n]
                carried = learning.carried(step - self.began, moved)
                surprise = learning.surprise(step - self.began, moved)
                if vehicle.measurement is not None:
                    surprise = surprise + vehicle.measurement.matrix @ (own[:n] - acted[:n])
                gain = kept_learning(vehicle, scenario.horizon).gains[step - began]
                parts = state, own[n:] + carried, acted + gain @ surprise, best + changes[i]
                made.append(np.concatenate(parts))
        return tuple(made)

    def _changes(
        self, step: int, expected: Sequence[Vector], states: Sequence[Vector]
    ) -> dict[int, Vector]:
        """Return by how much the fleet's measurements change what is known of each vehicle."""
        if self.fleet is None:
            return {}
        moved = self._moved(step, expected, states)
        learned = self.fleet.learned(step - self.began, moved)
        return dict(zip(self.fleet.members, learned, strict=True))

    def _moved(
        self, step: int, expected: Sequence[Vector], states: Sequence[Vector]
    ) -> list[Vector]:
        """Return by how much what is measured of each in the fleet differs from the expected."""
        found = []
        for i in () if self.fleet is None else self.fleet.members:
            n, vehicle, learning = states[i].size, self.scenario.vehicles[i], self.learning[i]
            moved = states[i] - expected[i][:n]
            if learning is not None and vehicle.measurement is not None:
                own, _, best = np.split(expected[i], 3)
                seen = vehicle.measurement.matrix @ (own[:n] - best[:n])
                moved = moved + learning.gains[step - self.began][:n] @ seen
            found.append(moved)
        return found

    def corrections(self, step: int) -> tuple[Matrix | None, ...]:
        """Return by how much estimates move at a step, (n, n) each; None where states are exact.

        Parameters
        ----------
        step : int
            Of the mission.
        """
        at = step - self.began
        found = [None if one is None else one.corrections[at] for one in self.learning]
        if self.fleet is not None:
            for i, each in zip(self.fleet.members, self.fleet.known_parts_of(at), strict=True):
                found[i] = each if found[i] is None else found[i]
        return tuple(found)

    def joint_innovation(
        self, step: int, expected: Sequence[Vector], states: Sequence[Vector]
    ) -> tuple[Matrix, Vector] | None:
        """Return the joint innovation of vehicles that inform each other, and its covariance.

        Parameters
        ----------
        step, expected, states
            As in `known`.

        Returns
        -------
        (p, p) and (p,) array, or None
            About what was expected; None of none.
        """
        if self.fleet is None:
            return None
        moved = np.concatenate(self._moved(step, expected, states))
        return self.fleet.innovations[step - self.began], moved
