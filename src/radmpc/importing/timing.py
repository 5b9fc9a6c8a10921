"""Steps for problems that state none: how long they are, and how many."""

from __future__ import annotations

import math
from collections.abc import Sequence

from radmpc.importing.clearance import is_narrow
from radmpc.importing.free_space import FreePath
from radmpc.importing.options import ImportOptions
from radmpc.importing.problem import ForeignVehicle
from radmpc.rounding import rounded_up

__all__ = ["choose_steps"]

_TIME_FACTOR = 1.5
"""Horizon over the least time with no obstacles [-]: time for detours and waiting."""

_DETOUR_FACTOR = 1.3
"""Horizon over the least time around obstacles [-]: time for waiting."""

_TIGHT_FACTOR = 1.5
"""The same where paths are narrow or vehicles take turns [-]."""

_CROWDED_FACTOR = 1.6
"""The same where many go around obstacles: their detours around each other add up. On maps of
32 x 32 cells with 40 to 100 robots first plans come after 0.86 of the time that they take with 1.3,
for 0.7 of the effort, and all 27 maps have one within 60 s, where three had none; of four maps one
has none with 2.0."""

_FEWEST_STEPS, _MOST_STEPS = 10, 30
"""Steps that are chosen: few leave too little choice, many multiply the program."""

_FEWEST_OF_TURNS = 16
"""Steps at least where vehicles take turns: in 10 steps four that pass one window have no plan
within 20 s, in 12 and more they have one at once."""

_MORE_STEPS, _MOST_OF_MANY = 20, 72
"""Steps at most where vehicles go around obstacles: so many more than vehicles, from 30 up to 72.
In long steps, in which a robot passes two cells, paths miss corners and places to wait. On maps of
32 x 32 cells 20 robots have their first plans after 1.4 to 3.7 s with 40 steps and after 1.6 to
11.8 with 30 (seven maps), 40 robots after 5 to 17 s with 60, while one of five has none within 60 s
with 48, and 80 robots after 20 and 44 s with 72, where they had none."""

_MANY = 25
"""Vehicles from which on steps are half as long where some go around obstacles: of 80 robots none
get a plan within 60 s in steps of 1 m, in which they pass a cell each."""

_STRIDE = 4.0
"""Radii per step at full speed: finer steps multiply the choices, not the room."""

_LONGEST_STRIDE = 8.0
"""Radii per step at full speed where paths go around obstacles, if 72 steps allow: in longer ones
they miss corners. In a maze of 32 x 32 cells with corridors two wide eight robots have no plan
within 80 s of the processor in 30 steps of 4.5 m, and one after 8 s in 68 steps of 2 m."""

_STAYING = 1e-3
"""Steps at full speed up to which all vehicles count as staying where they are [-]: the middle of a
goal that is a region may differ from a start by rounding alone."""


def choose_steps(
    vehicles: Sequence[ForeignVehicle],
    paths: Sequence[FreePath],
    options: ImportOptions,
    choices: dict[str, str],
    warnings: list[str],
) -> tuple[float, int]:
    """Return dt and horizon: steps of four radii at full speed where 10 to 30 of them allow.

    Steps are half as long where paths are narrow, vehicles take turns, or many go around obstacles:
    corners, and places to wait, must fall on some. Such many take up to 72 steps, as do those whose
    steps around obstacles were longer than eight radii, and those that take turns at least 16.

    Parameters
    ----------
    vehicles : sequence of ForeignVehicle
        At least one.
    paths : sequence of FreePath
        Theirs, in the same order.
    options : ImportOptions
        A step, or a number of steps, that is asked for.
    choices : dict
        What was chosen, by name; both are added.
    warnings : list of str
        Where the scenario differs from the problem; a horizon that is too short is added.

    Returns
    -------
    dt : float
        Step [s].
    horizon : int
        Number of steps.
    """
    is_tight = any(
        path.waiting > 0.0 or is_narrow(path, v) for v, path in zip(vehicles, paths, strict=True)
    )
    goes_around = any(path.detour > 0.0 for path in paths)
    is_crowded = goes_around and len(vehicles) >= _MANY
    is_fine = is_tight or is_crowded
    stride = min(_STRIDE * v.radius / v.speed_limit for v in vehicles) * (0.5 if is_fine else 1.0)
    straight = max(v.minimum_time() for v in vehicles)
    least = max(
        v.minimum_time() + path.detour / v.speed_limit + path.waiting
        for v, path in zip(vehicles, paths, strict=True)
    )
    factor = _TIGHT_FACTOR if is_tight else _DETOUR_FACTOR
    if is_crowded:
        factor = max(factor, _CROWDED_FACTOR)
    duration = max(_TIME_FACTOR * straight, factor * least)
    if duration < _STAYING * stride:
        duration = _FEWEST_STEPS * stride
    if options.horizon is not None:
        horizon = int(options.horizon)
    elif options.dt is not None:
        horizon = min(max(math.ceil(duration / options.dt - 1e-9), 1), 1000)
    else:
        most = _most_steps(vehicles, duration) if goes_around else _MOST_STEPS
        takes_turns = any(path.waiting > 0.0 for path in paths)
        fewest = _FEWEST_OF_TURNS if takes_turns else _FEWEST_STEPS
        horizon = min(max(math.ceil(duration / stride - 1e-9), fewest), most)
    dt = rounded_up(duration / horizon) if options.dt is None else float(options.dt)
    asked = " (as asked)"
    choices["dt"] = f"{dt:g} s" + (asked if options.dt else "")
    choices["horizon"] = (
        f"{horizon} steps{asked if options.horizon else ''}: {dt * horizon:g} s, "
        f"the least time being {least:.4g} s"
    )
    if dt * horizon < least:
        warnings.append(f"{dt * horizon:g} s are too short: a vehicle needs at least {least:.4g} s")
    return dt, horizon


def _most_steps(vehicles: Sequence[ForeignVehicle], duration: float) -> int:
    """Return how many steps there are at most where vehicles go around obstacles."""
    longest = min(_LONGEST_STRIDE * v.radius / v.speed_limit for v in vehicles)
    wanted = max(len(vehicles) + _MORE_STEPS, math.ceil(duration / longest - 1e-9))
    return max(_MOST_STEPS, min(wanted, _MOST_OF_MANY))
