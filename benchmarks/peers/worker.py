"""One peer, one problem, one process: a JSON request on stdin, a JSON answer on stdout.

    echo '{"family": "paper", "size": 2, "seed": 0, "cap": 60, "gap": 0.001}' |
        PYTHONPATH=benchmarks python -m peers.worker ipopt

A process each, because not all solvers can share one: highspy clashes with CasADi's HiGHS plugin
and with OR-Tools. Seconds are wall time around building and solving; imports and a first problem
of one vehicle, which fills the libraries' caches, come before. Whatever solvers print goes to
stderr.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
import time
import traceback
from collections.abc import Callable, Mapping
from importlib.metadata import PackageNotFoundError, version
from types import MappingProxyType

from peers.protocol import Answer, Request
from peers.statement import NotModeledError
from radmpc.experiments.families import circle, fleet, paper
from radmpc.model.scenario import Scenario

__all__ = ["FAMILIES", "PEERS", "respond"]

Solve = Callable[[Scenario, float, float, int], Answer]

PEERS: Mapping[str, str] = MappingProxyType(
    {
        "certified": "peers.with_radmpc:certified",
        "multi-vehicle": "peers.with_radmpc:multi_vehicle",
        "uniform": "peers.with_radmpc:uniform",
        "ipopt": "peers.with_ipopt:solve",
        "cvxpy": "peers.with_cvxpy:solve_highs",
        "cvxpy-scip": "peers.with_cvxpy:solve_scip",
        "gurobi": "peers.with_gurobi:solve",
    }
)
"""Where each peer's function is; ``module:function`` names one that is not listed."""

FAMILIES: Mapping[str, Callable[[int, int], Scenario]] = MappingProxyType(
    {"paper": paper, "fleet": fleet, "circle": lambda size, seed: circle(size)}
)
"""Problems by size and seed, all with avoidance at the steps; `circle` has no seed."""

_WARM_UP = 10.0
"""Seconds that the first problem may take."""


def respond(peer: str, request: Request) -> dict[str, object]:
    """Return the answer to a request, whatever happens."""
    answer, seconds, versions = Answer("failed"), None, {}
    try:
        name, _, function = PEERS.get(peer, peer).partition(":")
        module = importlib.import_module(name)
        solve: Solve = getattr(module, function)
        versions = _versions(getattr(module, "PACKAGES", ()))
        answer, seconds = _timed(solve, request)
    except ModuleNotFoundError as error:
        answer = Answer("not installed", note=f"no module {error.name!r}")
    except NotModeledError as error:
        answer = Answer("not modeled", note=str(error))
    except Exception as error:  # a peer's failure is a row of the table, whatever it is
        traceback.print_exc()
        answer = Answer("failed", note=f"{type(error).__name__}: {error}")
    controls = answer.controls
    return {
        "status": answer.status,
        "controls": None if controls is None else [one.tolist() for one in controls],
        "seconds": seconds,
        "note": answer.note,
        "versions": versions,
    }


def _timed(solve: Solve, request: Request) -> tuple[Answer, float]:
    """Solve one problem, the libraries warm."""
    scenario = FAMILIES[request.family](request.size, request.seed)
    solve(paper(1, 0), min(request.cap, _WARM_UP), request.gap, 0)
    begun = time.perf_counter()
    answer = solve(scenario, request.cap, request.gap, request.seed)
    return answer, time.perf_counter() - begun


def _versions(packages: tuple[str, ...]) -> dict[str, str]:
    """Return the versions of those packages that are installed."""
    found = {}
    for package in packages:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found


def main() -> None:
    """Answer one request."""
    # Solvers print where they like; only the answer may reach stdout.
    with os.fdopen(os.dup(1), "w", encoding="utf-8") as out:
        os.dup2(2, 1)
        json.dump(respond(sys.argv[1], Request(**json.load(sys.stdin))), out)


if __name__ == "__main__":
    main()
