"""The coupling graph: which vehicles were planned together, and why."""

from __future__ import annotations

import numpy as np
import shapely
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patheffects import withStroke

from radmpc.arrays import Matrix, Vector
from radmpc.model.given import check_plan
from radmpc.model.plan import Coupling, Plan
from radmpc.model.relations.couplings import unexplained_sets
from radmpc.plotting.artists.flat import Color
from radmpc.plotting.artists.obstacles import patch_of
from radmpc.plotting.canvas.figure import check_axes, points_per_unit, settle_layout
from radmpc.plotting.canvas.headline import PLAIN, write_headline
from radmpc.plotting.canvas.letters import LETTER, shortened, text_size
from radmpc.plotting.canvas.style import (
    COLUMN_WIDTH,
    LABEL_SIZE,
    MAX_LABELS,
    MUTED,
    NUMBER_SIZE,
    vehicle_colors,
)
from radmpc.plotting.risk.ledger_looks import new_column
from radmpc.plotting.set_layout import SetLayout, laid_out
from radmpc.wording import count_text

__all__ = ["plot_couplings"]

_BESIDE = 0.14
"""Distance from an edge to its number, in units of that between two vehicles of a set."""

_ALONG = (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8)
"""Where on an edge its number may stand, the best first [-]."""

_AROUND = 0.3
"""Width of the shade around the vehicles of a set without couplings, in that unit."""

_WHOLE = 10.0
"""Distance from which on whole meters are written [m]."""

_UPRIGHT = 0.35
"""Sine of the angle within which a direction counts as level, or as upright [-]."""

_MOST_NUMBERS = 16
"""Edges up to which each carries its risk as a number."""

_NUMBERED = {
    "collision": "edge: risk of collision if planned apart (≤ 1)",
    "risk": "edge: risk of collision in the approximation",
    "blocked": "dashed: one blocked the other's way there",
    "distance": "edge: closest approach if planned apart",
    "share": "dashed: shares of Δ too small apart",
    "range": "edge: range to keep",
}
"""What edges mean, by their reason."""

_UNNUMBERED = {
    "collision": "edge: the darker, the more risk of collision if planned apart",
    "risk": "edge: the darker, the more risk in the approximation",
    "distance": "edge: close if planned apart",
    "range": "edge: both keep a range",
}
"""The same where there are too many for numbers."""

_MOST_LETTERS, _LEAST_LETTERS = 16, 5
"""Letters of a name that is written in full [-]; of longer ones both ends are. Where names would
reach over others they have fewer, down to the least."""

_AWAY = 4.5
"""Distance from a vehicle to its name [pt]."""

_FRAME = 0.75
"""Height of title, facts and margins [in]."""


@rc_context(PLAIN)
def plot_couplings(plan: Plan, ax: Axes | None = None) -> Axes:
    """Draw the coupling graph: vehicles as dots, sets side by side, an edge per coupling.

    The layout shows who belongs together, not where anyone is. An edge is the darker, the more
    likely a collision would have been; dashed ones have no number. A set that was planned together
    from the start, without any estimate of the risk apart, has no edges and is shaded.

    Parameters
    ----------
    plan : Plan
        With sets; without them the axes say so.
    ax : Axes or None
        Where. None makes a figure of one column.

    Returns
    -------
    Axes
        The axes drawn on; nothing is shown and nothing saved.
    """
    check_plan(plan)
    check_axes(ax, 2)
    groups = sorted(plan.sets, key=len, reverse=True)
    layout = laid_out([len(group) for group in groups])
    height = COLUMN_WIDTH * layout.height / layout.width + _FRAME
    axes = new_column(height).add_subplot() if ax is None else ax
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.set_xlim(0.0, layout.width)
    axes.set_ylim(-layout.height, 0.0)
    write_headline(axes, plan.scenario.name, f": {count_text(len(groups), 'set')}")
    names = [name for group in groups for name in group]
    place_of = dict(zip(names, layout.places, strict=True))
    if not names:
        axes.text(0.5, 0.5, "no sets", transform=axes.transAxes, ha="center", fontsize=LABEL_SIZE)
        return axes
    settle_layout(axes)
    _shade_sets(axes, plan, place_of)
    _draw_edges(axes, plan, place_of)
    _draw_vehicles(axes, plan, place_of, dict(zip(names, layout.outward, strict=True)))
    axes.annotate(
        _legend(plan), (0.0, 0.0), xycoords="axes fraction", fontsize=LABEL_SIZE, color=MUTED,
        xytext=(0.0, -_reach(axes, layout)), textcoords="offset points", va="top", gid="meaning",
    )  # fmt: skip
    return axes


def _reach(ax: Axes, layout: SetLayout) -> float:
    """Return how far below the axes the lowest names may reach [pt]."""
    is_down = layout.outward[:, 1] < -_UPRIGHT
    drop = np.where(is_down, -_AWAY * layout.outward[:, 1] + LETTER[1] * LABEL_SIZE, 0.0)
    above = (layout.places[:, 1] + layout.height) * points_per_unit(ax)
    return max(0.0, float(np.max(drop - above)))


def _shade_sets(ax: Axes, plan: Plan, place_of: dict[str, Matrix]) -> None:
    """Shade the sets that no coupling shows."""
    colors = vehicle_colors([v.name for v in plan.scenario.vehicles], plan.sets)
    for group in unexplained_sets(plan.sets, plan.couplings):
        around = shapely.MultiPoint([place_of[name] for name in group]).convex_hull
        patch = patch_of(around.buffer(_AROUND))
        patch.set(
            facecolor=(*colors[group[0]], 0.12), edgecolor="none", zorder=0.5,
            gid=f"set:{group[0]}",
        )  # fmt: skip
        ax.add_patch(patch)


def _draw_edges(ax: Axes, plan: Plan, place_of: dict[str, Matrix]) -> None:
    """Draw the couplings, and their numbers unless there are too many."""
    known = [c for c in plan.couplings if c.vehicle in place_of and c.other in place_of]
    ax.add_collection(
        LineCollection(
            [np.stack([place_of[c.vehicle], place_of[c.other]]) for c in known],
            colors=[(0.2, 0.2, 0.2, _darkness(c)) for c in known],
            linewidths=[0.4 + 1.0 * _darkness(c) for c in known],
            linestyles=["dashed" if c.value is None else "solid" for c in known],
            zorder=1,
            gid="couplings",
        ),
        autolim=False,
    )
    if len(known) > _MOST_NUMBERS:
        return
    taken: list[shapely.Polygon] = []
    for coupling in known:
        if coupling.value is None:
            continue
        half = 0.5 * text_size(_number(coupling), NUMBER_SIZE) / points_per_unit(ax)
        tried = _beside(place_of[coupling.vehicle], place_of[coupling.other])
        boxes = [shapely.box(*(place - half), *(place + half)) for place in tried]
        # Two numbers side by side would read as one.
        shared = [sum(box.intersection(other).area for other in taken) for box in boxes]
        best = int(np.argmin(shared))
        taken.append(boxes[best])
        ax.text(
            float(tried[best][0]), float(tried[best][1]), _number(coupling), fontsize=NUMBER_SIZE,
            color=MUTED, ha="center", va="center", zorder=4,
            gid=f"coupling:{coupling.vehicle}:{coupling.other}",
            path_effects=[withStroke(linewidth=1.6, foreground="white")],
        )  # fmt: skip


def _beside(start: Matrix, end: Matrix) -> list[Vector]:
    """Return where an edge's number may stand, in the middle first."""
    one, two = sorted((start, end), key=lambda place: place[0])
    along = (two - one) / float(np.linalg.norm(two - one))
    beside = one + _BESIDE * np.array([-along[1], along[0]])
    return [beside + share * (two - one) for share in _ALONG]


def _draw_vehicles(
    ax: Axes, plan: Plan, place_of: dict[str, Matrix], outward: dict[str, Vector]
) -> None:
    """Draw a dot per vehicle in its color of the plan's picture, with its name if there is room."""
    colors = vehicle_colors([v.name for v in plan.scenario.vehicles], plan.sets)
    letters = _letters(ax, place_of, outward)
    is_named = len(place_of) <= MAX_LABELS or all(len(name) <= letters for name in place_of)
    for name, place in place_of.items():
        ax.plot(
            *place[:, None], linestyle="none", marker="o", markersize=7.0 if is_named else 4.0,
            color=colors[name], markeredgecolor="white", markeredgewidth=0.5, zorder=3,
            gid=f"vehicle:{name}",
        )  # fmt: skip
        if is_named:
            _write_name(ax, name, letters, place, outward[name], colors[name])


def _letters(ax: Axes, place_of: dict[str, Matrix], outward: dict[str, Vector]) -> int:
    """Return how many letters names may have so that none reaches over another [-]."""
    away = np.array([outward[name] for name in place_of])
    places = np.array(list(place_of.values())) * points_per_unit(ax) + _AWAY * away
    sides = np.where(np.abs(away) < _UPRIGHT, 0.0, np.sign(away))
    for letters in range(_MOST_LETTERS, _LEAST_LETTERS, -1):
        half = 0.5 * np.array([text_size(shortened(n, letters), LABEL_SIZE) for n in place_of])
        boxes = shapely.box(*(places + (sides - 1.0) * half).T, *(places + (sides + 1.0) * half).T)
        if len(shapely.STRtree(boxes).query(boxes, "intersects")[0]) == len(boxes):
            return letters  # each meets itself alone
    return _LEAST_LETTERS


def _write_name(
    ax: Axes, name: str, letters: int, place: Vector, outward: Vector, color: Color
) -> None:
    """Write a name outside of its set's circle, where no edge is."""
    right, up = outward
    ax.annotate(
        shortened(name, letters), (float(place[0]), float(place[1])),
        xytext=(_AWAY * right, _AWAY * up), textcoords="offset points",
        fontsize=LABEL_SIZE, color=color, zorder=5,
        ha="center" if abs(right) < _UPRIGHT else "left" if right > 0.0 else "right",
        va="center" if abs(up) < _UPRIGHT else "bottom" if up > 0.0 else "top",
        gid=f"name:{name}", path_effects=[withStroke(linewidth=1.4, foreground="white")],
    )  # fmt: skip


def _darkness(coupling: Coupling) -> float:
    """Return how strong an edge looks, 0.25 to 1: by powers of ten of a risk."""
    if coupling.value is None or coupling.reason in {"distance", "range"}:
        return 0.5
    power = np.log10(max(min(coupling.value, 1.0), 1e-9))
    return float(np.clip(1.0 + power / 8.0, 0.25, 1.0))


def _number(coupling: Coupling) -> str:
    """Return an edge's value in a few letters."""
    value = 0.0 if coupling.value is None else coupling.value
    if coupling.reason in {"distance", "range"}:
        # With powers of ten hundreds of meters would be hard to read.
        return f"{value:.0f} m" if value >= _WHOLE else f"{value:.2g} m"
    return "1" if value >= 0.995 else f"{value:.1g}"


def _legend(plan: Plan) -> str:
    """Return what edges and shades mean."""
    are_numbered = len(plan.couplings) <= _MOST_NUMBERS
    meanings = _NUMBERED if are_numbered else _NUMBERED | _UNNUMBERED
    told = [
        text for reason, text in meanings.items() if any(c.reason == reason for c in plan.couplings)
    ]
    if unexplained_sets(plan.sets, plan.couplings):
        told.append("shaded: together from the start, no risk apart estimated")
    return "\n".join(told) or "no couplings: everyone planned alone"
