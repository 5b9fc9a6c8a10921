"""The command line of the hunt: plans flown, verified and drawn as a user would, and refusals."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

import radmpc
from hunting.catch import Notes
from radmpc.model.plan import Plan

__all__ = ["KEYS", "check_console"]

_SECONDS = 120.0
"""That a command may take."""

KEYS = frozenset(
    [
        "scenario",
        "with",
        "replan",
        "seed",
        "deadline",
        "missions",
        "missions_asked",
        "holds",
        "rate",
        "rate_low",
        "rate_high",
        "bound",
        "certified",
        "effort",
        "effort_planned",
        "miss",
        "saturation",
        "accepted",
        "adopted",
        "alarms",
        "ticks",
        "tick_p50",
        "tick_p99",
        "tick_max",
        "late",
        "cut_off",
    ]
)
"""Of `radmpc fly --json`, docs/formats.md."""

_REFUSED = (
    ("--with", "balloon"),
    ("--replan", "nobody"),
    ("--missions", "0"),
    ("--deadline", "-1"),
    ("--deadline", "nan"),
    ("--deadline", "inf"),
    ("--seed", "-1"),
    ("--seed", "1.5"),
    ("--option", "wind"),
    ("--option", "wind=3"),
    ("--log", "flight.txt"),
    ("--film", "flight.png"),
    ("-o", "no/such/folder/a.jsonl"),
)
"""Options that are refused."""


def check_console(plan: Plan, folder: Path, rng: np.random.Generator, notes: Notes) -> None:
    """Fly a plan from the command line.

    Parameters
    ----------
    plan : Plan
        What is flown.
    folder : Path
        For files.
    rng : Generator
        Decides everything.
    notes : Notes
        Gets what is wrong.
    """
    source, flight = folder / "a.plan.json", folder / "a.flight.jsonl"
    radmpc.save_plan(plan, source)
    replan = str(rng.choice(["none", "certified", "ira"]))
    options = ["--replan", replan, "--missions", "2", "--deadline", "0.3"]
    code, told, _ = _run(notes, "fly", str(source), "-o", str(flight), "--json", *options)
    content = _object(notes, "fly", told)
    if content is not None:
        if set(content) != KEYS:
            notes.add("console", f"fly --json: keys {sorted(set(content) ^ KEYS)}")
        if code != (0 if content.get("holds") else 1):
            notes.add("console", f"fly: exit code {code} with holds {content.get('holds')}")
    code, told, _ = _run(notes, "verify", str(flight), "--json")
    content = _object(notes, "verify", told)
    if content is not None and (code or not content["holds"]):
        notes.add("console", f"verify: exit code {code}: {content.get('problems')}")
    ending = str(rng.choice(["png", "svg"]))
    picture = folder / f"a.{ending}"
    code, _, _ = _run(notes, "draw", str(flight), "-o", str(picture))
    if code or not picture.exists():
        notes.add("console", f"draw: exit code {code}")
    code, _, _ = _run(notes, "fly", str(flight))  # it is over: nothing to go on with
    if code not in {0, 1}:
        notes.add("console", f"fly of a flight that is over: exit code {code}")
    option = _REFUSED[int(rng.integers(len(_REFUSED)))]
    _refuse(notes, folder, "fly", str(source), *option)
    _refuse(notes, folder, "fly", str(flight), "--seed", "3")
    broken = folder / "broken.plan.json"
    text = source.read_text(encoding="utf-8")
    broken.write_text(text[: int(rng.integers(len(text)))], encoding="utf-8")
    _refuse(notes, folder, "fly", str(broken))


def _run(notes: Notes, *words: str) -> tuple[int, str, str]:
    """Run a command; note what no command may do."""
    command = [sys.executable, "-W", "error::RuntimeWarning", "-m", "radmpc", *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=_SECONDS, check=False)
    name = " ".join(words)
    if done.returncode not in {0, 1, 2}:
        notes.add("console", f"{name}: exit code {done.returncode}: {done.stderr[-300:]}")
    if "Traceback" in done.stderr or "Warning" in done.stderr:
        notes.add("console", f"{name}: {done.stderr[-300:]}")
    return done.returncode, done.stdout, done.stderr


def _refuse(notes: Notes, folder: Path, *words: str) -> None:
    """Run a command that has to be refused in one line."""
    before = sorted(folder.iterdir())
    code, told, why = _run(notes, *words)
    lines = [line for line in why.splitlines() if line.strip()]
    if code != 2 or told or len(lines) != 1:
        notes.add(
            "console", f"{' '.join(words)}: exit code {code}, {lines[:3]}, stdout {told[:80]!r}"
        )
    if sorted(folder.iterdir()) != before:
        notes.add("console", f"{' '.join(words)}: left something behind")


def _object(notes: Notes, name: str, told: str) -> dict[str, object] | None:
    """Return the object that a command printed."""
    try:
        content = json.loads(
            told, parse_constant=lambda word: notes.add("console", f"{name}: {word}")
        )
    except ValueError:
        notes.add("console", f"{name} --json printed {told[:80]!r}")
        return None
    return content if isinstance(content, dict) else None
