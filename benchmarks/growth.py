"""How the certified planner's time grows with the fleet, and what meeting others costs.

    python benchmarks/growth.py 128 256 --seeds 2
    python benchmarks/growth.py 128 1000 --seeds 1 --limit 120

Prints, per fleet size, the seconds of the whole fleet and of planning each vehicle by itself in
the same scene with the whole bound, their ratio, and the exponent of seconds in N from the
smallest to the largest size (medians).
"""

from __future__ import annotations

import argparse
import math
import statistics
import time

from rich.console import Console
from rich.table import Table

from radmpc.experiments.families import fleet
from radmpc.model.scenario import Scenario
from radmpc.planning import plan


def seconds_alone(scenario: Scenario) -> float:
    """Return how long planning each vehicle by itself takes, one after the other."""
    begun = time.perf_counter()
    for i in range(scenario.num_vehicles):
        plan(scenario.subset((i,), scenario.risk_bound), "certified")
    return time.perf_counter() - begun


def main() -> None:
    """Plan and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("sizes", type=int, nargs="+")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--limit", type=float, default=120.0)
    options = parser.parse_args()
    table = Table("N", "seed", "status", r"fleet \[s]", r"each alone \[s]", "ratio")
    console = Console(width=100)
    medians = {}
    for size in sorted(options.sizes):
        found = []
        for seed in range(options.seeds):
            scenario = fleet(size, seed)
            result = plan(scenario, "certified", time_limit=options.limit)
            total, alone = result.seconds["total"], seconds_alone(scenario)
            found.append(total)
            table.add_row(
                str(size),
                str(seed),
                result.status.value,
                f"{total:.2f}",
                f"{alone:.2f}",
                f"{total / alone:.1f}",
            )
        medians[size] = statistics.median(found)
    console.print(table)
    first, last = min(medians), max(medians)
    if first < last:
        exponent = math.log(medians[last] / medians[first]) / math.log(last / first)
        console.print(f"exponent from N = {first} to N = {last}: {exponent:.2f} (medians)")


if __name__ == "__main__":
    main()
