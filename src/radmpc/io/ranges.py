"""Formats of files, and how many parts they may have."""

from __future__ import annotations

from radmpc.errors import ScenarioError

__all__ = [
    "FLIGHT_FORMAT",
    "MOST_OBSTACLES",
    "MOST_VEHICLES",
    "PLAN_FORMAT",
    "SCENARIO_FORMAT",
    "check_count",
]

SCENARIO_FORMAT = "radmpc/scenario/1"
"""What a scenario file says it is."""

PLAN_FORMAT = "radmpc/plan/1"
"""The same of a plan file."""

FLIGHT_FORMAT = "radmpc/flight/1"
"""The same of a flight file."""

MOST_VEHICLES = 10_000
"""Vehicles that a scenario file may have: a slip of the hand should not fill the memory."""

MOST_OBSTACLES = 10_000
"""The same of obstacles."""


def check_count(count: int, most: int, path: tuple[str | int, ...]) -> None:
    """Refuse more of something than a scenario file may have.

    Parameters
    ----------
    count : int
        How many there are.
    most : int
        How many are allowed.
    path : tuple of str or int
        Where they stand.

    Raises
    ------
    ScenarioError
        With how many there are and how many are allowed.
    """
    if count > most:
        raise ScenarioError(f"must be at most {most:,}, got {count:,}", path)
