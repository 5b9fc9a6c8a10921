"""Whom obstacles concern, and ranges that vehicles keep."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from radmpc.arrays import Matrix, Vector
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.relations.keep import keep_pairs
from radmpc.model.scenario import Scenario
from radmpc.plotting.canvas.letters import shortened
from radmpc.plotting.canvas.space_labels import Board, SpaceBoard
from radmpc.plotting.canvas.style import MUTED, NUMBER_SIZE
from radmpc.plotting.curves import ABOVE, Plane, positions
from radmpc.wording import count_text

__all__ = ["FOR_SOME", "PASSED", "RANGE_DASHES", "draw_ranges", "name_text"]

FOR_SOME: dict[str, Any] = {"facecolor": "#F4F4F4", "hatch": "////", "hatch_linewidth": 0.4}
"""How an obstacle looks that some vehicles pass through: pale and hatched."""

PASSED = (0, (3, 1.5))
"""Dashes of a wall that some vehicles pass through."""

RANGE_DASHES = (0, (1, 1.5))
"""Dashes of the line between two that keep a range."""

_MOST_NAMED = 3
"""Vehicles that a label names [-]."""

_FEWEST = 5
"""Letters of a name that are left before a number of vehicles [-]."""


def name_text(obstacle: Obstacle, letters: int | None = None) -> str:
    """Return an obstacle's name, and whom it is for where that is not everybody.

    Parameters
    ----------
    obstacle : Obstacle
        Of a scenario.
    letters : int or None
        Beyond these vehicles are counted in place of named, and of a name that is still too long
        both ends are returned. None is as many as it takes.
    """
    whom = obstacle.concerns
    if whom is None:
        return obstacle.name if letters is None else shortened(obstacle.name, letters)
    hidden = len(whom.names) - _MOST_NAMED
    names = ", ".join(whom.names[:_MOST_NAMED]) + (f" and {hidden} more" if hidden > 0 else "")
    word = "not" if whom.are_exempt else "only"
    text = f"{obstacle.name} ({word} {names})"
    if letters is None or len(text) <= letters:
        return text
    counted = f" ({word} {count_text(len(whom.names), 'vehicle')})"
    return shortened(obstacle.name, max(letters - len(counted), _FEWEST)) + counted


def draw_ranges(
    ax: Axes, what: Scenario | Plan, board: Board, plane: Plane = ABOVE, *, is_named: bool = True
) -> None:
    """Draw a line between two that keep a range: their means when farthest apart, or their starts.

    Parameters
    ----------
    ax : Axes
        Where, flat or in space.
    what : Scenario or Plan
        A plan without trajectories is drawn like its scenario.
    board : LabelBoard or SpaceBoard
        Where texts stand.
    plane : (int, int)
        The two coordinates that flat axes show.
    is_named : bool
        Whether distance and range are written beside the line.
    """
    is_flat = not isinstance(board, SpaceBoard)
    for name, ends, text in _lines(what):
        shown = ends[:, list(plane)] if is_flat else ends
        ax.plot(
            *shown.T, color=MUTED, linewidth=0.8, linestyle=RANGE_DASHES, zorder=4.5,
            gid=f"range:{name}",
        )  # fmt: skip
        if is_named:
            _tell(board, text, shown.mean(axis=0), f"range label:{name}")


def _tell(board: Board, text: str, place: Vector, gid: str) -> None:
    """Write a text beside a place."""
    if isinstance(board, SpaceBoard):
        board.beside(text, place, MUTED, size=NUMBER_SIZE, gid=gid)
    else:
        board.beside(text, place, np.zeros(2), MUTED, size=NUMBER_SIZE, gid=gid)


def _lines(what: Scenario | Plan) -> Iterator[tuple[str, Matrix, str]]:
    """Yield the name of each range, where its two are, (2, d) [m], and what is told of it."""
    scenario = what.scenario if isinstance(what, Plan) else what
    fleet = scenario.vehicles
    for i, j, within in keep_pairs(scenario.keep, [vehicle.name for vehicle in fleet]):
        name = f"{fleet[i].name}:{fleet[j].name}"
        if not isinstance(what, Plan) or not what.trajectories:
            starts = np.stack([fleet[i].start_position, fleet[j].start_position])
            yield name, starts, f"within {within:g} m"
            continue
        one, two = (positions(fleet[k], what.trajectories[k]) for k in (i, j))
        apart = np.linalg.norm(one - two, axis=1)
        k = int(apart.argmax())
        yield name, np.stack([one[k], two[k]]), f"{apart[k]:.3g} of {within:g} m at {k}"
