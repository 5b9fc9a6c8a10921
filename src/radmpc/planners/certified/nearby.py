"""The part of a scenario that some vehicles can ever meet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import field_names, unchecked
from radmpc.gaussian import Tail
from radmpc.model.relations.concerns import concerned
from radmpc.model.relations.subset import kept_and_met
from radmpc.model.scenario import Scenario
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass

__all__ = ["Surroundings"]

_FAR = 9.0
"""Standard deviations beyond which an obstacle is out of reach (1e-19)."""


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """A scenario, and which vehicles can ever meet which of its obstacles.

    Attributes
    ----------
    scenario : Scenario
        N vehicles and O obstacles.
    near : (N, O) bool array
        Whether an obstacle may come into a vehicle's reach.
    """

    scenario: Scenario
    near: npt.NDArray[np.bool_]

    @classmethod
    def of(cls, scenario: Scenario, models: Sequence[CondensedModel]) -> Surroundings:
        """Look at boxes of all obstacles over the horizon, against vehicles' reach.

        Parameters
        ----------
        scenario : Scenario
            The fleet.
        models : sequence of CondensedModel
            Those of all its vehicles.
        """
        d = scenario.dimension
        lower = np.empty((len(scenario.obstacles), d))
        upper = np.empty((len(scenario.obstacles), d))
        far = Tail(scenario.covariance_samples).beyond(_FAR)
        for i, obstacle in enumerate(scenario.obstacles):
            steps = range(scenario.horizon + 1) if obstacle.is_moving else (0,)
            corners = np.concatenate([p.vertices for k in steps for p in obstacle.at(k)])
            more = 0.0
            if obstacle.spread is not None:
                # Deviations of two add up to less than their sum.
                more = far * max(obstacle.spread.deviation(k) for k in steps)
            lower[i], upper[i] = corners.min(axis=0) - more, corners.max(axis=0) + more
        near = np.zeros((len(models), len(scenario.obstacles)), dtype=bool)
        for j, model in enumerate(models):
            spread = np.linalg.eigvalsh(model.position_covariances)[:, -1].max()
            if model.bent_covariances is not None:
                spread = max(spread, np.linalg.eigvalsh(model.bent_covariances)[:, -1].max())
            margin = model.vehicle.radius + far * np.sqrt(max(float(spread), 0.0))
            # A straight path between two steps stays within the reach of both.
            low = model.reach_lower.min(axis=0) - margin
            high = model.reach_upper.max(axis=0) + margin
            # The curve between two steps leaves its chord by the sagitta.
            largest = np.abs(model.control_bounds).max(axis=0, initial=0.0)
            sagitta = np.abs(model.vehicle.system.sagitta) @ largest
            near[j] = np.all((lower <= high + sagitta) & (upper >= low - sagitta), axis=1)
        mine = concerned(scenario.obstacles, [model.vehicle.name for model in models])
        return cls(scenario, near if mine is None else near & mine)

    def scenario_of(self, members: tuple[int, ...]) -> Scenario:
        """Return the scenario of some vehicles and the obstacles they may meet."""
        return self.among(members).scenario

    def among(self, members: tuple[int, ...]) -> Surroundings:
        """Return the surroundings of some vehicles."""
        whole, near = self.scenario, self.near[list(members)]
        met = np.flatnonzero(near.any(axis=0))
        vehicles = tuple(whole.vehicles[i] for i in members)
        keep, some = kept_and_met(vehicles, whole.keep, (whole.obstacles[i] for i in met.tolist()))
        changed: dict[str, object] = {"vehicles": vehicles, "keep": keep, "obstacles": some}
        # What fits the whole fits its parts.
        values = (changed.get(name, getattr(whole, name)) for name in field_names(Scenario))
        part: Scenario = unchecked(Scenario, *values)
        return Surroundings(part, near[:, met])
