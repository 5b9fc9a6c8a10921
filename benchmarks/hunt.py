"""A hunt for wrong answers: small nasty scenes, planned in several ways, flown and compared.

Run ``python benchmarks/hunt.py --scenes 10000 --seed 0 --jobs 2 --out hunt.csv``. Each scene is a
line of the table, written and synced at once; the same command goes on where an interrupted one
stopped, and prints how often each kind of wrong answer was met, and where. ``--clock processor``
counts the processor's seconds instead of the wall's, so that other jobs change no answer;
``--norms`` limits norms of controls and speeds in place of their axes.
``--scenes 0`` reports on what there is. ``--index 17`` plays one scene again, tells what every
planner says, and with ``--save scene.json`` writes it as a scenario file.
"""

from __future__ import annotations

import argparse
import itertools
import logging
import multiprocessing
import sys
from collections import Counter
from collections.abc import Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import closing
from pathlib import Path

from hunting.answers import Effort
from hunting.catch import COLUMNS, KINDS, Catch, catch_of
from hunting.checks import examine, run_scene, scene_of
from hunting.record_table import add_row, rows_of
from radmpc.io.native.scenario_file import save_scenario

_MOST_NAMED = 40
"""Scenes named per kind in the summary."""


def main() -> None:
    """Play one scene, or all that are missing, and print what was caught."""
    options = _options()
    effort = Effort(
        options.time_limit,
        options.time_limit / 2.0,
        options.samples,
        by_processor=options.clock == "processor",
        has_norms=options.norms,
    )
    if options.index is not None:
        _replay(options, effort)
        return
    if options.out is None:
        sys.exit("--out is needed: the table of scenes, CSV")
    catches = _known(options.out, options.seed, options.time_limit)
    done = {catch.index for catch in catches}
    missing = [i for i in range(options.scenes) if i not in done]
    is_terminal = sys.stderr.isatty()
    with closing(_run(missing, options.jobs, options.seed, effort)) as running:
        for catch in running:
            add_row(options.out, COLUMNS, catch.as_row())
            catches.append(catch)
            if is_terminal:
                text = f"\r{len(catches)}/{options.scenes} scenes"
                print(text, end="", file=sys.stderr, flush=True)
    if is_terminal:
        print(file=sys.stderr)
    print("\n".join(summary(sorted(catches, key=lambda catch: catch.index))))


def _options() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=1000, help="scenes in all")
    parser.add_argument("--seed", type=int, default=0, help="of everything random")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--time-limit", type=float, default=4.0, help="seconds; half for others")
    parser.add_argument("--samples", type=int, default=20_000, help="flights per plan")
    parser.add_argument("--out", type=Path, help="table of scenes, CSV")
    parser.add_argument(
        "--clock", choices=("wall", "processor"), default="wall", help="whose seconds count"
    )
    parser.add_argument("--norms", action="store_true", help="limit norms, not axes")
    parser.add_argument("--index", type=int, help="play this scene alone")
    parser.add_argument("--save", type=Path, help="scenario file for it")
    return parser.parse_args()


def _replay(options: argparse.Namespace, effort: Effort) -> None:
    """Play one scene and tell everything."""
    scenario = scene_of(options.seed, options.index, effort)
    if options.save is not None:
        save_scenario(scenario, options.save)
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    catch = examine(scenario, options.seed, options.index, effort)
    for name, text in catch.as_row().items():
        for line in text.split(" | "):
            print(f"{name:>12}  {line}")


def _known(path: Path, seed: int, time_limit: float) -> list[Catch]:
    """Return the scenes of an earlier run."""
    catches = [catch_of(row) for row in rows_of(path)]
    if any((catch.seed, catch.time_limit) != (seed, time_limit) for catch in catches):
        sys.exit(f"{path}: was made with another seed or time limit")
    return catches


def _run(
    indices: Sequence[int], jobs: int, seed: int, effort: Effort
) -> Generator[Catch, None, None]:
    """Yield one scene after the other, here or from processes."""
    if jobs == 1:
        for index in indices:
            yield run_scene(seed, index, effort)
        return
    left = iter(indices)
    context = multiprocessing.get_context("spawn")  # threads and forks do not go together
    with ProcessPoolExecutor(jobs, context) as executor:
        running: set[Future[Catch]] = set()
        try:
            while True:
                for index in itertools.islice(left, 2 * jobs - len(running)):
                    running.add(executor.submit(run_scene, seed, index, effort))
                if not running:
                    return
                done, running = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    yield future.result()
        finally:
            # An interrupt may leave a worker asleep for good; what it flies is flown again.
            for worker in multiprocessing.active_children():
                worker.terminate()


def summary(catches: Sequence[Catch]) -> list[str]:
    """Return the lines of the summary: what was hunted, and each kind of catch with its scenes."""
    if not catches:
        return ["no scenes yet"]
    states = Counter(catch.status for catch in catches)
    told = ", ".join(f"{count} {status}" for status, count in sorted(states.items()))
    lines = [f"{len(catches)} scenes, seed {catches[0].seed}; certified: {told}", ""]
    for kind, meaning in KINDS.items():
        found = [catch.index for catch in catches if kind in catch.kinds.split()]
        named = ", ".join(str(index) for index in found[:_MOST_NAMED])
        more = f" and {len(found) - _MOST_NAMED} more" if len(found) > _MOST_NAMED else ""
        lines.append(
            f"- **{kind}** {len(found)} ({meaning})" + (f": {named}{more}" if found else "")
        )
    return lines


if __name__ == "__main__":
    main()
