"""Is the certificate right, and how tight is it: random plans against Monte Carlo.

Run ``python benchmarks/calibration.py --plans 1000 --out calibration.csv``. Random scenarios are
planned by random planners, good and bad, certified and flown. Each trial is a line of the table,
written and synced at once; the same command goes on where an interrupted one stopped, and prints
the report once there are as many plans as asked for. ``--plans 0`` reports on what there is, and
``--recheck 10`` flies the ten plans that look worst a hundred times as often. ``--noise`` adds
currents, gusts, receivers and freighters, and flies every plan in that world without the referee.
``--clock processor`` counts the processor's seconds instead of the wall's, as other jobs stretch.
"""

from __future__ import annotations

import argparse
import itertools
import multiprocessing
import sys
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import closing
from functools import partial
from pathlib import Path

from calibrating.report import doubtful, report, second_look
from calibrating.trial import COLUMNS, Trial, run_trial, trial_of
from hunting.record_table import add_row, rows_of

_MORE = 100


def main() -> None:
    """Run the trials that are missing and print the report."""
    options = _options()
    trials = _known(options.out, options.seed, options.samples, noise=options.noise)
    missing = (i for i in itertools.count() if i not in {trial.index for trial in trials})
    num_plans = sum(trial.has_plan for trial in trials)
    is_terminal = sys.stderr.isatty()
    how = partial(
        run_trial,
        time_limit=options.time_limit,
        noise=options.noise,
        by_processor=options.clock == "processor",
    )
    trial_at = partial(how, options.seed, samples=options.samples)
    with closing(_run(missing, options.jobs, trial_at)) as running:
        while num_plans < options.plans:
            trial = next(running)
            add_row(options.out, COLUMNS, trial.as_row())
            trials.append(trial)
            num_plans += trial.has_plan
            if is_terminal:
                print(f"\r{num_plans}/{options.plans} plans", end="", file=sys.stderr, flush=True)
    if is_terminal:
        print(file=sys.stderr)
    print("\n".join(report(sorted(trials, key=lambda trial: trial.index))))
    again = [
        how(trial.seed, trial.index, samples=_MORE * trial.samples)
        for trial in doubtful(trials)[: options.recheck]
    ]
    if again:
        print("\n".join(["", *second_look(again)]))


def _options() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plans", type=int, default=1000, help="plans to collect in all")
    parser.add_argument("--samples", type=int, default=20_000, help="flights per plan")
    parser.add_argument("--seed", type=int, default=0, help="of everything random")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--time-limit", type=float, default=1.0, help="seconds per plan")
    parser.add_argument(
        "--clock", choices=("wall", "processor"), default="wall", help="whose seconds count"
    )
    parser.add_argument("--noise", action="store_true", help="the world as it is measured")
    parser.add_argument("--recheck", type=int, default=0, help="doubtful plans to fly longer")
    parser.add_argument("--out", type=Path, required=True, help="table of trials, CSV")
    return parser.parse_args()


def _known(path: Path, seed: int, samples: int, *, noise: bool = False) -> list[Trial]:
    """Return the trials of an earlier run."""
    trials = [trial_of(row) for row in rows_of(path)]
    for trial in trials:
        if (trial.seed, trial.samples) != (seed, samples):
            made = f"--seed {trial.seed} --samples {trial.samples}"
            sys.exit(f"{path}: was made with {made}, not with --seed {seed} --samples {samples}")
    if any(bool(trial.noise) != noise for trial in trials):
        sys.exit(f"{path}: was made {'without' if noise else 'with'} --noise")
    return trials


def _run(
    indices: Iterator[int], jobs: int, trial_at: Callable[[int], Trial]
) -> Generator[Trial, None, None]:
    """Yield one trial after the other, here or from processes."""
    if jobs == 1:
        for index in indices:
            yield trial_at(index)
        return
    context = multiprocessing.get_context("spawn")  # threads and forks do not go together
    with ProcessPoolExecutor(jobs, context) as executor:
        running: set[Future[Trial]] = set()
        while True:
            for index in itertools.islice(indices, 2 * jobs - len(running)):
                running.add(executor.submit(trial_at, index))
            done, running = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()


if __name__ == "__main__":
    main()
