"""How large quantities in files may be, so that arithmetic on them stays finite and ends."""

from __future__ import annotations

from radmpc.arguments import field_number
from radmpc.errors import ScenarioError

__all__ = [
    "FLIGHT_FORMAT",
    "MOST_OBSTACLES",
    "MOST_VEHICLES",
    "PLAN_FORMAT",
    "SCENARIO_FORMAT",
    "check_count",
    "check_range",
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

_LEAST, _MOST = 1e-6, 1e6


def check_range(value: float, unit: str, path: tuple[str | int, ...]) -> None:
    """Refuse what no vehicle has: sizes, speeds and times below 1e-6 or above 1e6.

    Parameters
    ----------
    value : float
        What was given.
    unit : str
        Its unit, for the message.
    path : tuple of str or int
        Where it stands.

    Raises
    ------
    ScenarioError
        With the unit and what is allowed.
    """
    value = field_number(value, path)
    if not value > 0.0:
        raise ScenarioError(f"must be > 0 {unit}, got {value}", path)
    if not _LEAST <= value <= _MOST:
        raise ScenarioError(f"must lie between {_LEAST:g} and {_MOST:g} {unit}, got {value}", path)


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
