"""Ten thousand decisions under a deadline: how long they take, and what late ones come to.

    python benchmarks/closed_loop_ticks.py --vehicles 16 --ticks 10000 --record ticks.jsonl

Missions on the family `circle`, candidates by kept linear programs, each decision with a deadline.
A decision that takes longer than that is a miss, and is counted; what is flown then must be the
tail, and whether it was is counted, too. Every tick is a line of the record, and the same command
goes on where it stopped. `--clock processor` measures seconds of the processor, for machines that
are shared, `wall` those that pass. The answers: ticks, misses, misses at which something else than
the tail was flown, candidates given up as too late, and how long ticks take: the median, 99 of 100,
999 of 1,000, and the most.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from radmpc.experiments.families import circle
from radmpc.flying.flight import fly
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.tick import Tick
from radmpc.io.native.plan_file import load_plan, save_plan
from radmpc.model.plan import Plan
from radmpc.planning import plan

__all__ = ["Row", "answers", "known", "rows_of"]

CLOCKS = {"processor": time.process_time, "wall": time.monotonic}

LATE = "the candidate came too late"
"""What `radmpc.Mission` says of a candidate that is given up."""

QUANTILES = (0.5, 0.99, 0.999, 1.0)


@dataclass(frozen=True)
class Row:
    """A decision: its mission and step, what is flown and why, and the seconds it took."""

    mission: int
    step: int
    choice: str
    reason: str
    seconds: float


def rows_of(first: Plan, mission: int, deadline: float, clock: str) -> list[Row]:
    """Fly a mission in noise of its own; return all decisions that had anything to decide."""
    flown = Mission(first, planner=None, warm=True, clock=CLOCKS[clock])
    flight = fly(flown, Model(first.scenario, mission), deadline=deadline)
    return [_row(mission, tick) for tick in flight.ticks if tick.segments]


def _row(mission: int, tick: Tick) -> Row:
    """Return a decision as it is written down."""
    return Row(mission, tick.step, tick.choice, tick.reason, tick.seconds)


def known(record: Path, horizon: int) -> list[Row]:
    """Return the decisions of all whole missions that a record holds."""
    if not record.exists():
        return []
    missions: dict[int, list[Row]] = {}
    for line in record.read_text(encoding="utf-8").splitlines():
        try:
            row = Row(**json.loads(line))
        except json.JSONDecodeError:  # cut
            continue
        missions.setdefault(row.mission, []).append(row)
    return [row for rows in missions.values() if len(rows) == horizon for row in rows]


def answers(rows: list[Row], deadline: float) -> Iterator[str]:
    """Yield what the decisions come to, line by line."""
    missed = [row for row in rows if row.seconds > deadline]
    seconds = [row.seconds for row in rows]
    yield f"ticks {len(rows)}, within {1e3 * deadline:g} ms: {1.0 - len(missed) / len(rows):.5f}"
    yield f"misses {len(missed)}, of which not the tail: {sum(m.choice != 'tail' for m in missed)}"
    yield f"given up as too late: {sum(row.reason == LATE for row in rows)}"
    yield f"candidates adopted: {np.mean([row.choice == 'candidate' for row in rows]):.3f}"
    took = " / ".join(f"{1e3 * np.quantile(seconds, q):.1f}" for q in QUANTILES)
    yield f"ms of a tick: {took}"


def main() -> None:
    """Fly the missions that are missing, and print the answers."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--vehicles", type=int, default=16)
    parser.add_argument("--ticks", type=int, default=10_000)
    parser.add_argument("--deadline", type=float, default=0.15, help="of a decision [s]")
    parser.add_argument("--clock", choices=CLOCKS, default="processor")
    parser.add_argument("--record", type=Path, required=True, help="a line per tick, *.jsonl")
    options = parser.parse_args()
    kept = options.record.with_suffix(".plan.json")
    if not kept.exists():
        save_plan(plan(circle(options.vehicles), rng=0, time_limit=60.0).plan, kept)
    first = load_plan(kept)
    rows = known(options.record, first.scenario.horizon)
    options.record.write_text("".join(_line(row) for row in rows), encoding="utf-8")
    mission = 1 + max((row.mission for row in rows), default=-1)
    while len(rows) < options.ticks:
        more = rows_of(first, mission, options.deadline, options.clock)
        with options.record.open("a", encoding="utf-8") as file:
            file.writelines(_line(row) for row in more)
        rows, mission = rows + more, mission + 1
    print("\n".join(answers(rows[: options.ticks], options.deadline)))


def _line(row: Row) -> str:
    """Return a line of the record."""
    return json.dumps(asdict(row)) + "\n"


if __name__ == "__main__":
    main()
