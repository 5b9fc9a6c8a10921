"""The numbers that the search for reasons was tuned with, in one record."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from radmpc.records import dataclass, field

__all__ = ["TUNING", "Tuning"]


@dataclass(frozen=True, slots=True)
class Tuning:
    """How long a plan, reasons and cures are looked for where the search found no plan.

    A value that was measured names the scenes; of the others no measurement is recorded.

    Attributes
    ----------
    face_trials : tuple of float
        Time to find out whether more faces give a plan where there is none, first and again [s].
    faces : mapping of int to tuple of int
        Numbers of faces around pairs that are tried, by dimension [-].
    seconds : float
        Time for all trials of one kind [s]: each takes 0.1 s for a vehicle among a few obstacles.
    trial_seconds : float
        Most that a single trial may take of it [s].
    weights : tuple of float
        Weights R of the control tried for feedback, with Q = 1 [-]: a softer gain each.
    most_times : int
        Multiple of the horizon up to which the least time is sought [-].
    quieter : tuple of float
        Factors of the noise's standard deviations tried [-].
    max_conflicts : int
        Groups of stuck vehicles that are looked for, at most [-]: each takes a search.
    cured : int
        Groups of vehicles for which cures are tried [-]; more would take too long.
    quick_seconds : float
        Time to look at what the others could do where some are ruled out at first sight [s].
    tolerance : float
        Share of the risk bound to which the least risk is sought [-].
    efforts : tuple of int
        Multiples of the nodes of a round that are tried one after the other [-].
    nodes : int
        Nodes per vehicle to find out whether there is a plan once one thing is left out [-].
    """

    face_trials: tuple[float, ...] = (1.5, 15.0)
    faces: Mapping[int, tuple[int, ...]] = field(
        default_factory=lambda: MappingProxyType({2: (8, 16, 32), 3: (14, 26)})
    )
    seconds: float = 2.0
    trial_seconds: float = 1.2
    weights: tuple[float, ...] = (1.0, 10.0, 100.0, 1e3, 1e4, 1e5)
    most_times: int = 8
    quieter: tuple[float, ...] = (0.5, 0.25, 0.1, 0.03)
    max_conflicts: int = 8
    cured: int = 2
    quick_seconds: float = 0.4
    tolerance: float = 0.02
    efforts: tuple[int, ...] = (1, 4, 16)
    nodes: int = 400


TUNING = Tuning()
"""The values in use."""
