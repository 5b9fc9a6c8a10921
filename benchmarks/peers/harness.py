"""Asking peers, each in a process of its own, and having their answers judged."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path

from peers.judge import judge
from peers.protocol import Request
from peers.worker import FAMILIES

__all__ = ["ABSENT", "Row", "ask", "run"]

ABSENT = ("not installed", "too large", "not modeled")
"""Ends without an attempt: such rows count as neither solved nor unsolved."""

_GRACE = 60.0
"""Seconds beyond the cap for imports and the first problem, before a worker is killed."""

_FOLDER = Path(__file__).parents[1]


@dataclass(frozen=True, slots=True)
class Row:
    """One peer on one problem.

    Attributes
    ----------
    family, size, seed, cap, gap
        The problem, as in the request.
    peer : str
        Who.
    status : str
        How it ended: a word of its answer, ``killed``, ``crashed``, or ``invalid`` where its
        controls miss limits or goals.
    cost, certified : float or None
        Of the plan, by the referee.
    bound : float
        The scenario's Δ.
    is_within : bool
        Whether the plan is valid and its certificate at most Δ.
    seconds : float or None
        Wall time around building and solving.
    note : str
        One line.
    versions : dict
        Of the peer's packages.
    cpus : int
        Of the machine.
    """

    family: str
    size: int
    seed: int
    cap: float
    gap: float
    peer: str
    status: str
    bound: float
    cost: float | None = None
    certified: float | None = None
    is_within: bool = False
    seconds: float | None = None
    note: str = ""
    versions: dict[str, str] = field(default_factory=dict)
    cpus: int = field(default_factory=lambda: os.cpu_count() or 1)

    @property
    def is_solved(self) -> bool:
        """Whether there is a plan that keeps all limits and goals."""
        return self.status in {"optimal", "feasible"} and self.cost is not None


def ask(peer: str, request: Request, python: str = sys.executable) -> dict[str, object]:
    """Return a worker's answer; what happens to the worker is part of it."""
    paths = [str(_FOLDER), *filter(None, [os.environ.get("PYTHONPATH")])]
    try:
        done = subprocess.run(
            [python, "-m", "peers.worker", peer],
            input=json.dumps(asdict(request)),
            capture_output=True,
            text=True,
            timeout=request.cap + _GRACE,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
            check=False,
        )
    except OSError as error:
        return {"status": "not installed", "note": f"{python}: {error.strerror}"}
    except subprocess.TimeoutExpired as error:
        return {"status": "killed", "seconds": request.cap, "note": f"after {error.timeout:g} s"}
    if done.returncode == 0:
        try:
            return dict(json.loads(done.stdout))
        except (ValueError, TypeError):
            return {"status": "crashed", "note": "no answer"}
    last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
    # The interpreter given for this peer lacks radmpc itself.
    is_missing = "No module named" in last
    return {"status": "not installed" if is_missing else "crashed", "note": last}


def run(peer: str, request: Request, python: str = sys.executable) -> Row:
    """Ask one peer for one problem, and judge what it says."""
    answer = ask(peer, request, python)
    scenario = FAMILIES[request.family](request.size, request.seed)
    common = {
        **asdict(request),
        "peer": peer,
        "bound": scenario.risk_bound,
        "seconds": answer.get("seconds"),
        "versions": answer.get("versions", {}),
    }
    status, note, controls = answer["status"], answer.get("note", ""), answer.get("controls")
    if controls is None:
        return Row(status=status, note=note, **common)
    verdict = judge(scenario, controls, peer)
    if verdict.problems:
        more = len(verdict.problems) - 1
        note = verdict.problems[0] + (f" (and {more} more)" if more else "")
        status = "invalid"
    return Row(
        status=status,
        note=note,
        cost=verdict.cost,
        certified=verdict.certified,
        is_within=verdict.is_within,
        **common,
    )
