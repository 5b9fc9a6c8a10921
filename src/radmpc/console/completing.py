"""What the shell completes: planners, formats, and files by what they end in.

Loads no more of the package than names: the user waits for it at every press of the key.
"""

from __future__ import annotations

from pathlib import Path

from radmpc.data import TEMPLATES

__all__ = [
    "BACKENDS",
    "FORMATS",
    "LOGS",
    "PLANNERS",
    "VIEWS",
    "complete_backend",
    "complete_drawn",
    "complete_format",
    "complete_log",
    "complete_plan",
    "complete_plan_or_flight",
    "complete_planner",
    "complete_planners",
    "complete_replan",
    "complete_scenario",
    "complete_template",
    "complete_view",
]

PLANNERS = (
    "milp",
    "dlp",
    "rmpc",
    "dmpc",
    "uniform",
    "ira",
    "distance",
    "radmpc",
    "multi-vehicle",
    "rmpc-rrt",
    "certified",
)
"""Names of the presets."""

FORMATS = ("qgc", "waypoints", "geojson", "kml", "mcap", "csv")
"""Names of the formats of exports."""

BACKENDS = ("model", "rotorpy", "irsim", "boat", "mavlink")
"""Names of what plans can be flown with."""

LOGS = (".csv", ".tsv", ".txt", ".mcap", ".ulg", ".db3")
"""Endings of logs."""

VIEWS = ("plan", "ledger", "couplings", "distances", "risk")
"""What there is to see of a plan, beside films."""


def complete_planner(incomplete: str) -> list[str]:
    """Return the planners that begin like the word."""
    return [name for name in PLANNERS if name.startswith(incomplete)]


def complete_replan(incomplete: str) -> list[str]:
    """Return the planners that begin like the word, and the word for none."""
    return complete_planner(incomplete) + [n for n in ("none",) if n.startswith(incomplete)]


def complete_backend(incomplete: str) -> list[str]:
    """Return the backends that begin like the word."""
    return [name for name in BACKENDS if name.startswith(incomplete)]


def complete_planners(incomplete: str) -> list[str]:
    """Return the same for the last name of a list with commas."""
    before, comma, last = incomplete.rpartition(",")
    named = before.split(",")
    return [f"{before}{comma}{name}" for name in complete_planner(last) if name not in named]


def complete_format(incomplete: str) -> list[str]:
    """Return the formats of exports that begin like the word."""
    return [name for name in FORMATS if name.startswith(incomplete)]


def complete_template(incomplete: str) -> list[str]:
    """Return the templates that begin like the word."""
    return [name for name in TEMPLATES if name.startswith(incomplete)]


def complete_view(incomplete: str) -> list[str]:
    """Return the views of plans that begin like the word."""
    return [name for name in VIEWS if name.startswith(incomplete)]


def complete_drawn(incomplete: str) -> list[str]:
    """Return the files that may be a scenario, a plan or a flight."""
    return _files(incomplete, (".yaml", ".yml", ".json", ".jsonl"))


def complete_scenario(incomplete: str) -> list[str]:
    """Return the files that may be scenarios; plans are none."""
    found = _files(incomplete, (".yaml", ".yml", ".json"))
    return [name for name in found if not name.endswith(".plan.json")]


def complete_log(incomplete: str) -> list[str]:
    """Return the files that may be logs; bags are folders."""
    return _files(incomplete, LOGS)


def complete_plan(incomplete: str) -> list[str]:
    """Return the files that may be plans."""
    return _files(incomplete, (".json",))


def complete_plan_or_flight(incomplete: str) -> list[str]:
    """Return the files that may be a plan or a flight."""
    return _files(incomplete, (".json", ".jsonl"))


def _files(incomplete: str, suffixes: tuple[str, ...]) -> list[str]:
    """Return files by their ends, and the folders on the way to them."""
    folder, slash, begin = incomplete.rpartition("/")
    try:
        entries = sorted(Path(f"{folder}{slash}" or ".").expanduser().iterdir())
    except OSError:
        return []
    entries = [e for e in entries if e.name.startswith(begin) and (begin or e.name[0] != ".")]
    found = [f"{folder}{slash}{e.name}" for e in entries if e.name.endswith(suffixes)]
    folders = [f"{folder}{slash}{e.name}/" for e in entries if e.is_dir()]
    if not found and len(folders) == 1:
        # Shells put a space behind the only answer: go on into the folder instead.
        return _files(folders[0], suffixes)
    return found + folders
