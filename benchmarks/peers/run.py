"""What one would use instead of radmpc, on the same scenarios and before the same referee.

    python benchmarks/peers/run.py 2 3 4 --seeds 3 --cap 60
    python benchmarks/peers/run.py 2 --peers certified ipopt --python ipopt=/opt/casadi/bin/python
    python benchmarks/peers/run.py 4 6 --family circle --seeds 1 --out peers.jsonl

Every peer is a model of its own, written from docs/problem.md: a nonlinear program (`ipopt`) and
big-M programs (`cvxpy`, `cvxpy-scip`, `gurobi`), all at uniform risk. `certified`,
`multi-vehicle` and `uniform` are radmpc's. Each runs in a process of its own; a peer that is not
installed (benchmarks/peers/requirements.txt), or whose license does not allow the size, is a row
that says so. ``module:function`` is a peer of your own, called as ``(scenario, seconds, gap,
seed)``.

Controls are all that counts: they are rolled out and judged by radmpc's referee. `within Δ` says
that limits and goals are kept and the certificate is at most the bound. Seconds are wall time
around building and solving, imports and a first problem of one vehicle before. radmpc's include
its own certificate.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from dataclasses import asdict
from pathlib import Path

from rich.console import Console

# The package lies beside the other benchmarks, not in this folder.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from peers.harness import Row, run
from peers.protocol import Request
from peers.tables import REFERENCE, cells_of, row_table, summary_table
from peers.worker import FAMILIES, PEERS
from radmpc.version import __version__


def pythons_of(options: list[str]) -> dict[str, str]:
    """Return the interpreter of each peer that has one of its own.

    Raises
    ------
    ValueError
        If an option is not ``NAME=PATH``.
    """
    found = {}
    for option in options:
        name, sign, path = option.partition("=")
        if not (name and sign and path):
            raise ValueError(f"--python takes NAME=PATH, got {option!r}")
        found[name] = path
    return found


def parsed(arguments: list[str] | None) -> argparse.Namespace:
    """Return the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("sizes", type=int, nargs="+", help="fleet sizes N")
    parser.add_argument("--seeds", type=int, default=3, help="problems per size")
    parser.add_argument("--cap", type=float, default=60.0, help="seconds per problem and peer")
    parser.add_argument("--gap", type=float, default=1e-3, help="where a proof may stop")
    parser.add_argument("--family", choices=tuple(FAMILIES), default="paper")
    parser.add_argument("--peers", nargs="+", default=list(PEERS), metavar="PEER")
    parser.add_argument(
        "--python", action="append", default=[], metavar="NAME=PATH", help="a peer's interpreter"
    )
    parser.add_argument("--out", type=Path, help="one JSON object per row is appended here")
    options = parser.parse_args(arguments)
    unknown = [p for p in options.peers if p not in PEERS and ":" not in p]
    if unknown:
        parser.error(f"peers are {', '.join(PEERS)} or module:function, got {unknown[0]!r}")
    try:
        options.python = pythons_of(options.python)
    except ValueError as error:
        parser.error(str(error))
    return options


def main(arguments: list[str] | None = None) -> None:
    """Ask everyone, and print."""
    options = parsed(arguments)
    console, aside = Console(file=sys.stdout, width=150), Console(stderr=True, width=150)
    rows: list[Row] = []
    for size in options.sizes:
        for seed in range(options.seeds):
            request = Request(options.family, size, seed, options.cap, options.gap)
            reference = None
            for peer in options.peers:
                row = run(peer, request, options.python.get(peer, sys.executable))
                rows.append(row)
                if peer == REFERENCE and row.is_within:
                    reference = row
                # A long run is seen to go on, and leaves its rows if it is stopped.
                aside.print(" ".join(cells_of(row, reference)), highlight=False, markup=False)
                if options.out is not None:
                    with options.out.open("a", encoding="utf-8") as file:
                        file.write(json.dumps(asdict(row)) + "\n")
    console.print(row_table(rows))
    console.print(summary_table(rows))
    versions = {k: v for row in rows for k, v in row.versions.items()}
    told = ", ".join(f"{name} {versions[name]}" for name in sorted(versions))
    console.print(f"{options.family}, radmpc {__version__}; {told}; {os.cpu_count()} CPUs")
    console.print("cost ratio: geometric mean against certified, where both are within Δ")


if __name__ == "__main__":
    main()
