"""What it changes to spread Δ over all constraints, as the paper's text has it.

    python benchmarks/spread.py [seeds]

Prints effort and certificate of `uniform`, `ira` and `radmpc` on the paper's problems with six
vehicles, with shares for the constraints that reach leaves (as here) and for all (the paper).
"""

from __future__ import annotations

import argparse

import numpy as np

from radmpc import plan
from radmpc.experiments.families import paper
from radmpc.planners import Centralized, Ira, Planner, Pool, Receding, Uniform
from radmpc.program.allocation import Spread
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.branch.branch import Branch

NUM_VEHICLES = 6
SPREADS: tuple[Spread, ...] = ("reached", "all")


def planners(spread: Spread) -> dict[str, Planner]:
    """Return the planners that spread Δ evenly somewhere."""
    return {
        "uniform": Planner(Uniform(spread), Branch(), Centralized()),
        "ira": Planner(Ira(spread=spread), Branch(), Centralized()),
        "radmpc": Planner(Pool(spread=spread), Branch(), Receding()),
    }


def main(num_seeds: int) -> None:
    """Print a table."""
    scenarios = [paper(NUM_VEHICLES, seed) for seed in range(num_seeds)]
    for seed, scenario in enumerate(scenarios):
        program = build_program(
            scenario, condensed_models(scenario), risk_bound=scenario.risk_bound
        )
        left, settled = program.num_avoidances, program.num_presolved
        print(f"seed {seed}: reach leaves {left} of {left + settled} avoidances")
    print("planner  spread    plans  mean effort  median certificate")
    for name in planners("reached"):
        for spread in SPREADS:
            results = [plan(s, planners(spread)[name], rng=0, time_limit=60.0) for s in scenarios]
            found = [r for r in results if r.cost is not None and r.certificate is not None]
            costs = [r.cost for r in found if r.cost is not None]
            risks = [r.certificate.certified for r in found if r.certificate is not None]
            print(
                f"{name:8s} {spread:9s} {len(found):5d}  {np.mean(costs):11.4f}  "
                f"{np.median(risks):18.4f}"
            )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("seeds", nargs="?", type=int, default=5, help="problems, from seed 0 on")
    main(parser.parse_args().seeds)
