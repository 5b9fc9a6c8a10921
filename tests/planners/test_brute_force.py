"""Tiny cases against all sides and directions tried one by one, by linear programs of their own."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.stats import norm

from radmpc import plan
from radmpc.experiments.families import paper, paper_vehicle
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario

TOLERANCE = 2e-3
"""How much dearer than the best of all directions tried a plan may be [-]: it counts as done where
a turn gains less than a fifth of the gap of 0.1 %. Measured were 0.005 %."""

COARSE, FINE = 8, 72
"""Directions all around, per constraint: those that are all combined, and those between them that
are tried one constraint at a time."""

BOX = np.array([[2.4, -1.2], [3.4, -1.2], [3.4, 0.9], [2.4, 0.9]])


def unit(angle: float) -> np.ndarray:
    return np.array([np.cos(angle), np.sin(angle)])


class Brute:
    """Least effort with a half-space per hazard and step, risks shared at best."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario, steps = scenario, scenario.horizon
        vehicle = scenario.vehicles[0]
        a, b = vehicle.system.A, vehicle.system.B
        responses = [np.zeros((4, 2 * steps))]
        covariances = [vehicle.initial_covariance]
        for k in range(steps):
            following = a @ responses[-1]
            following[:, 2 * k : 2 * k + 2] += b
            responses.append(following)
            covariances.append(a @ covariances[-1] @ a.T + vehicle.disturbance_covariance)
        self.responses, self.covariances = responses, covariances
        self.free = [
            [np.linalg.matrix_power(a, k) @ v.start for k in range(steps + 1)]
            for v in scenario.vehicles
        ]

    def cost(self, hazards: Sequence[tuple], angles: Sequence[float]) -> float:
        """Return the least cost; inf where no plan keeps to the half-spaces.

        Hazards are (step, i, j), of two vehicles, or (step, i, corners).
        """
        steps, count = self.scenario.horizon, len(self.scenario.vehicles)
        span = 2 * steps
        columns = 2 * span * count + len(hazards)
        rows, rights = [], []

        def at_most(terms: list[tuple[int, np.ndarray]], risk: tuple[int, float], right: float):
            row = np.zeros(columns)
            for i, coefficients in terms:
                row[2 * span * i : 2 * span * i + span] += coefficients
                row[2 * span * i + span : 2 * span * (i + 1)] -= coefficients
            if risk[1]:
                row[2 * span * count + risk[0]] = risk[1]
            rows.append(row)
            rights.append(right)

        for i, v in enumerate(self.scenario.vehicles):
            for axis in (0, 1):
                last, free = self.responses[-1], self.free[i][-1]
                at_most([(i, last[axis])], (0, 0.0), v.goal.upper[axis] - free[axis])
                at_most([(i, -last[axis])], (0, 0.0), free[axis] - v.goal.lower[axis])
                for k in range(1, steps + 1):
                    limit = v.goal.speed[axis] if k == steps else v.speed_limit[axis]
                    at_most([(i, self.responses[k][2 + axis])], (0, 0.0), limit)
                    at_most([(i, -self.responses[k][2 + axis])], (0, 0.0), limit)
        for number, ((k, i, other), angle) in enumerate(zip(hazards, angles, strict=True)):
            normal, mine = unit(angle), self.responses[k][:2]
            cov = self.covariances[k][:2, :2] * (2.0 if isinstance(other, int) else 1.0)
            sigma = float(np.sqrt(normal @ cov @ normal))
            terms, offset = [(i, -normal @ mine)], normal @ self.free[i][k][:2]
            if isinstance(other, int):
                terms.append((other, normal @ mine))
                offset -= normal @ self.free[other][k][:2]
                offset -= sum(self.scenario.vehicles[n].radius for n in (i, other))
            else:
                offset -= (other @ normal).max() + self.scenario.vehicles[i].radius
            # The clearance z is (offset - terms) / sigma >= 0; the risk t lies above all tangents.
            at_most(terms, (0, 0.0), offset)
            for z in np.linspace(0.0, 5.0, 26):
                slope = float(norm.pdf(z))
                # t >= Q(z) - slope (clearance - z), in units of the bound.
                scaled = [(n, slope / sigma * c) for n, c in terms]
                right = slope / sigma * offset - float(norm.sf(z)) - slope * z
                at_most(scaled, (number, -self.scenario.risk_bound), right)
        total = np.zeros(columns)
        total[2 * span * count :] = 1.0
        limit = np.tile(
            np.repeat([v.control_limit for v in self.scenario.vehicles], 2, axis=0), steps
        )
        upper = np.append(limit.ravel()[: 2 * span * count], np.ones(len(hazards)))
        objective = np.append(np.ones(2 * span * count), np.zeros(len(hazards)))
        found = linprog(
            objective,
            A_ub=np.vstack([*rows, total]),
            b_ub=np.append(rights, 1.0),
            bounds=np.stack([np.zeros(columns), upper], axis=1),
        )
        return float(found.fun) if found.status == 0 else np.inf

    def best(self, hazards: Sequence[tuple]) -> float:
        """Return the least cost over all combinations of coarse directions, the best refined."""
        grid = 2.0 * np.pi * np.arange(COARSE) / COARSE
        rated = [
            (self.cost(hazards, angles), angles)
            for angles in itertools.product(grid, repeat=len(hazards))
        ]
        rated.sort(key=lambda one: one[0])
        least = np.inf
        for cost, first in rated[:3]:
            angles, here = list(first), cost
            for number in (*range(len(hazards)), *range(len(hazards))):
                tried = []
                # Those between this direction and its neighbors on the coarse grid.
                for turn in np.arange(-FINE // COARSE, FINE // COARSE + 1):
                    angle = angles[number] + 2.0 * np.pi * turn / FINE
                    other = [*angles[:number], float(angle), *angles[number + 1 :]]
                    tried.append((self.cost(hazards, other), other))
                here, angles = min(tried, key=lambda one: one[0])
            least = min(least, here)
        return least


def scenario_of(ends: Sequence[tuple], horizon: int, obstacles: tuple = ()) -> Scenario:
    vehicles = tuple(
        paper_vehicle(f"v{n}", np.array(start), np.array(goal))
        for n, (start, goal) in enumerate(ends)
    )
    return replace(paper(1, 0), vehicles=vehicles, obstacles=obstacles, horizon=horizon)


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("goal", [(6.0, 0.4), (6.0, -0.6)])
def test_a_plan_around_a_box_is_no_dearer_than_by_any_directions(goal: tuple[float, float]) -> None:
    box = Obstacle.polygon("box", BOX)
    scenario = scenario_of([((0.0, 0.0), goal)], 4, (box,))
    brute = Brute(scenario)
    # At the last step it is within its goal, 2.4 m from the box.
    best = brute.best([(k, 0, BOX) for k in (2, 3)])
    everywhere = plan(scenario, time_limit=20.0)
    assert np.isfinite(best)
    assert everywhere.cost is not None
    assert everywhere.cost <= best * (1.0 + TOLERANCE)


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_a_plan_of_two_that_cross_is_no_dearer_than_by_any_directions(offset: float) -> None:
    ends = [((0.0, 0.0), (5.0, 0.0)), ((2.5 + offset, -2.5), (2.5 + offset, 2.5))]
    scenario = scenario_of(ends, 4)
    best = Brute(scenario).best([(k, 0, 1) for k in (2, 3)])
    result = plan(scenario, time_limit=20.0)
    assert np.isfinite(best)
    assert result.cost is not None
    assert result.cost <= best * (1.0 + TOLERANCE)
