"""Every planner against the certified one by the measure the program itself uses.

    python benchmarks/costs.py 2 3 --seeds 3 --cap 60
    python benchmarks/costs.py 4 --seeds 5 --planners uniform ira multi-vehicle radmpc

A plan's Boole total charges every avoidance of the whole fleet the risk of its cheapest side, and
adds what no control can change. A plan that keeps the hard rows and whose total is within Δ is a
point of the program that `certified` bounds. So (1) its cost is at least the lower bound, and
(2) where `certified` closed its gap, its cost is at least ``certified · (1 − gap)``. Both are
checked, up to 1e-6 of the cost; a violation is a bug.

Plans above Δ are no points of that program and may cost less. They are listed, and those that
the referee, who is not bound to the program's faces, certifies all the same are counted apart.
`certified` spends what the referee leaves: its own total may be above Δ, its certificate never.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from rich.console import Console
from rich.table import Table

from radmpc.arrays import Matrix, Vector
from radmpc.errors import SolverError
from radmpc.experiments.families import paper
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners import Planner
from radmpc.planners.presets import PRESETS, parse_planner
from radmpc.planning import plan
from radmpc.program.build import build_program, condensed_models, controls_of
from radmpc.result import Result
from radmpc.solvers.priced.rating import Rater

_TOL = 1e-6
"""Relative slack of costs and totals: what linear solvers leave open."""

_MOST_UNIT = 0.5
"""Largest risk of a row for which sides are told apart, so that totals above Δ are true, too."""

_CERTIFIED = "certified"


class Judge:
    """The joint program of a scenario, which rates any plan of it."""

    def __init__(self, scenario: Scenario) -> None:
        self.models = condensed_models(scenario)
        self.program = build_program(scenario, self.models, risk_bound=scenario.risk_bound)
        self.rater = Rater(self.program, _MOST_UNIT)

    def point_of(self, controls: Sequence[Matrix]) -> Vector:
        """Return the columns that stand for controls: their positive parts, then the negative."""
        parts = []
        for one in controls:
            flat = one.ravel()
            parts += [np.maximum(flat, 0.0), np.maximum(-flat, 0.0)]
        z = np.concatenate(parts)
        for one, back in zip(controls, controls_of(self.models, z), strict=True):
            np.testing.assert_array_equal(one, back)
        return z

    def total(self, z: Vector) -> float:
        """Return the Boole total over all avoidances."""
        return self.rater.rate(z).risk + self.program.initial_risk

    def cost(self, z: Vector) -> float:
        """Return the program's cost."""
        return float(self.program.cost @ z)

    def excess(self, z: Vector) -> float:
        """Return by how much the worst hard row or bound is missed."""
        program = self.program
        values = program.hard @ z
        misses = (
            program.hard_lower - values,
            values - program.hard_upper,
            program.lower - z,
            z - program.upper,
        )
        return max(float(m.max(initial=0.0)) for m in misses)


@dataclass(frozen=True)
class Entry:
    """One plan, rated."""

    label: str
    planner: str
    status: str
    seconds: float
    cost: float | None = None
    total: float = float("nan")
    excess: float = 0.0
    certificate: float = float("nan")
    bound: float | None = None


def entry_of(label: str, name: str, planner: Planner, judge: Judge, result: Result) -> Entry:
    """Rate a result."""
    seconds = result.seconds["total"]
    status = result.status.value
    # A search that ended without a proof is told from one whose planner gives none.
    is_open = result.status is not Status.OPTIMAL
    if is_open and any(step.gap > planner.gap * (1.0 + _TOL) for step in result.steps):
        status += ", open"
    if result.plan is None or result.cost is None or result.certificate is None:
        return Entry(label, name, status, seconds)
    z = judge.point_of([t.controls for t in result.plan.trajectories])
    assert abs(judge.cost(z) - result.cost) <= _TOL * max(1.0, result.cost)
    return Entry(
        label,
        name,
        status,
        seconds,
        result.cost,
        judge.total(z),
        judge.excess(z),
        result.certificate.certified,
        result.lower_bound,
    )


@dataclass
class Findings:
    """What is counted over all problems."""

    num_compared: int = 0
    num_bounded: int = 0
    unjudged: int = 0
    violations: list[str] = field(default_factory=list)
    above: list[str] = field(default_factory=list)
    above_certified: list[str] = field(default_factory=list)

    def judge(self, best: Entry, other: Entry, risk_bound: float, gap: float) -> str:
        """Check one plan against the certified one; return the word for the table."""
        if other.cost is None:
            return "no plan"
        told = f"{other.label} {other.planner}: cost {other.cost:.9g}, Boole {other.total:.9g}"
        if other.excess > _TOL:
            self.unjudged += 1
            return f"misses hard rows by {other.excess:.1e}"
        if other.total > risk_bound * (1.0 + _TOL):
            more = "" if best.cost is None else f", {_share(other.cost, best.cost)} %"
            told = f"{told}, certificate {other.certificate:.6f}{more}"
            if other.certificate <= risk_bound:
                self.above_certified.append(told)
                return "above Δ, but certified"
            self.above.append(told)
            return "above Δ"
        wrong = []
        most = other.cost * (1.0 + _TOL) + 1e-9
        if best.bound is not None:
            self.num_bounded += 1
            if best.bound > most:
                wrong.append(f"lower bound {best.bound:.9g}")
        if best.cost is not None and best.status == Status.OPTIMAL.value:
            self.num_compared += 1
            if best.cost * (1.0 - gap) > most:
                wrong.append(f"certified cost {best.cost:.9g} at a gap of {gap:g}")
        elif best.status == Status.INFEASIBLE.value:
            wrong.append("certified says there is no plan")
        if wrong:
            self.violations.append(f"{told}, {' and '.join(wrong)}")
            return "VIOLATION"
        return "ok"


def _share(cost: float, than: float) -> str:
    """Return how much more a plan costs, in percent."""
    return f"{100.0 * (cost / max(than, 1e-9) - 1.0):+.3f}"


def row_of(entry: Entry, best: Entry, word: str) -> list[str]:
    """Return one row of the table."""
    cells = [entry.label, entry.planner, entry.status, f"{entry.seconds:.2f}"]
    if entry.cost is None:
        return [*cells, "-", "-", "-", "-", word]
    more = "-" if best.cost is None else _share(entry.cost, best.cost)
    return [
        *cells,
        f"{entry.cost:.5f}",
        more,
        f"{entry.total:.5f}",
        f"{entry.certificate:.5f}",
        word,
    ]


def best_word(best: Entry, risk_bound: float) -> str:
    """Describe the certified plan: bound and gap, and its own total."""
    if best.cost is None or best.bound is None:
        return "no plan" if best.cost is None else "no bound"
    gap = (best.cost - best.bound) / max(best.cost, 1e-9)
    over = "; ABOVE Δ" if (best.certificate or 0.0) > risk_bound else ""
    return f"bound {best.bound:.5f}, gap {100.0 * gap:.3f} %{over}"


def main() -> None:
    """Plan, rate, check and print."""
    others = [name for name in PRESETS if name != _CERTIFIED]
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("sizes", type=int, nargs="+", help="fleet sizes N")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--cap", type=float, default=60.0, help="seconds per plan")
    parser.add_argument("--planners", nargs="+", default=others, help="besides certified")
    options = parser.parse_args()
    records = {name: parse_planner(name) for name in options.planners}
    ours = parse_planner(_CERTIFIED)
    console, aside = Console(file=sys.stdout, width=140), Console(stderr=True, width=140)
    table = Table(
        "N/seed", "planner", "status", r"\[s]", "cost", "more [%]", "Boole", "certificate"
    )
    table.add_column("check", no_wrap=True)
    found, bests = Findings(), []
    for n in options.sizes:
        for seed in range(options.seeds):
            scenario, label = paper(n, seed), f"{n}/{seed}"
            judge = Judge(scenario)
            result = plan(scenario, _CERTIFIED, rng=0, time_limit=options.cap)
            best = entry_of(label, _CERTIFIED, ours, judge, result)
            bests.append((best, scenario.risk_bound))
            rows = [row_of(best, best, best_word(best, scenario.risk_bound))]
            for name, record in records.items():
                try:
                    result = plan(scenario, record, rng=0, time_limit=options.cap)
                except SolverError as error:
                    rows.append([label, name, str(error), *["-"] * 6])
                    continue
                entry = entry_of(label, name, record, judge, result)
                word = found.judge(best, entry, scenario.risk_bound, ours.gap)
                rows.append(row_of(entry, best, word))
            for row in rows:
                aside.print(" ".join(row), highlight=False, markup=False)
                table.add_row(*row)
            table.add_section()
    console.print(table)
    report(console, found, bests)


def report(console: Console, found: Findings, bests: list[tuple[Entry, float]]) -> None:
    """Print the counts."""
    closed = sum(b.status == Status.OPTIMAL.value for b, _ in bests)
    console.print(f"certified closed its gap on {closed} of {len(bests)} problems")
    over = [b for b, bound in bests if (b.certificate or 0.0) > bound]
    for b in over:
        console.print(f"certified above Δ by the referee: {b.label}: {b.certificate:.9g}")
    console.print(
        f"plans of others within Δ: {found.num_compared} compared with a closed certified plan, "
        f"{found.num_bounded} with its lower bound; {found.unjudged} miss hard rows, not compared"
    )
    console.print(f"violations: {len(found.violations)}")
    for line in found.violations:
        console.print(f"  {line}")
    for title, lines in (
        ("plans of others above Δ that the referee certifies", found.above_certified),
        ("other plans above Δ", found.above),
    ):
        console.print(f"{title}: {len(lines)} (percent: cost against certified)")
        for line in lines:
            console.print(f"  {line}")


if __name__ == "__main__":
    main()
