"""What it costs to keep apart along whole intervals rather than at the steps alone.

Run ``python benchmarks/intervals.py [--vehicles 2 3 4 5 6] [--seeds 5] [--time-limit 20]``.
Problems of the paper's family are planned both ways by centralized iterative risk allocation. All
numbers are medians over the problems that both ways solve; efforts are within the solver's gap of
0.1 %. The last columns say how many plans collide on their true path more often than Δ allows.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from radmpc.experiments.families import paper
from radmpc.model.scenario import Avoidance
from radmpc.planners import Centralized, Ira, Planner
from radmpc.planning import plan
from radmpc.referee import simulate
from radmpc.solvers.branch.branch import Branch

PLANNER = Planner(Ira(), Branch(), Centralized())
SAMPLES = 20_000


@dataclass(frozen=True, slots=True)
class Run:
    """One problem planned one way; numbers are nan where it has no plan within the limit."""

    effort: float
    seconds: float
    nodes: int
    true_rate: float


def run(num_vehicles: int, seed: int, avoidance: Avoidance, time_limit: float) -> Run:
    """Plan a problem and fly the plan along its true path."""
    scenario = replace(paper(num_vehicles, seed), avoidance=avoidance)
    result = plan(scenario, PLANNER, rng=seed, time_limit=time_limit)
    nodes = sum(step.nodes for step in result.steps)
    seconds = result.seconds["total"]
    if result.plan is None or result.cost is None:
        return Run(float("nan"), seconds, nodes, float("nan"))
    true_path = replace(result.plan, scenario=replace(scenario, avoidance="intervals"))
    return Run(result.cost, seconds, nodes, simulate(true_path, SAMPLES, rng=seed).rate)


def line(name: str, pairs: Sequence[tuple[Run, Run]]) -> str:
    """Return a row of medians: at steps, along intervals, and how many times more."""
    solved = [(a, b) for a, b in pairs if np.isfinite(a.effort) and np.isfinite(b.effort)]
    cells = [name, f"{len(solved)}/{len(pairs)}"]
    for field in ("effort", "seconds", "nodes"):
        at_steps = np.array([getattr(a, field) for a, _ in solved])
        along = np.array([getattr(b, field) for _, b in solved])
        if not solved:
            cells += ["–", "–", "–"]
            continue
        ratio = float(np.median(along / np.maximum(at_steps, 1e-9)))
        cells += [f"{np.median(at_steps):.3g}", f"{np.median(along):.3g}", f"{ratio:.2f}"]
    for side in (0, 1):
        rates = [pair[side].true_rate for pair in solved]
        cells.append(f"{sum(rate > 0.05 for rate in rates)} (worst {max(rates, default=0.0):.2g})")
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Print one line per fleet size."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--vehicles", type=int, nargs="+", default=[2, 3, 4, 5, 6])
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--time-limit", type=float, default=20.0, help="seconds per problem")
    options = parser.parse_args()
    heads = ["vehicles", "both solved"]
    heads += [f"{field} {way}" for field in ("effort", "seconds", "nodes") for way in _WAYS]
    heads += ["above Δ, at steps", "above Δ, along intervals"]
    print("| " + " | ".join(heads) + " |")
    print("|---" * len(heads) + "|", flush=True)
    everything: list[tuple[Run, Run]] = []
    for size in options.vehicles:
        pairs = [
            (
                run(size, seed, "steps", options.time_limit),
                run(size, seed, "intervals", options.time_limit),
            )
            for seed in range(options.seeds)
        ]
        print(line(str(size), pairs), flush=True)
        everything += pairs
    print(line("all", everything))


_WAYS = ("at steps", "along intervals", "ratio")


if __name__ == "__main__":
    main()
