"""One programme at fixed margins, solved by `branch` and by big-M backends in one run.

    python benchmarks/solvers.py --sizes 2 3 --seeds 3 --backends highs scip gurobi --cap 120

Prints seconds and the ratio of each backend to `branch`; capped runs are marked with ``>`` and
make the ratio a lower bound. Backends that are not installed, or refuse the size, are left out.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections import defaultdict
from dataclasses import replace

from rich.console import Console
from rich.table import Table

from radmpc.errors import SolverError
from radmpc.experiments.families import paper
from radmpc.program.build import build_program, whole_subjects
from radmpc.program.policy import margins_of, uniform_allocation
from radmpc.solvers.big_m import BigM
from radmpc.solvers.branch import Branch
from radmpc.solvers.solution import Limits, Outcome

GAP = 1e-3


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=[2, 3])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--backends", nargs="*", default=["highs", "scip", "gurobi"])
    parser.add_argument("--cap", type=float, default=120.0)
    options = parser.parse_args()
    table = Table("avoidance", "N", "seed", "branch [s]", "nodes", "gap", *options.backends)
    ratios: dict[str, list[float]] = defaultdict(list)
    for avoidance in ("steps", "intervals"):
        for n in options.sizes:
            for seed in range(options.seeds):
                row = _row(avoidance, n, seed, options, ratios)
                table.add_row(avoidance, str(n), str(seed), *row)
    console = Console(file=sys.stdout, width=120)
    console.print(table)
    for backend, found in ratios.items():
        console.print(
            f"{backend}: {statistics.geometric_mean(found):.0f} times as long as branch "
            f"(geometric mean; {min(found):.0f} to {max(found):.0f}; {len(found)} problems)"
        )


def _row(
    avoidance: str, n: int, seed: int, options: argparse.Namespace, ratios: dict[str, list[float]]
) -> list[str]:
    """Solve one programme by everything; return the cells."""
    scenario = replace(paper(n, seed), avoidance=avoidance)
    program = build_program(scenario, whole_subjects(scenario), risk_bound=scenario.risk_bound)
    margins = margins_of(program, uniform_allocation(program, program.budget))
    ours = Branch(50_000).solve(program, margins, gap=GAP, limits=Limits())
    cells = [f"{ours.seconds:.3f}", str(ours.nodes), f"{ours.gap:.1e}"]
    for backend in options.backends:
        limits = Limits(deadline=time.monotonic() + options.cap)
        try:
            theirs = BigM(backend).solve(program, margins, gap=GAP, limits=limits)
        except SolverError:
            cells.append("-")
            continue
        capped = theirs.outcome is not Outcome.OPTIMAL
        ratios[backend].append(theirs.seconds / ours.seconds)
        cells.append(f"{'>' if capped else ''}{theirs.seconds:.2f} s")
    return cells


if __name__ == "__main__":
    main()
