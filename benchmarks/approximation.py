"""How well RADMPC's approximation matches the centralized solution, path by path.

    python benchmarks/approximation.py --seeds 10

Centralized IRA (solver `branch`), RADMPC and multi-vehicle plan the same problems. The distance is
that between the mean positions of a vehicle at the same step; per problem its mean over vehicles
and steps, and its largest. *Same sides* is the share of (vehicle, obstacle) pairs passed on the
same hand: left or right of the obstacle's middle, seen along the straight line from start to goal.
"""

from __future__ import annotations

import argparse
import statistics
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.table import Table

from radmpc.experiments.families import paper
from radmpc.model.plan import Plan
from radmpc.planners import Centralized, Ira, Planner
from radmpc.planning import plan
from radmpc.solvers.branch.branch import Branch

REFERENCE = Planner(Ira(), Branch(10_000_000), Centralized())


@dataclass(frozen=True)
class Match:
    """How one plan compares with the reference."""

    mean: float
    largest: float
    same_sides: float
    cost: float


def positions(record: Plan) -> np.ndarray:
    """Return mean positions, (N, T+1, d)."""
    pairs = zip(record.scenario.vehicles, record.trajectories, strict=True)
    return np.array([t.means[:, list(v.system.position)] for v, t in pairs])


def sides(record: Plan) -> np.ndarray:
    """Return on which hand every vehicle passes every obstacle, (N, O) of ±1; 0 where far away."""
    found = []
    for vehicle, way in zip(record.scenario.vehicles, positions(record), strict=True):
        along = vehicle.goal.center - vehicle.start_position
        left = np.array([-along[1], along[0]]) / np.linalg.norm(along)
        hands = []
        for obstacle in record.scenario.obstacles:
            middle = obstacle.at(0)[0].vertices.mean(axis=0)
            away = way - middle
            nearest = away[np.linalg.norm(away, axis=1).argmin()]
            is_near = np.linalg.norm(nearest) < 4.0
            hands.append(np.sign(nearest @ left) if is_near else 0.0)
        found.append(hands)
    return np.array(found)


def match(record: Plan, reference: Plan) -> Match:
    """Return how a plan compares with the reference."""
    distances = np.linalg.norm(positions(record) - positions(reference), axis=2)
    near = (sides(record) != 0.0) & (sides(reference) != 0.0)
    same = sides(record)[near] == sides(reference)[near]
    return Match(
        float(distances.mean()),
        float(distances.max()),
        float(same.mean()) if same.size else 1.0,
        (record.cost or 0.0) / (reference.cost or 1.0) - 1.0,
    )


def main() -> None:
    """Plan and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("sizes", type=int, nargs="*", default=[2, 3, 4, 5, 6, 7, 8])
    parser.add_argument("--seeds", type=int, default=10, help="problems of each size")
    parser.add_argument("--cap", type=float, default=60.0, help="seconds for each plan")
    options = parser.parse_args()
    table = Table("planner", "N", "problems", r"mean \[m]", r"largest \[m]", "same sides", "cost")
    for name in ("radmpc", "multi-vehicle"):
        for n in options.sizes:
            found = []
            for seed in range(options.seeds):
                scenario = paper(n, seed)
                one = plan(scenario, REFERENCE, rng=seed, time_limit=options.cap).plan
                two = plan(scenario, name, rng=seed, time_limit=options.cap).plan
                if one is not None and two is not None:
                    found.append(match(two, one))
            if found:
                table.add_row(
                    name,
                    str(n),
                    str(len(found)),
                    f"{statistics.median(m.mean for m in found):.2f}",
                    f"{statistics.median(m.largest for m in found):.2f}",
                    f"{100.0 * statistics.fmean(m.same_sides for m in found):.0f} %",
                    f"{100.0 * statistics.median(m.cost for m in found):+.2f} %",
                )
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
