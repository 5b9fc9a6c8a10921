"""Missions under way by several rules of accounting, the wrong ones among them; and tick times.

    python benchmarks/closed_loop.py --missions 75 --scenes slalom
    python benchmarks/closed_loop.py --missions 2000 --planner warm --scenes slalom --jobs 2
        --rules kept plus anew pool paper orca --record slalom.jsonl
    python benchmarks/closed_loop.py --missions 2000 --scenes wall --rules plus anew
    python benchmarks/closed_loop.py --missions 1000 --planner warm --rules plus --scenes circle16

Every rule flies the same noise. Of each: how many missions collide, with the 95 % interval of
Clopper and Pearson; effort as flown, by how much goals are missed, the share of ticks at which a
candidate was adopted, the share of ticks with wealth below 1e-4, and milliseconds of processor that
a tick takes: the median, 99 of 100, 999 of 1,000, and the most.

`kept` flies the first plan to its end, `plus` is the rule of `radmpc.Mission`; `all` lets
candidates cost all of the wealth and begins without a bank; `anew` grants Δ at each tick; `pool`
takes the larger of the tail and of what a pool still holds from which every step's risk was taken;
`paper` plans within that pool alone and flies whatever was found, as the paper's scheme does.
`orca` and `dmpc` keep no account at all (`closed_loops/peers.py`).
`--planner warm` makes candidates by kept linear programs, else `certified` is asked on the spot; on
the scene `wall` an adversary is, who stakes all on the next step (`closed_loops/adversary.py`).

With `--record` every mission is a line of a file, written at once, and the first plan stands beside
it: the same command goes on where it stopped, and others add rules and missions.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import asdict
from itertools import islice
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.special import betaincinv

from closed_loops.peers import PEERS
from closed_loops.rules import RULES, Trial, flown
from closed_loops.scenes import SCENES, first_plan
from radmpc.flying.deciding import opened
from radmpc.model.plan import Plan

QUANTILES = (0.5, 0.99, 0.999, 1.0)

Key = tuple[str, str, int]


def known(record: Path | None, scene: str) -> list[Trial]:
    """Return the missions of a scene that a file holds; a line that was cut does not count."""
    if record is None or not record.exists():
        return []
    found = []
    for line in record.read_text(encoding="utf-8").splitlines():
        try:
            entry = json.loads(line)
        except json.JSONDecodeError:
            continue
        if entry.pop("scene") == scene:
            found.append(Trial(**entry))
    return found


def write(record: Path | None, scene: str, trial: Trial) -> None:
    """Add a mission to a file; one that ends within a line gets a new one."""
    if record is None:
        return
    is_cut = record.exists() and record.read_bytes()[-1:] not in {b"", b"\n"}
    with record.open("a", encoding="utf-8") as file:
        file.write("\n" * is_cut + json.dumps({"scene": scene, **asdict(trial)}) + "\n")


def fly_all(plan: Plan, keys: Sequence[Key], jobs: int) -> Iterator[Trial]:
    """Fly missions, several at once; yield them as they end."""
    if jobs == 1:
        yield from (flown(plan, *key) for key in keys)
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context) as executor:
        rest = iter(keys)
        running: set[Future[Trial]] = set()
        while True:
            more = islice(rest, 2 * jobs - len(running))
            running |= {executor.submit(flown, plan, *key) for key in more}
            if not running:
                return
            done, running = wait(running, return_when=FIRST_COMPLETED)
            yield from (future.result() for future in done)


def interval(hits: int, count: int) -> tuple[float, float]:
    """Return the interval of Clopper and Pearson at 95 %."""
    low = float(betaincinv(hits, count - hits + 1, 0.025)) if hits else 0.0
    high = float(betaincinv(hits + 1, count - hits, 0.975)) if hits < count else 1.0
    return low, high


def row(name: str, trials: Sequence[Trial]) -> list[str]:
    """Return a row of the table."""
    count, hits = len(trials), sum(t.has_collided for t in trials)
    low, high = interval(hits, count)
    ticks = [each for t in trials for each in t.ticks]
    return [
        name,
        f"{count}",
        f"{hits / count:.4f} [{low:.4f}, {high:.4f}]",
        f"{np.mean([t.effort for t in trials]):.2f}",
        f"{np.mean([t.miss for t in trials]):.3f}",
        f"{sum(t.adopted for t in trials) / len(ticks):.2f}",
        f"{sum(t.starved for t in trials) / len(ticks):.3f}",
        " / ".join(f"{np.quantile(ticks, q):.1f}" for q in QUANTILES),
    ]


def table_of(scene: str, plan: Plan, trials: Sequence[Trial]) -> Table:
    """Return the table of a scene, a row for each rule."""
    leg, account = opened(plan, 0)
    bound = plan.scenario.risk_bound
    title = f"{scene}: Δ = {bound:g}, certificate {account.tail:.4f}, effort {leg.plan.cost:.2f}"
    table = Table(title=title)
    heads = ("rule", "missions", "collide", "effort", "miss [m]", "adopted", "starved", "ms / tick")
    for heading in heads:
        table.add_column(heading)
    for rule in (*RULES, *PEERS):
        chosen = [t for t in trials if t.rule == rule]
        if chosen:
            table.add_row(*row(rule, chosen))
    return table


def main() -> None:
    """Fly the missions that are missing and print a table per scene."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--missions", type=int, default=75)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--rules", nargs="+", choices=[*RULES, *PEERS], default=list(RULES))
    parser.add_argument("--planner", choices=("certified", "warm"), default="certified")
    parser.add_argument("--jobs", type=int, default=1, help="missions flown at once")
    parser.add_argument("--record", type=Path, default=None, help="a line per mission, *.jsonl")
    options = parser.parse_args()
    console = Console(width=140)
    for scene in options.scenes:
        plan = first_plan(scene, options.record)
        planner = "staking" if scene == "wall" else options.planner
        trials = [t for t in known(options.record, scene) if t.planner == planner]
        flown_already = {(t.rule, t.planner, t.seed) for t in trials}
        keys = [(rule, planner, s) for s in range(options.missions) for rule in options.rules]
        missing = [key for key in keys if key not in flown_already]
        for trial in fly_all(plan, missing, options.jobs):
            write(options.record, scene, trial)
            trials.append(trial)
        console.print(table_of(scene, plan, trials))


if __name__ == "__main__":
    main()
