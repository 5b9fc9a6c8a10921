"""The programs of all sets met so far, and points of theirs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.inter_set_risk import by_sets, pair_risks_across_sets
from radmpc.planners.certified.merging import Members, owners_of
from radmpc.planners.certified.nearby import Surroundings
from radmpc.planners.certified.problem import SetProblem
from radmpc.planners.least_effort import least_effort
from radmpc.program.build import SharedBlocks, controls_of
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits
from radmpc.system.memory import hand_back_freed

__all__ = ["SetPrograms"]


class SetPrograms:
    """The programs of all sets, each built when first asked for.

    The answers are the same however often, and in whatever order, sets are asked for: what was
    built is kept for a while, and built anew where it was given up.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    unit : float
        The risk that 1 stands for in programs [-], see `radmpc.planners.certified.fleet`.
    is_costless : bool
        Whether effort counts for nothing.
    hazards : Hazards
        The fleet, laid out.

    Attributes
    ----------
    models : sequence of CondensedModel
        Those of all vehicles.
    covariances : (N, T+1, d, d) array
        Their position covariances [m²].
    """

    def __init__(
        self, scenario: Scenario, unit: float, hazards: Hazards, *, is_costless: bool
    ) -> None:
        self.scenario = scenario
        self.unit = unit
        self.is_costless = is_costless
        self.hazards = hazards
        self.models = hazards.models
        self.covariances = hazards.covariances
        self.surroundings = Surroundings.of(scenario, self.models)
        self._shared = SharedBlocks()
        self._problems: dict[Members, SetProblem] = {}
        self._sets_of: dict[int, set[Members]] = {}
        self._alone: dict[Members, Surroundings] = {}
        self._least_costs: dict[int, float] = {}
        self._least_of_all: tuple[float, ...] = ()
        self._motions: dict[Members, tuple[Vector, Tensor, Tensor]] = {}

    def problem(self, members: Members) -> SetProblem:
        """Return a set's program, built when first asked for.

        Those of sets that it was merged of are given up: they are hardly asked for again.
        """
        if members not in self._problems:
            self._forget_parts(members)
            alone = self.alone(members)
            problem = SetProblem.of(alone, members, self.models, self.unit, self._shared)
            self._keep(problem.without_cost() if self.is_costless else problem)
        return self._problems[members]

    def _keep(self, problem: SetProblem) -> None:
        """Keep a set's program, known by each of its members."""
        self._problems[problem.members] = problem
        for i in problem.members if len(problem.members) > 1 else ():
            self._sets_of.setdefault(i, set()).add(problem.members)

    def forget(self) -> None:
        """Give up all programs, to be built anew: those of twenty robots may take 120 MB."""
        self._problems.clear()
        self._shared.clear()
        self._sets_of.clear()
        self._motions.clear()
        hand_back_freed()

    def _forget_parts(self, members: Members) -> None:
        """Give up the programs of several of some vehicles; what one does alone is asked for."""
        met = set().union(*(self._sets_of.get(i, ()) for i in members))
        for part in (m for m in met if set(m) < set(members)):
            del self._problems[part]
            for i in part:
                self._sets_of[i].discard(part)

    def build_alone(self, limits: Limits) -> bool:
        """Build every vehicle's own program, until a limit; return whether all are built.

        Parameters
        ----------
        limits : Limits
            When to stop.
        """
        for i in range(self.scenario.num_vehicles):
            if limits.reached:
                return False
            self.problem((i,))
        return True

    def least_cost(self, i: int) -> float:
        """Return what a vehicle costs at least in empty space; 0 where it cannot reach its goal."""
        if i not in self._least_costs:
            model = self.models[i]
            self._least_costs[i] = 0.0 if self.is_costless else least_effort(model).cost
        return self._least_costs[i]

    def least_costs(self) -> tuple[float, ...]:
        """Return `least_cost` of every vehicle."""
        if len(self._least_of_all) < self.scenario.num_vehicles:
            every = range(self.scenario.num_vehicles)
            self._least_of_all = tuple(self.least_cost(i) for i in every)
        return self._least_of_all

    def alone(self, members: Members) -> Scenario:
        """Return a set's scenario: its vehicles with the obstacles that these may hit."""
        return self.surroundings_of(members).scenario

    def surroundings_of(self, members: Members) -> Surroundings:
        """Return what a set may meet, and which of its vehicles."""
        if members not in self._alone:
            self._alone[members] = self.surroundings.among(members)
        return self._alone[members]

    def assembled(self, members: Members, parts: Mapping[int, Vector]) -> Vector:
        """Return the point of a set made of points of its vehicles.

        Parameters
        ----------
        members : tuple of int
            The set.
        parts : mapping of int to (n,) array
            A point of every vehicle, by its number.

        Returns
        -------
        (n,) array
            A point of the set's program.
        """
        program = self.problem(members).program
        z = np.empty(program.num_columns)
        for block, i in enumerate(members):
            z[program.blocks == block] = parts[i]
        return z

    def split(self, sets: Sequence[Members], points: Sequence[Vector]) -> dict[int, Vector]:
        """Return every vehicle's part of points of sets.

        Parameters
        ----------
        sets : sequence of tuple of int
            Sets that have no vehicle in common.
        points : sequence of (n,) array
            A point of each.

        Returns
        -------
        dict of int to (n,) array
            By the vehicles' numbers.
        """
        return {
            i: z[self.problem(members).program.blocks == block]
            for members, z in zip(sets, points, strict=True)
            for block, i in enumerate(members)
        }

    def inter_set_risks(
        self, sets: Sequence[Members], points: Sequence[Vector]
    ) -> dict[tuple[int, int], float]:
        """Estimate the risk between every two sets.

        Parameters
        ----------
        sets : sequence of tuple of int
            A partition of the fleet.
        points : sequence of (n,) array
            A point of each.

        Returns
        -------
        dict of (int, int) to float
            Risks [-] by the sets' numbers in the order given, lower first.
        """
        return by_sets(self.pair_risks(sets, points), owners_of(sets))

    def pair_risks(
        self, sets: Sequence[Members], points: Sequence[Vector]
    ) -> dict[tuple[int, int], float]:
        """Estimate the risk between every two vehicles of different sets.

        Parameters
        ----------
        sets : sequence of tuple of int
            A partition of the fleet.
        points : sequence of (n,) array
            A point of each.

        Returns
        -------
        dict of (int, int) to float
            Risks [-] by the vehicles' numbers, lower first.
        """
        means = np.empty((self.scenario.num_vehicles, *self.models[0].drift_position.shape))
        sagittas = np.zeros((means.shape[0], means.shape[1] - 1, means.shape[2]))
        for members, z in zip(sets, points, strict=True):
            places = list(members)
            means[places], sagittas[places] = self._motion(members, z)
        return pair_risks_across_sets(
            self.scenario,
            means,
            self.covariances,
            owners_of(sets),
            sagittas,
            self.hazards.common,
        )

    def _motion(self, members: Members, z: Vector) -> tuple[Tensor, Tensor]:
        """Return the mean positions of a set, (n, T+1, d), and their sagittas, (n, T, d).

        Those of the last point asked for are kept: from one estimate to the next few sets move.
        """
        known = self._motions.get(members)
        if known is None or known[0] is not z:
            problem = self.problem(members)
            means = problem.means(z)
            sagittas = np.zeros((len(members), means.shape[1] - 1, means.shape[2]))
            for place, controls in enumerate(controls_of(problem.models, z)):
                if self.scenario.vehicles[members[place]].system.is_double_integrator:
                    sagittas[place] = self.scenario.dt**2 / 8.0 * controls
            known = self._motions[members] = (z, means, sagittas)
        return known[1:]

    def controls(self, sets: Sequence[Members], points: Sequence[Vector]) -> tuple[Matrix, ...]:
        """Return every vehicle's controls, in the scenario's order.

        Parameters
        ----------
        sets : sequence of tuple of int
            A partition of the fleet.
        points : sequence of (n,) array
            A point of each.

        Returns
        -------
        tuple of (T, m) array
            One per vehicle.
        """
        controls: dict[int, Matrix] = {}
        for members, z in zip(sets, points, strict=True):
            models = self.problem(members).models
            controls |= dict(zip(members, controls_of(models, z), strict=True))
        return tuple(controls[i] for i in range(self.scenario.num_vehicles))
