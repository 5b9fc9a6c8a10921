"""Dense fleets and narrow ways: how soon there is a certified plan, and what it costs in the end.

    python benchmarks/dense.py [--time-limit 20] [--only empty mit]

One row per problem: seconds until the first certified plan and its cost, then cost, lower bound and
certificate at the end. Seconds are those of the wall, in brackets of the processor.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from radmpc import import_scenario, plan
from radmpc.experiments.families import circle, clutter
from radmpc.model.scenario import Scenario

INSTANCES = Path(__file__).parent.parent / "instances"
IMPORTED = (
    "lsc_planner/empty_20agents_3.json",
    "lsc_planner/empty_40agents_3.json",
    "lsc_planner/forest_20agents_3.json",
    "lsc_planner/multi_square8.json",
    "libMultiRobotPlanning/map_8by8_obst12_agents8_ex3.yaml",
    "libMultiRobotPlanning/map_32by32_obst204_agents20_ex3.yaml",
    "s2m2/zigzag.yaml",
    "s2m2/parking.yaml",
    "s2m2/mit.yaml",
)


def problems() -> Iterator[tuple[str, Scenario]]:
    """Return names and scenarios, those of other groups as they import."""
    for name in IMPORTED:
        yield Path(name).stem, import_scenario(INSTANCES / name).scenario
    for count in (8, 16):
        yield f"circle({count})", circle(count)
    for count in (2, 4, 10):
        for avoidance in ("steps", "intervals"):
            drawn = clutter(count, 100, 0)
            yield f"clutter({count}, 100) {avoidance}", replace(drawn, avoidance=avoidance)


def row(name: str, scenario: Scenario, time_limit: float) -> str:
    """Plan one problem, and tell when the first plan was found."""
    wall, processor = time.perf_counter(), time.process_time()
    first: list[tuple[float, float, float]] = []

    def found(cost: float, bound: float | None) -> None:
        del bound
        if not first:
            first.append((time.perf_counter() - wall, time.process_time() - processor, cost))

    result = plan(scenario, time_limit=time_limit, rng=0, found=found)
    head = f"{name:32} {scenario.num_vehicles:3} {scenario.horizon:3}"
    if result.cost is None or result.certificate is None:
        return f"{head}  {result.status.value}"
    seconds, work, cost = first[0] if first else (0.0, 0.0, result.cost)
    bound = "-" if result.lower_bound is None else f"{result.lower_bound:.3f}"
    return (
        f"{head} {seconds:7.2f} ({work:5.2f}) {cost:9.3f}   {result.cost:9.3f} {bound:>9} "
        f"{result.certificate.certified:.4f} of {scenario.risk_bound:g}"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--time-limit", type=float, default=20.0)
    parser.add_argument("--only", nargs="*", default=[], help="parts of names")
    options = parser.parse_args()
    print(f"{'problem':32} {'N':>3} {'T':>3}  first s (cpu)     cost        cost     bound")
    for name, scenario in problems():
        if not options.only or any(part in name for part in options.only):
            print(row(name, scenario, options.time_limit), flush=True)


if __name__ == "__main__":
    main()
