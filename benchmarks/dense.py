"""Dense fleets and narrow ways: how soon there is a certified plan, and how good it is in the end.

    python benchmarks/dense.py [--time-limit 20] [--only empty mit] [--seeds 3] [--lower]

One row per problem: seconds until the first certified plan and its cost over the best known; then
the cost at the end, its gap by faces and to any certified plan, and the largest memory of this
process so far. Seconds are those of the wall, in brackets of the processor. Best known costs are in
`data/best_known.json`; ``--lower`` writes those that are lower now, and never a higher one.
"""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from radmpc import import_scenario, plan
from radmpc.experiments.families import circle, clutter, fleet, paper
from radmpc.experiments.swarms import swarm
from radmpc.model.scenario import Scenario

INSTANCES = Path(__file__).parent.parent / "instances"
BEST_KNOWN = Path(__file__).parent / "data" / "best_known.json"
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
MEGABYTE = 1024.0
"""Kilobytes, which `resource` counts in."""


@dataclass(frozen=True, slots=True)
class Row:
    """What came of one problem."""

    name: str
    first: tuple[float, float, float] | None
    cost: float | None
    faces: float | None
    on_any: float | None
    seconds: tuple[float, float]
    status: str


def problems(seeds: int) -> Iterator[tuple[str, Callable[[], Scenario]]]:
    """Return names, and what makes the scenarios, those of other groups as they import."""
    for name in IMPORTED:
        yield Path(name).stem, partial(_imported, name)
    for count in (4, 8, 16):
        yield f"circle({count})", partial(circle, count)
    for seed in range(seeds):
        for avoidance in ("steps", "intervals"):
            for count in (2, 4, 10):
                name = f"clutter({count}, 100, {seed}) {avoidance}"
                yield name, partial(_avoiding, avoidance, clutter, count, 100, seed)
            for count in (2, 4, 6, 8):
                name = f"paper({count}, {seed}) {avoidance}"
                yield name, partial(_avoiding, avoidance, paper, count, seed)
        for count in (64, 256):
            yield f"fleet({count}, {seed})", partial(fleet, count, seed)
    yield "fleet(1000, 0)", partial(fleet, 1000, 0)
    yield "swarm(200, 0)", partial(swarm, 200, 0)


def _imported(name: str) -> Scenario:
    """Return another group's problem."""
    return import_scenario(INSTANCES / name).scenario


def _avoiding(avoidance: str, family: Callable[..., Scenario], *numbers: int) -> Scenario:
    """Return a member of a family with collisions counted at steps, or along intervals."""
    return replace(family(*numbers), avoidance=avoidance)


def full_name(name: str, scenario: Scenario) -> str:
    """Return the name under which costs are compared.

    The import chooses a map's steps, and a plan in other steps costs something else.
    """
    return f"{name}, {scenario.horizon} steps" if name.startswith("map_") else name


def planned(name: str, scenario: Scenario, planner: str, time_limit: float) -> Row:
    """Plan one problem, and note when the first plan was found."""
    wall, processor = time.perf_counter(), time.process_time()
    first: list[tuple[float, float, float]] = []

    def found(cost: float, bound: float | None) -> None:
        del bound
        if not first:
            first.append((time.perf_counter() - wall, time.process_time() - processor, cost))

    result = plan(scenario, planner, time_limit=time_limit, rng=0, found=found)
    seconds = time.perf_counter() - wall, time.process_time() - processor
    if result.cost is not None and not result.is_certified:
        raise SystemExit(f"{name}: a plan that is not certified")
    return Row(
        name,
        first[0] if first else None,
        result.cost,
        result.lower_bound,
        result.certified_lower_bound,
        seconds,
        result.status.value,
    )


def told(row: Row, best: float | None) -> str:
    """Return a row of the table."""
    spent = f"{row.seconds[0]:7.2f} ({row.seconds[1]:6.2f})"
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / MEGABYTE
    if row.cost is None:
        return f"{row.name:40} {row.status:>46} {spent} {memory:6.0f}"
    seconds, work, cost = row.first or (*row.seconds, row.cost)
    ratio = f"{cost / best:6.3f}" if best else "      "
    gaps = [
        "     -" if bound is None else f"{100.0 * max(row.cost - bound, 0.0) / row.cost:6.2f}"
        for bound in (row.faces, row.on_any)
    ]
    return (
        f"{row.name:40} {seconds:7.2f} ({work:6.2f}) {ratio} {row.cost:10.3f} {' '.join(gaps)} "
        f"{spent} {memory:6.0f}"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--time-limit", type=float, default=20.0)
    parser.add_argument("--only", nargs="*", default=[], help="parts of names")
    parser.add_argument("--seeds", type=int, default=1, help="draws of every family")
    parser.add_argument("--planner", default="certified", help="as in 'certified(60)'")
    parser.add_argument("--lower", action="store_true", help="write best known costs that fell")
    options = parser.parse_args()
    chosen = [
        (name, make)
        for name, make in problems(options.seeds)
        if not options.only or any(part in name for part in options.only)
    ]
    if not chosen:
        parser.error(f"no problem has {' or '.join(map(repr, options.only))} in its name")
    best: dict[str, float] = json.loads(BEST_KNOWN.read_text()) if BEST_KNOWN.exists() else {}
    print(
        f"{'problem':40} {'first s (cpu)':>16} {'/best':>6} {'cost':>10} {'faces%':>6} "
        f"{'any %':>6} {'all s (cpu)':>16} {'MB':>6}"
    )
    ratios = []
    for part, make in chosen:
        scenario = make()
        name = full_name(part, scenario)
        row = planned(name, scenario, options.planner, options.time_limit)
        print(told(row, best.get(name)), flush=True)
        if row.cost is None:
            continue
        if row.cost < best.get(name, float("inf")):
            best[name] = round(row.cost, 6)
        if row.first is not None:
            ratios.append(row.first[2] / best[name])
        if options.lower:
            BEST_KNOWN.write_text(json.dumps(dict(sorted(best.items())), indent=1) + "\n")
    if ratios:
        print(
            f"first plan over best known: median {statistics.median(ratios):.3f}, "
            f"largest {max(ratios):.3f}"
        )


if __name__ == "__main__":
    main()
