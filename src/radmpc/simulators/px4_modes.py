"""Flight modes of PX4: their numbers in MAVLink messages, and their names."""

from __future__ import annotations

__all__ = ["MODES", "OFFBOARD", "PX4", "mode_text"]

PX4 = 12
"""MAV_AUTOPILOT_PX4 [-]."""

MODES = {"offboard": (6, 0), "hold": (4, 3)}
"""PX4's main and sub modes [-]."""

OFFBOARD = MODES["offboard"][0]
"""Main mode [-]."""

_NAMES = {
    1: "manual",
    2: "altitude control",
    3: "position control",
    5: "acro",
    7: "stabilized",
}
_AUTO, _AUTO_NAMES = 4, {2: "takeoff", 3: "hold", 4: "mission", 5: "return", 6: "land"}
"""Of main modes, and of the sub modes of one, for messages."""


def mode_text(main: int, sub: int) -> str:
    """Return the name of a mode, or its numbers.

    Parameters
    ----------
    main, sub : int
        PX4's main and sub mode [-].
    """
    name = _AUTO_NAMES.get(sub) if main == _AUTO else _NAMES.get(main)
    return name or f"mode {main}, {sub}"
