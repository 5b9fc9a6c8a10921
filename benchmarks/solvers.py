"""One program at fixed margins, solved by `branch` and by big-M backends in one run.

    python benchmarks/solvers.py --sizes 2 3 --seeds 3 --backends highs scip gurobi --cap 120
    python benchmarks/solvers.py --sizes 4 5 --backends gurobi --avoidance steps --repeats 5

The margins are those of the uniform allocation. Prints seconds (medians of the repeats, taken in
turn), costs, and the ratio of each backend to `branch`; capped runs are marked with ``>`` and make
the ratio a lower bound. Programs that a backend refuses for their size, or that `branch` leaves
open, are marked and listed, and not part of the mean; backends that are not installed are left out.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from rich.console import Console
from rich.table import Table

from radmpc.errors import SolverError
from radmpc.experiments.families import paper
from radmpc.program.allocation import margins_of, uniform_allocation
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.milp.big_m import BigM
from radmpc.solvers.solution import Limits, Outcome, Solution

GAP = 1e-3


@dataclass
class Tally:
    """What one backend did over all problems."""

    ratios: list[tuple[int, float, bool]] = field(default_factory=list)
    refused: list[str] = field(default_factory=list)
    open: list[str] = field(default_factory=list)
    disagreements: list[str] = field(default_factory=list)


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--sizes", type=int, nargs="+", default=[2, 3])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--backends", nargs="*", default=["highs", "scip", "gurobi"])
    parser.add_argument(
        "--avoidance", nargs="+", choices=("steps", "intervals"), default=["steps", "intervals"]
    )
    parser.add_argument("--repeats", type=int, default=1, help="of every solve that is not capped")
    parser.add_argument("--cap", type=float, default=120.0, help="seconds per solve")
    options = parser.parse_args()
    names = [title for b in options.backends for title in (rf"{b} \[s]", "ratio", "cost")]
    table = Table("avoidance", "N", "seed", r"branch \[s]", "nodes", "gap", "cost", *names)
    tallies: dict[str, Tally] = defaultdict(Tally)
    for avoidance in options.avoidance:
        for n in options.sizes:
            for seed in range(options.seeds):
                row = _row(avoidance, n, seed, options, tallies)
                table.add_row(avoidance, str(n), str(seed), *row)
            table.add_section()
    console = Console(file=sys.stdout, width=90 + 25 * len(options.backends))
    console.print(table)
    for backend, tally in tallies.items():
        _summarize(console, backend, tally)


def _summarize(console: Console, backend: str, tally: Tally) -> None:
    """Print the means of one backend, and what is not part of them."""
    sizes = sorted({n for n, _, _ in tally.ratios})
    groups = [(f"{backend}, N = {n}", [r for r in tally.ratios if r[0] == n]) for n in sizes]
    if len(groups) > 1:
        groups.append((backend, tally.ratios))
    for name, found in groups:
        ratios = [ratio for _, ratio, _ in found]
        capped = sum(is_capped for _, _, is_capped in found)
        console.print(
            f"{name}: {'at least ' if capped else ''}{statistics.geometric_mean(ratios):.1f} times "
            f"as long as branch (geometric mean; {min(ratios):.1f} to {max(ratios):.1f}; "
            f"problems: {len(ratios)}, capped: {capped})"
        )
    if tally.refused:
        console.print(f"{backend}: refused, not in the mean: {'; '.join(tally.refused)}")
    if tally.open:
        console.print(f"{backend}: branch hit a limit, not in the mean: {'; '.join(tally.open)}")
    if tally.disagreements:
        console.print(f"{backend}: DISAGREES: {'; '.join(tally.disagreements)}")


def _row(
    avoidance: str, n: int, seed: int, options: argparse.Namespace, tallies: dict[str, Tally]
) -> list[str]:
    """Solve one program by everything; return the cells."""
    scenario = replace(paper(n, seed), avoidance=avoidance)
    program = build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)
    margins = margins_of(program, uniform_allocation(program, program.budget))

    def ours() -> Solution:
        limits = Limits(deadline=time.monotonic() + options.cap)
        return Branch(50_000).solve(program, margins, gap=GAP, limits=limits)

    def by(backend: str) -> Callable[[], Solution]:
        def theirs() -> Solution:
            limits = Limits(deadline=time.monotonic() + options.cap)
            return BigM(backend).solve(program, margins, gap=GAP, limits=limits)

        return theirs

    solvers = {"branch": ours, **{b: by(b) for b in options.backends}}
    answers: dict[str, list[Solution]] = {name: [] for name in solvers}
    refusals: dict[str, str] = {}
    for _ in range(options.repeats):
        for name, solve in solvers.items():
            if name in refusals or (answers[name] and _is_capped(answers[name][-1])):
                continue
            try:
                answers[name].append(solve())
            except SolverError as error:
                refusals[name] = str(error)
    mine = answers["branch"][0]
    seconds = statistics.median(a.seconds for a in answers["branch"])
    capped = ">" if _is_capped(mine) else ""
    cells = [f"{capped}{seconds:.4f}", str(mine.nodes), f"{mine.gap:.1e}", f"{mine.cost:.4f}"]
    for backend in options.backends:
        label = f"{avoidance} {n}/{seed}"
        if backend in refusals:
            cells += _refused(refusals[backend], label, tallies[backend])
        else:
            cells += _compared(answers[backend], mine, seconds, (n, label), tallies[backend])
    return cells


def _refused(reason: str, label: str, tally: Tally) -> list[str]:
    """Return the cells of a backend that would not solve; remember the sizes it refused."""
    if "needs:" in reason:
        return ["-", "-", "-"]
    tally.refused.append(f"{label} ({reason})")
    return ["too large" if "size-limited" in reason else "refused", "-", "-"]


def _compared(
    answers: list[Solution], mine: Solution, seconds: float, name: tuple[int, str], tally: Tally
) -> list[str]:
    """Return the cells of a backend's answers."""
    theirs = answers[0]
    taken = statistics.median(a.seconds for a in answers)
    num_vehicles, label = name
    mark = ">" if _is_capped(theirs) else ""
    if _is_capped(mine):
        tally.open.append(label)
    else:
        tally.ratios.append((num_vehicles, taken / seconds, bool(mark)))
    # Each proven bound must lie below the other's solution.
    room = 1e-6 * max(1.0, abs(mine.cost))
    is_infeasible = {mine.outcome, theirs.outcome} == {Outcome.OPTIMAL, Outcome.INFEASIBLE}
    if is_infeasible or mine.bound > theirs.cost + room or theirs.bound > mine.cost + room:
        tally.disagreements.append(
            f"{label}: branch {mine.bound:.6f} to {mine.cost:.6f}, "
            f"{theirs.bound:.6f} to {theirs.cost:.6f}"
        )
    ratio = "-" if _is_capped(mine) else f"{mark}{taken / seconds:.2f}"
    return [f"{mark}{taken:.3f}", ratio, f"{theirs.cost:.4f}"]


def _is_capped(solution: Solution) -> bool:
    """Whether a limit ended the solve."""
    return solution.outcome in {Outcome.FEASIBLE, Outcome.LIMIT}


if __name__ == "__main__":
    main()
