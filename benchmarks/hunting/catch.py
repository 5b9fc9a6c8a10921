"""What one scene of the hunt yields: its line in the table, and how findings come into it."""

from __future__ import annotations

import signal
import threading
import time
import traceback
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, fields
from types import FrameType, MappingProxyType
from unittest.mock import patch

__all__ = ["COLUMNS", "KINDS", "Catch", "Notes", "catch_of", "clock", "watched"]

KINDS: Mapping[str, str] = MappingProxyType(
    {
        "error": "an exception, or a call that does not come back",
        "warning": "a Python warning",
        "unsafe": "a rate surely above certificate and saturation",
        "unlike": "two simulations that surely differ",
        "loose": "a certificate above what the plan's simple bounds sum to",
        "infeasible": "certified says infeasible, another has a certified plan",
        "lost": "certified ends without a plan, another has a certified one",
        "dear": "certified's plan dearer than another's certified one by more than its gap",
        "dear_late": "the same, where the time limit cut it off",
        "dear_exact": "dearer than plans whose simple bounds may sum to more than Δ",
        "early": "`limit` although no limit was reached",
        "given_up": "a gap left open although no limit was reached",
        "late": "longer than the time limit by more than a second",
        "late_cpu": "the same by the processor's clock",
        "broken": "certified returned a plan that does not hold",
        "bound": "a lower bound above the cost of a plan that it speaks of",
    }
)
"""What can be wrong with a scene's answers."""


@dataclass(frozen=True, slots=True)
class Catch:
    """One line of the table.

    Attributes
    ----------
    seed, index : int
        Which scene.
    time_limit : float
        Seconds that the certified planner had.
    avoidance, status : str
        As in the scenario, and certified's.
    dimension, vehicles, obstacles, horizon : int
        Size of the scenario.
    bound, cost, lower_bound, certified : float
        Δ, and of the certified planner; nan where there is none.
    seconds : float
        Of the whole scene.
    others : str
        Status, cost and certificate of the other planners.
    kinds : str
        What is wrong, keys of `KINDS` with blanks between.
    notes : str
        What exactly, one line.
    """

    seed: int
    index: int
    time_limit: float
    avoidance: str
    dimension: int
    vehicles: int
    obstacles: int
    horizon: int
    bound: float
    status: str = "none"
    cost: float = float("nan")
    lower_bound: float = float("nan")
    certified: float = float("nan")
    seconds: float = 0.0
    others: str = ""
    kinds: str = ""
    notes: str = ""

    def as_row(self) -> dict[str, str]:
        """Return the line as text."""
        return {
            name: f"{value:.9g}" if isinstance(value, float) else str(value)
            for name, value in asdict(self).items()
        }


COLUMNS = tuple(f.name for f in fields(Catch))


def catch_of(row: Mapping[str, str]) -> Catch:
    """Return what a line of the table stands for."""
    kinds = {"int": int, "float": float, "str": str}
    return Catch(**{f.name: kinds[str(f.type)](row[f.name]) for f in fields(Catch)})


@dataclass(slots=True)
class Notes:
    """What was found so far."""

    kinds: dict[str, None] = field(default_factory=dict)
    texts: list[str] = field(default_factory=list)

    def add(self, kind: str, text: str) -> None:
        """Note a finding."""
        self.kinds[kind] = None
        self.texts.append(f"{kind}: {text}")


class _HangError(Exception):
    """A call that does not come back."""


@contextmanager
def clock(by_processor: bool) -> Iterator[None]:
    """Let time limits and seconds be those of the wall, or of the processor."""
    if not by_processor:
        yield
        return
    with patch("time.monotonic", time.process_time), patch("time.perf_counter", time.process_time):
        yield


@contextmanager
def watched(notes: Notes, name: str, seconds: float) -> Iterator[None]:
    """Note what is raised or warned of, and end what does not end."""
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        try:
            with _alarm(seconds):
                yield
        except Exception as error:
            # Whatever it is, it is what is hunted.
            last = traceback.extract_tb(error.__traceback__)[-1]
            place = f"{last.filename.rsplit('/', 1)[-1]}:{last.name}"
            notes.add("error", f"{name}: {type(error).__name__} at {place}: {error}")
    for text in dict.fromkeys(f"{w.category.__name__}: {w.message}" for w in heard):
        notes.add("warning", f"{name}: {text}")


@contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    """Interrupt what takes longer, where the system can."""

    def ring(number: int, frame: FrameType | None) -> None:
        del number, frame
        raise _HangError(f"not back after {seconds:g} s")

    if not hasattr(signal, "setitimer") or threading.current_thread() != threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
