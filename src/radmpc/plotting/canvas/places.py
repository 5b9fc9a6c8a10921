"""Where a text beside a thing covers the least, and when only a line tells whose name it is."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
import shapely

from radmpc.arrays import Matrix, Vector
from radmpc.records import dataclass

__all__ = ["Around", "best_name_place", "best_place", "cost_of", "is_on_text", "nearest_in"]

_ANGLES = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)

_ON_A_TEXT = 10.0
"""What it costs at least to lie on another text [-]; from there on a place is bad."""

_CONFUSED = 8.0
"""What it costs to be nearer to the start or goal of another than to the own start [-]."""

_INSIDE = 10.0
"""What it costs to lie in what bears another name [-]."""

_BESIDE = 2.2
"""Gap up to which a name stands beside its start, in halves of its height [-]."""

_ROUNDING = 1e-9
"""Share of a text's height by which nearer is not nearer [-]."""


@dataclass(frozen=True, slots=True)
class _Tried:
    """Places beside a thing that are tried.

    Attributes
    ----------
    gaps : tuple of float
        Between the thing and a text, in halves of the text's height [-].
    directions : tuple of (float, float)
        From the middle of the thing.
    gap_cost : float
        What a gap of one costs, in points that a text covers [-].
    """

    gaps: tuple[float, ...]
    directions: tuple[tuple[float, float], ...]
    gap_cost: float


_NEAR = _Tried(
    (0.5, 1.5, 3.0),
    (
        (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0),
        (0.75, 0.75), (-0.75, 0.75), (0.75, -0.75), (-0.75, -0.75),
    ),
    0.6,
)  # fmt: skip

_FAR = _Tried(
    (0.5, 1.5, 3.0, 5.0, 8.0, 12.0),
    tuple((float(np.cos(angle)), float(np.sin(angle))) for angle in _ANGLES),
    1.2,
)
"""For names that have no room near."""


@dataclass(frozen=True, slots=True, eq=False)
class Around:
    """What is around a text, all in one unit.

    Attributes
    ----------
    points : (p, 2) array
        What it should not cover.
    boxes : sequence of (4,) array
        Texts placed so far: x0, y0, x1, y1.
    frame : (4,) array
        What it should not leave.
    rivals : sequence of (4,) array
        Boxes around the starts and goals of others, which a name there would seem to belong to.
    solids : sequence of Geometry
        What bears other names.
    """

    points: Matrix
    boxes: Sequence[Vector]
    frame: Vector
    rivals: Sequence[Vector] = ()
    solids: Sequence[shapely.Geometry] = ()


def best_place(center: Vector, half_size: Vector, half_text: Vector, around: Around) -> Vector:
    """Return where a text next to a thing covers the least, (2,).

    Parameters
    ----------
    center, half_size : (2,) array
        Middle of the thing, and half the width and height of the box around it.
    half_text : (2,) array
        Half the width and height of the text.
    around : Around
        What is there.
    """
    found: list[tuple[float, Vector]] = []
    for cost, place in _candidates(center, half_size, half_text, _NEAR):
        box = _box(place, half_text)
        # Ties go to the nearer and earlier candidate: pictures stay the same.
        found.append((cost_of(box, around) + cost, place))
    return min(found, key=lambda one: one[0])[1]


def best_name_place(
    center: Vector, half_size: Vector, half_text: Vector, around: Around
) -> tuple[Vector, bool] | None:
    """Return where a name stands, (2,), and whether a line must tell whose; None without room.

    Parameters
    ----------
    center, half_size, half_text : (2,) array
        As in `best_place`; the thing is the start of a vehicle.
    around : Around
        What is there.
    """
    found: list[tuple[float, Vector, bool]] = []
    for tried in (_NEAR, _FAR):
        for far, place in _candidates(center, half_size, half_text, tried):
            cost, is_led = _rated(_box(place, half_text), center, half_size, around)
            found.append((cost + far, place, is_led))
        cost, place, is_led = min(found, key=lambda one: one[0])
        if cost < _ON_A_TEXT:
            return place, is_led
    free = [one for one in found if not is_on_text(_box(one[1], half_text), around)]
    return min(free, key=lambda one: one[0])[1:] if free else None


def _rated(box: Vector, center: Vector, half_size: Vector, around: Around) -> tuple[float, bool]:
    """Return what it costs to write a name in a box, and whether a line must lead to its start."""
    own = _box(center, half_size)
    is_confused = _is_confused(box, own, around.rivals)
    is_led = is_confused or _apart(box, own) > 0.5 * _BESIDE * (box[3] - box[1])
    cost = cost_of(box, around) + _INSIDE * _share_inside(box, around.solids)
    cost += _CONFUSED * is_confused
    others = [*around.boxes, *around.rivals]
    return cost + _ON_A_TEXT * (is_led and _is_crossed(box, center, others)), is_led


def cost_of(box: Vector, around: Around) -> float:
    """Return how much a text in this box would cover; leaving the frame counts most.

    Parameters
    ----------
    box : (4,) array
        x0, y0, x1, y1.
    around : Around
        What is there.
    """
    inside = np.all((around.points >= box[:2]) & (around.points <= box[2:]), axis=1)
    covered = sum(_overlap(box, other) for other in around.boxes)
    area = float(np.prod(box[2:] - box[:2]))
    frame = around.frame
    is_outside = bool(np.any(box[:2] < frame[:2]) or np.any(box[2:] > frame[2:]))
    # One text on another can be read no more; on a path it can.
    texts = _ON_A_TEXT * (covered > 0.0) + 30.0 * covered / area
    return float(inside.sum()) + texts + 50.0 * is_outside


def is_on_text(box: Vector, around: Around) -> bool:
    """Return whether a text in this box lies on another.

    Parameters
    ----------
    box : (4,) array
        x0, y0, x1, y1.
    around : Around
        What is there.
    """
    return any(_overlap(box, other) > 0.0 for other in around.boxes)


def nearest_in(box: Vector, point: Vector) -> Vector:
    """Return the point of a box that is nearest to a point, (2,).

    Parameters
    ----------
    box : (4,) array
        x0, y0, x1, y1.
    point : (2,) array
        In the same unit.
    """
    return np.clip(point, box[:2], box[2:])


def _candidates(
    center: Vector,
    half_size: Vector,
    half_text: Vector,
    tried: _Tried,
) -> Iterator[tuple[float, Vector]]:
    """Yield what places cost for being far, and the places."""
    for gap in tried.gaps:
        for i, direction in enumerate(tried.directions):
            place = center + np.asarray(direction) * (half_text + half_size + gap * half_text[1])
            yield tried.gap_cost * gap + 0.01 * i, place


def _is_confused(box: Vector, own: Vector, rivals: Sequence[Vector]) -> bool:
    """Whether a name is nearer to the start or goal of another than to its own start."""
    apart = _apart(box, own) - _ROUNDING * float(box[3] - box[1])
    return any(_apart(box, other) < apart for other in rivals)


def _is_crossed(box: Vector, center: Vector, others: Sequence[Vector]) -> bool:
    """Whether the line from a name to its start crosses what stands elsewhere."""
    line = shapely.LineString([center, nearest_in(box, center)])
    start = shapely.Point(center)
    shapes = (shapely.box(*other) for other in others)
    return any(line.intersects(shape) and not start.intersects(shape) for shape in shapes)


def _share_inside(box: Vector, solids: Sequence[shapely.Geometry]) -> float:
    """Return the share of a box that lies in any of some solids, which may not overlap [-]."""
    text = shapely.box(*box)
    return sum(float(solid.intersection(text).area) for solid in solids) / float(text.area)


def _apart(first: Vector, second: Vector) -> float:
    """Return the distance of two boxes."""
    gaps = np.maximum(first[:2] - second[2:], second[:2] - first[2:])
    return float(np.linalg.norm(np.maximum(gaps, 0.0)))


def _box(center: Vector, half_size: Vector) -> Vector:
    """Return a box by its middle, (4,)."""
    return np.concatenate([center - half_size, center + half_size])


def _overlap(first: Vector, second: Vector) -> float:
    """Return the area that two boxes share."""
    sides: Iterable[float] = np.minimum(first[2:], second[2:]) - np.maximum(first[:2], second[:2])
    width, height = sides
    return max(width, 0.0) * max(height, 0.0)
