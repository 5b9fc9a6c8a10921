"""The certified planner against IRA over the whole fleet with big-M, in one run.

    python benchmarks/speedup.py 2 3 --seeds 5
    python benchmarks/speedup.py 4 5 --seeds 3 --cap 900
    python benchmarks/speedup.py 2 --backend highs --cap 60

Seconds are totals of the plan file: from the loaded scenario to the certificate. The reference is
the preset `ira` with another backend. A reference that reached the cap is counted at the cap,
whatever it found by then, and marked with ``>``: its ratio, and any mean with it, is a lower bound.
A problem on which either ended early without a plan, or the proof of `certified` stayed open, is
marked, and left out of the mean where there is no plan to compare.
"""

from __future__ import annotations

import argparse
import statistics
import sys
from dataclasses import dataclass, replace

from rich.console import Console
from rich.table import Table

from radmpc.errors import SolverError
from radmpc.experiments.families import paper
from radmpc.model.plan import Status
from radmpc.planners import Planner
from radmpc.planners.presets import parse_planner
from radmpc.planning import plan
from radmpc.solvers.milp.big_m import BACKENDS, BigM


@dataclass(frozen=True)
class Run:
    """One problem planned once."""

    seconds: float
    cost: float | None
    certified: float | None
    status: str
    is_capped: bool = False
    overrun: float = 0.0


@dataclass(frozen=True)
class Pair:
    """Both planners on one problem."""

    num_vehicles: int
    seed: int
    ours: Run
    theirs: Run

    @property
    def ratio(self) -> float | None:
        """How many times as long the reference took; None where there is nothing to compare."""
        if self.ours.cost is None or (self.theirs.cost is None and not self.theirs.is_capped):
            return None
        return self.theirs.seconds / self.ours.seconds


def run_ours(num_vehicles: int, seed: int, cap: float, repeats: int) -> Run:
    """Plan one problem with `certified`; the median of repeats."""
    results = []
    for _ in range(repeats):
        results.append(plan(paper(num_vehicles, seed), "certified", rng=0, time_limit=cap))
        if results[-1].seconds["total"] > 10.0:
            break
    seconds = statistics.median(r.seconds["total"] for r in results)
    last = results[-1]
    certified = None if last.certificate is None else last.certificate.certified
    return Run(seconds, last.cost, certified, last.status.value)


def run_theirs(num_vehicles: int, seed: int, planner: Planner, cap: float) -> Run:
    """Plan one problem with the reference, counted at the cap from there on."""
    try:
        result = plan(paper(num_vehicles, seed), planner, rng=0, time_limit=cap)
    except SolverError as error:
        return Run(float("nan"), None, None, str(error))
    seconds = result.seconds["total"]
    certified = None if result.certificate is None else result.certificate.certified
    return Run(
        min(seconds, cap),
        result.cost,
        certified,
        result.status.value,
        is_capped=seconds >= cap,
        overrun=max(0.0, seconds - cap),
    )


def row_of(pair: Pair) -> list[str]:
    """Return one row of the table."""
    ours, theirs = pair.ours, pair.theirs
    mark = ">" if theirs.is_capped else ""
    open_proof = "" if ours.status == Status.OPTIMAL.value else f" ({ours.status})"
    seconds = f"{mark}{theirs.seconds:.2f}"
    if theirs.cost is None and not theirs.is_capped:
        seconds += f" ({theirs.status})"
    saved = "-"
    if ours.cost is not None and theirs.cost is not None:
        saved = f"{100.0 * (theirs.cost / ours.cost - 1.0):+.2f}"
    return [
        str(pair.num_vehicles),
        str(pair.seed),
        f"{ours.seconds:.3f}{open_proof}",
        seconds,
        _number(ours.cost),
        _number(theirs.cost),
        saved,
        _number(ours.certified),
        _number(theirs.certified),
        "-" if pair.ratio is None else f"{mark}{pair.ratio:.1f}",
    ]


def _number(value: float | None) -> str:
    """Format a number that may be missing."""
    return "-" if value is None else f"{value:.4f}"


def summary_of(pairs: list[Pair]) -> Table:
    """Return one row per fleet size."""
    seconds = (r"certified \[s]", r"reference \[s]")
    table = Table("N", "problems", "capped", "left out", *seconds, "ratio")
    for n in sorted({p.num_vehicles for p in pairs}):
        compared = [p for p in pairs if p.num_vehicles == n and p.ratio is not None]
        left_out = sum(p.num_vehicles == n for p in pairs) - len(compared)
        capped = sum(p.theirs.is_capped for p in compared)
        cells = ["-", "-", "-"]
        if compared:
            mark = ">" if capped else ""
            median = statistics.median(p.theirs.seconds for p in compared)
            mean = statistics.geometric_mean([p.ratio for p in compared if p.ratio is not None])
            cells = [
                f"{statistics.median(p.ours.seconds for p in compared):.3f}",
                f"{mark}{median:.2f}",
                f"{mark}{mean:.1f}",
            ]
        table.add_row(str(n), str(len(compared)), str(capped), str(left_out), *cells)
    return table


def main() -> None:
    """Plan and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("sizes", type=int, nargs="+", help="fleet sizes N")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--cap", type=float, default=900.0, help="seconds per problem and planner")
    parser.add_argument("--backend", choices=tuple(BACKENDS), default="scip", help="of IRA")
    parser.add_argument("--repeats", type=int, default=3, help="of certified; the median counts")
    options = parser.parse_args()
    reference = replace(parse_planner("ira"), solver=BigM(options.backend))
    console, aside = Console(file=sys.stdout, width=130), Console(stderr=True, width=130)
    # Imports and caches of the libraries, not counted.
    plan(paper(2, 0), "certified")
    run_theirs(1, 0, reference, options.cap)
    pairs = []
    titles = ("N", "seed", r"certified \[s]", r"reference \[s]", "cost", "its cost", "more [%]")
    table = Table(*titles, "certificate", "its certificate", "ratio")
    for n in options.sizes:
        for seed in range(options.seeds):
            ours = run_ours(n, seed, options.cap, options.repeats)
            pairs.append(Pair(n, seed, ours, run_theirs(n, seed, reference, options.cap)))
            row = row_of(pairs[-1])
            aside.print(" ".join(row), highlight=False)  # a long run is seen to go on
            table.add_row(*row)
        table.add_section()
    console.print(f"reference: {reference}; cap {options.cap:g} s")
    console.print(table)
    console.print(summary_of(pairs))
    console.print("seconds: medians; ratio: geometric mean of reference / certified; > is at least")
    over = max(p.theirs.overrun for p in pairs)
    if over > 0.0:
        console.print(f"beyond the cap, and not counted: {over:.2f} s at the most")


if __name__ == "__main__":
    main()
