"""The certified planner on the benchmark families: seconds, gap and certificate.

    python benchmarks/certified.py paper 8 --seeds 10
    python benchmarks/certified.py fleet 64 256 --seeds 2
    python benchmarks/certified.py fleet 1000 --seeds 1 --jobs 2 --limit 120
    python benchmarks/certified.py circle 8 --limit 20
    python benchmarks/certified.py clutter 1 10 --boxes 40 --limit 10

Seconds are those of the plan file: from the loaded scenario to the certificate.
"""

from __future__ import annotations

import argparse
import statistics
from concurrent.futures import ProcessPoolExecutor

from rich.console import Console
from rich.table import Table

from radmpc.experiments.families import circle, clutter, fleet, paper
from radmpc.model.scenario import Scenario
from radmpc.planning import plan
from radmpc.result import Result


def scenario_of(family: str, size: int, seed: int, boxes: int) -> Scenario:
    """Draw one problem."""
    if family == "circle":
        return circle(size)
    if family == "clutter":
        return clutter(size, boxes, seed)
    return (paper if family == "paper" else fleet)(size, seed)


def row_of(size: int, seed: int, result: Result) -> list[str]:
    """Return one row of the table."""
    if result.cost is None or result.lower_bound is None or result.certificate is None:
        return [str(size), str(seed), result.status.value, *["-"] * 5]
    gap = (result.cost - result.lower_bound) / max(result.cost, 1e-9)
    sizes = sorted((len(s) for s in result.sets), reverse=True)
    return [
        str(size),
        str(seed),
        result.status.value,
        f"{result.seconds['total']:.3f}",
        f"{result.cost:.4f}",
        f"{100.0 * gap:.3f}",
        f"{result.certificate.certified:.4f}",
        "+".join(map(str, sizes[:6])) + ("+…" if len(sizes) > 6 else ""),
    ]


def main() -> None:
    """Plan and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("family", choices=("paper", "fleet", "circle", "clutter"))
    parser.add_argument("sizes", type=int, nargs="+")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--boxes", type=int, default=40)
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--jobs", type=int, default=1, help="processes, started beforehand")
    options = parser.parse_args()
    executor = ProcessPoolExecutor(options.jobs) if options.jobs > 1 else None
    if executor is not None:
        # Workers import the package once; a fleet's seconds are those of its planning.
        list(executor.map(scenario_of, ["circle"] * 8, [4] * 8, [0] * 8, [0] * 8))
    table = Table("N", "seed", "status", "seconds", "cost", "gap [%]", "certified", "sets")
    console = Console(width=120)
    for size in options.sizes:
        seconds = []
        for seed in range(1 if options.family == "circle" else options.seeds):
            scenario = scenario_of(options.family, size, seed, options.boxes)
            result = plan(scenario, "certified", time_limit=options.limit, executor=executor)
            seconds.append(result.seconds["total"])
            table.add_row(*row_of(size, seed, result))
        table.add_row(
            str(size), "median", "", f"{statistics.median(seconds):.3f}", end_section=True
        )
    if executor is not None:
        executor.shutdown()
    console.print(table)


if __name__ == "__main__":
    main()
