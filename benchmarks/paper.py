"""The paper's workload: what `multi-vehicle` takes, and how much less than centralized IRA.

    python benchmarks/paper.py                      # N = 2..8, ten seeds, multi-vehicle only
    python benchmarks/paper.py --reference 2 3 4 --cap 120 --seeds 3

Seconds are those of the plan file: from the loaded scenario to the certificate. The reference is
IRA over the whole fleet with big-M on HiGHS (or another backend), stopped at the cap; stopped
runs count at the cap and are marked with ``>``, so that the ratio is a lower bound there.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import sys
from dataclasses import dataclass

from rich.console import Console
from rich.table import Table

from radmpc.experiments.families import paper
from radmpc.model.plan import Status
from radmpc.planners import Centralized, Ira, Planner
from radmpc.planning import plan
from radmpc.solvers.milp.big_m import BigM


@dataclass(frozen=True)
class Run:
    """One problem planned once."""

    num_vehicles: int
    seed: int
    seconds: dict[str, float]
    sets: str
    cost: float | None
    certified: float | None
    is_capped: bool


def run(num_vehicles: int, seed: int, planner: str | Planner, cap: float | None) -> Run:
    """Plan one problem."""
    result = plan(paper(num_vehicles, seed), planner, rng=0, time_limit=cap)
    certificate = result.certificate
    return Run(
        num_vehicles,
        seed,
        dict(result.seconds),
        "+".join(str(len(s)) for s in sorted(result.sets, key=len, reverse=True)),
        result.cost,
        None if certificate is None else certificate.certified,
        result.status is Status.LIMIT or (cap is not None and result.seconds["total"] >= cap),
    )


def rows_of(runs: list[Run]) -> Table:
    """Return one row per problem."""
    table = Table("N", "seed", r"radmpc \[s]", r"sets \[s]", r"certificate \[s]", r"total \[s]")
    for name in ("sets", "cost", "certified"):
        table.add_column(name)
    for r in runs:
        stages = [
            f"{r.seconds.get(k, 0.0):.3f}" for k in ("radmpc", "sets", "certificate", "total")
        ]
        cost = "-" if r.cost is None else f"{r.cost:.3f}"
        over = " > 0.05" if r.certified is not None and r.certified > 0.05 else ""
        certified = "-" if r.certified is None else f"{r.certified:.4f}{over}"
        table.add_row(str(r.num_vehicles), str(r.seed), *stages, r.sets, cost, certified)
    return table


def summary_of(runs: list[Run], reference: dict[tuple[int, int], Run], cap: float) -> Table:
    """Return one row per fleet size: medians, and the geometric mean of the ratios."""
    table = Table("N", r"median \[s]", r"max \[s]", "within 0.05", r"reference \[s]", "speed-up")
    for n in sorted({r.num_vehicles for r in runs}):
        ours = [r for r in runs if r.num_vehicles == n]
        totals = [r.seconds["total"] for r in ours]
        held = sum(r.certified is not None and r.certified <= 0.05 for r in ours)
        pairs = [(r, reference[n, r.seed]) for r in ours if (n, r.seed) in reference]
        shown, speed = "-", "-"
        if pairs:
            times = [cap if t.is_capped else t.seconds["total"] for _, t in pairs]
            ratios = [t / o.seconds["total"] for (o, _), t in zip(pairs, times, strict=True)]
            mark = ">" if any(t.is_capped for _, t in pairs) else ""
            shown = f"{mark}{statistics.median(times):.1f}"
            speed = f"{mark}{statistics.geometric_mean(ratios):.0f}"
        table.add_row(
            str(n),
            f"{statistics.median(totals):.3f}",
            f"{max(totals):.3f}",
            f"{held} of {len(ours)}",
            shown,
            speed,
        )
    return table


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--sizes", type=int, nargs="+", default=list(range(2, 9)))
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--planner", default="multi-vehicle")
    parser.add_argument("--reference", type=int, nargs="*", default=[], help="sizes to compare")
    parser.add_argument("--backend", default="highs", help="of the reference")
    parser.add_argument("--cap", type=float, default=120.0, help="seconds per reference problem")
    options = parser.parse_args()
    console = Console(file=sys.stdout, width=120)
    runs, reference = [], {}
    plan(paper(2, 0))  # imports and caches of the libraries, not counted
    for n in options.sizes:
        for seed in range(options.seeds):
            runs.append(run(n, seed, options.planner, None))
            if n in options.reference:
                ira = Planner(Ira(), BigM(options.backend), Centralized())
                reference[n, seed] = run(n, seed, ira, options.cap)
    console.print(rows_of(runs))
    console.print(summary_of(runs, reference, options.cap))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    console.print(f"peak memory {peak:.0f} MB")


if __name__ == "__main__":
    main()
