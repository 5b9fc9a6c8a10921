"""Labels placed where they cover the least."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.patheffects import withStroke

from radmpc.arrays import Matrix, Vector
from radmpc.plotting.canvas.letters import LETTER, shortened, text_size
from radmpc.plotting.canvas.places import (
    Around,
    best_name_place,
    best_place,
    cost_of,
    is_on_text,
    nearest_in,
)
from radmpc.plotting.canvas.style import LABEL_SIZE
from radmpc.records import dataclass, field

__all__ = ["LabelBoard"]

_SHARES = [(x, y) for x in (0.0, -0.5, 0.5, -1.0, 1.0) for y in (0.0, -0.5, 0.5, -1.0, 1.0)]
"""Places in a box that are tried, in shares of what is left around a text there [-]."""
_FRAME: dict[str, Any] = {
    "boxstyle": "round,pad=0.22,rounding_size=0.6", "facecolor": "white", "linewidth": 0.4,
}  # fmt: skip
"""Looks of a frame around a text; its box style in units of the font size [-]."""
_ROUNDING = 1e-9
"""By how much a text may reach out of what it lies in [m]."""

_WIDEST = 0.5
"""Width of a name at most, as a share of the axes': it stands beside what it names [-]."""


@dataclass(slots=True)
class LabelBoard:
    """Places texts one after the other, away from points and from earlier texts.

    Attributes
    ----------
    axes : Axes
        Where to write; its limits and size must be final.
    points : list of (p, 2) array
        What a text should not cover [m].
    boxes : list of (4,) array
        Texts placed so far: x0, y0, x1, y1 [m].
    solids : list of Geometry
        What bears its name inside, so that another there would be misread.
    """

    axes: Axes
    points: list[Matrix] = field(default_factory=list)
    boxes: list[Vector] = field(default_factory=list)
    solids: list[shapely.Geometry] = field(default_factory=list)

    def avoid(self, *clouds: Matrix) -> None:
        """Keep later texts off these points, each (p, 2) [m]."""
        self.points.extend(clouds)

    def size(self, text: str, size: float = LABEL_SIZE) -> Vector:
        """Return the width and height of a text of a font size [m].

        Parameters
        ----------
        text : str
            One line.
        size : float
            Font size [pt].
        """
        return text_size(text, size) * self._scale

    def most_letters(self) -> int:
        """Return how many letters a name may have [-]."""
        left, right = self.axes.get_xlim()
        return max(int(_WIDEST * (right - left) / (LETTER[0] * LABEL_SIZE * self._scale)), 3)

    @property
    def _scale(self) -> float:
        """Meters per point of a text."""
        pixels_per_point = self.axes.figure.dpi / 72.0
        window = self.axes.get_window_extent()
        left, right = self.axes.get_xlim()
        return float((right - left) / (max(window.width, 1.0) / pixels_per_point))

    def within(
        self,
        text: str,
        shape: shapely.Polygon,
        color: object,
        *,
        gid: str | None = None,
    ) -> bool:
        """Write a text in a shape, upright or turned, where it covers the least; else nothing.

        On what is long but too thin for it, a text lies lengthwise.

        Parameters
        ----------
        text : str
            What to write.
        shape : Polygon
            Convex [m].
        color : color
            Of the text.
        gid : str or None
            As in `beside`.

        Returns
        -------
        bool
            Whether it has room.
        """
        half_text, around = 0.5 * self.size(text), self._around()
        corners = shapely.get_coordinates(shape)[:-1]
        center, half_size = corners.mean(axis=0), 0.5 * np.ptp(corners, axis=0)
        found: list[tuple[float, float, Vector]] = []
        for rotation, half in ((0.0, half_text), (90.0, half_text[::-1])):
            slack = half_size - half
            if slack[int(rotation > 0.0)] < 0.0:
                continue
            for share in _SHARES:
                # Across what is thin it stays on the middle line.
                place = center + np.asarray(share) * np.maximum(slack, 0.0)
                box = np.concatenate([place - half, place + half])
                is_in = slack.min() < 0.0 or shape.buffer(_ROUNDING).covers(shapely.box(*box))
                if not is_in and any(share):
                    continue
                far = 0.1 * float(np.abs(share).sum()) + (rotation > 0.0)
                found.append((cost_of(box, around) + far, rotation, place))
        if not found:
            return False
        _, rotation, place = min(found, key=lambda one: one[0])
        self.put(text, place, color, rotation=rotation, gid=gid)
        return True

    def beside(
        self,
        text: str,
        center: Vector,
        half_size: Vector,
        color: object,
        *,
        size: float = LABEL_SIZE,
        gid: str | None = None,
        is_framed: bool = False,
        is_needed: bool = True,
    ) -> None:
        """Write a text next to a thing.

        Parameters
        ----------
        text : str
            What to write.
        center : (2,) array
            Middle of the thing [m].
        half_size : (2,) array
            Half the width and height of the box around it [m].
        color : color
            Of the text.
        size : float
            Of the font [pt].
        gid : str or None
            Id of the text; None for ``label:`` and the text.
        is_framed : bool
            Whether the text stands in a frame with round corners.
        is_needed : bool
            Whether it is written even where it lies on another text.
        """
        half_text = 0.5 * self.size(f"{text} " if is_framed else text, size)
        around = self._around()
        place = best_place(center, half_size, half_text, around)
        box = np.concatenate([place - half_text, place + half_text])
        if is_needed or not is_on_text(box, around):
            self.put(text, place, color, size=size, gid=gid, is_framed=is_framed)

    def name(
        self, text: str, center: Vector, radius: float, color: Any, rivals: Sequence[Vector]
    ) -> None:
        """Write a vehicle's name beside its start, with a line to it where it has to be farther.

        A name that would lie on others wherever it stood is left out.

        Parameters
        ----------
        text : str
            The name; of one that is too long for the axes, both ends are written.
        center : (2,) array
            Of the start [m].
        radius : float
            Of the hull [m].
        color : color
            Of the vehicle.
        rivals : sequence of (4,) array
            Boxes around starts and goals of others: x0, y0, x1, y1 [m].
        """
        written, hull = shortened(text, self.most_letters()), np.full(2, radius)
        half_text = 0.5 * self.size(written)
        found = best_name_place(center, hull, half_text, self._around(rivals))
        if found is None:
            return
        place, is_led = found
        self.put(written, place, color, gid=f"label:{text}")
        if is_led:
            self._lead(text, nearest_in(self.boxes[-1], center), center, radius, color)

    def _lead(self, name: str, end: Vector, center: Vector, radius: float, color: Any) -> None:
        """Draw the line from a name to its start."""
        away = end - center
        start = center + radius * away / max(float(np.linalg.norm(away)), _ROUNDING)
        self.axes.plot(
            *np.column_stack([start, end]), color=color, linewidth=0.5, zorder=9.5,
            gid=f"leader:{name}", path_effects=[withStroke(linewidth=1.3, foreground="white")],
        )  # fmt: skip
        self.avoid(start + np.linspace(0.0, 1.0, 12)[:, None] * (end - start))

    def _around(self, rivals: Sequence[Vector] = ()) -> Around:
        """Return what is around texts [m]."""
        (left, right), (low, high) = self.axes.get_xlim(), self.axes.get_ylim()
        points = np.vstack(self.points) if self.points else np.empty((0, 2))
        frame = np.array([left, low, right, high])
        return Around(points, self.boxes, frame, rivals, self.solids)

    def put(
        self,
        text: str,
        center: Vector,
        color: object,
        *,
        rotation: float = 0.0,
        size: float = LABEL_SIZE,
        gid: str | None = None,
        is_framed: bool = False,
    ) -> None:
        """Write a text at a place, whatever is there.

        Parameters
        ----------
        text : str
            One line.
        center : (2,) array
            Its middle [m].
        color : color
            Of the text.
        rotation : float
            0 or 90 [°].
        size : float
            Font size [pt].
        gid : str or None
            Name of the artist, for tests and SVG.
        is_framed : bool
            As in `beside`; the frame takes a letter more.
        """
        half = 0.5 * self.size(f"{text} " if is_framed else text, size)
        frame = _FRAME | {"edgecolor": to_rgba(color)} if is_framed else None  # type: ignore[arg-type] # any color matplotlib knows
        if rotation:
            half = half[::-1]
        self.boxes.append(np.concatenate([center - half, center + half]))
        self.axes.text(
            float(center[0]),
            float(center[1]),
            text,
            color=to_rgba(color),  # type: ignore[arg-type] # any color matplotlib knows
            fontsize=size,
            ha="center",
            va="center",
            rotation=rotation,
            zorder=10,
            clip_on=True,
            gid=gid or f"label:{text}",
            bbox=frame,
            path_effects=[withStroke(linewidth=1.4, foreground="white")],
        )
