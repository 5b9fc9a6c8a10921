"""Survey lines over an area, to and fro, as boxes that a vehicle visits."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_number
from radmpc.arrays import Matrix, as_axes, as_matrix, as_vector
from radmpc.errors import ScenarioError
from radmpc.model.visits import Visit
from radmpc.ranges import sized

__all__ = ["survey_visits"]

_END_SHARE = 0.25
"""Half width of the boxes at the ends of lines, as a share of the spacing, unless stated [-]."""

_MOST_LINES = 10_000
"""Lines beyond which an area is not surveyed: no horizon has as many steps."""


def survey_visits(
    area: npt.ArrayLike,
    spacing: float,
    direction: npt.ArrayLike = (1.0, 0.0),
    *,
    half_width: npt.ArrayLike | None = None,
    altitude: float | None = None,
    speed: npt.ArrayLike | None = None,
) -> tuple[Visit, ...]:
    """Return visits at the ends of parallel lines over an area, flown to and fro.

    The lines are as few as leave no point of the area farther than half the spacing from one. On a
    line that leaves the area and comes back, every piece has its two ends.

    Parameters
    ----------
    area : (v, 2) array_like
        Corners of a simple polygon, convex or not, either way round [m].
    spacing : float
        Largest distance between lines, > 0 [m].
    direction : (2,) array_like
        Along the first line; the next lie to its left.
    half_width : number, array_like or None
        Of the boxes [m]; None is a quarter of the spacing.
    altitude : float or None
        Third coordinate of all boxes, in space [m]; None in the plane.
    speed : number, array_like or None
        Largest mean speed per axis at the ends [m/s]; None leaves it free.

    Returns
    -------
    tuple of Visit
        Two for each piece of a line, in the order of the lines.

    Raises
    ------
    ScenarioError
        If the area has no inner points, takes more than 10,000 lines, or a number is not allowed.

    Examples
    --------
    >>> import radmpc
    >>> area = [[0.0, 0.0], [40.0, 0.0], [40.0, 12.0], [0.0, 12.0]]
    >>> [v.center.tolist() for v in radmpc.survey_visits(area, spacing=6.0)]
    [[0.0, 3.0], [40.0, 3.0], [40.0, 9.0], [0.0, 9.0]]
    """
    corners = sized(as_matrix(area, (None, 2), ("area",)), ("area",))
    if len(corners) < 3:
        raise ScenarioError("must have three corners or more, not on one line", ("area",))
    between = field_number(spacing, ("spacing",))
    if not (math.isfinite(between) and between > 0.0):
        raise ScenarioError(f"must be > 0 m, got {between:g}", ("spacing",))
    along = sized(as_vector(direction, 2, ("direction",)), ("direction",))
    length = float(np.linalg.norm(along))
    if length == 0.0:
        raise ScenarioError("must not be zero in both coordinates", ("direction",))
    frame = np.array([along, [-along[1], along[0]]]) / length
    turned = corners @ frame.T
    lowest, highest = float(turned[:, 1].min()), float(turned[:, 1].max())
    if not highest - lowest > 0.0:
        raise ScenarioError("must have three corners or more, not on one line", ("area",))
    wanted = (highest - lowest) / between * (1.0 - 1e-12)
    if wanted > _MOST_LINES:
        raise ScenarioError(
            f"must leave at most {_MOST_LINES:,} lines over an area {highest - lowest:g} m wide, "
            f"got {between:g} m",
            ("spacing",),
        )
    count = math.ceil(wanted)
    ends: list[list[float]] = []
    for i in range(count):
        height = lowest + (i + 0.5) * (highest - lowest) / count
        crossings = _crossings(turned, height)
        ends += [[x, height] for x in (crossings if i % 2 == 0 else crossings[::-1])]
    if not ends:
        raise ScenarioError("must have three corners or more, not on one line", ("area",))
    places = np.array(ends) @ frame
    if altitude is not None:
        high = field_number(altitude, ("altitude",))
        places = np.column_stack([places, np.full(len(places), high)])
    half = as_axes(
        _END_SHARE * between if half_width is None else half_width, places.shape[1], ("half_width",)
    )
    return tuple(Visit.at(place, half, speed=speed) for place in places)


def _crossings(corners: Matrix, height: float) -> list[float]:
    """Return where a polygon's border crosses a height, from left to right: an even number."""
    ahead = np.roll(corners, -1, axis=0)
    crosses = (corners[:, 1] <= height) != (ahead[:, 1] <= height)
    one, two = corners[crosses], ahead[crosses]
    shares = (height - one[:, 1]) / (two[:, 1] - one[:, 1])
    return sorted((one[:, 0] + shares * (two[:, 0] - one[:, 0])).tolist())
