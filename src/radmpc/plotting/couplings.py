"""The coupling graph: which vehicles were planned together, and why."""

from __future__ import annotations

import numpy as np
import shapely
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patheffects import withStroke

from radmpc.arrays import Matrix
from radmpc.model.given import check_plan
from radmpc.model.plan import Coupling, Plan
from radmpc.model.relations.couplings import unexplained_sets
from radmpc.plotting.artists.obstacles import patch_of
from radmpc.plotting.canvas.figure import check_axes, settle_layout
from radmpc.plotting.canvas.headline import PLAIN, write_headline
from radmpc.plotting.canvas.style import (
    COLUMN_WIDTH,
    LABEL_SIZE,
    MAX_LABELS,
    MUTED,
    NUMBER_SIZE,
    vehicle_colors,
)
from radmpc.plotting.risk.ledger_looks import new_column
from radmpc.wording import count_text

__all__ = ["plot_couplings"]

_APART = 1.0
"""Distance between two vehicles of a set, the unit of the diagram."""

_GAP = 0.8
"""Distance between two sets, in that unit."""

_ALONE = 0.6
"""Distance between two vehicles planned alone, in that unit."""

_BESIDE = 0.14
"""Distance from an edge to its number, in that unit."""

_AROUND = 0.3
"""Width of the shade around the vehicles of a set without couplings, in that unit."""

_WHOLE = 10.0
"""Distance from which on whole meters are written [m]."""

_MOST_NUMBERS = 16
"""Edges up to which each carries its risk as a number."""

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
    places, size = _layout([len(group) for group in groups])
    height = COLUMN_WIDTH * size[1] / size[0] + _FRAME
    axes = new_column(height).add_subplot() if ax is None else ax
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.set_xlim(0.0, size[0])
    axes.set_ylim(-size[1], 0.0)
    write_headline(axes, plan.scenario.name, f": {count_text(len(groups), 'set')}")
    names = [name for group in groups for name in group]
    place_of = dict(zip(names, places, strict=True))
    if not names:
        axes.text(0.5, 0.5, "no sets", transform=axes.transAxes, ha="center", fontsize=LABEL_SIZE)
        return axes
    settle_layout(axes)
    _shade_sets(axes, plan, place_of)
    _draw_edges(axes, plan, place_of)
    _draw_vehicles(axes, plan, place_of)
    axes.text(
        0.0, 0.0, _legend(plan), transform=axes.transAxes, fontsize=LABEL_SIZE, color=MUTED,
        va="top", gid="meaning",
    )  # fmt: skip
    return axes


def _layout(sizes: list[int]) -> tuple[Matrix, tuple[float, float]]:
    """Place sets as circles, row by row, the largest first; return places, and width and height."""
    radii = [0.0 if n < 2 else 0.5 * _APART / np.sin(np.pi / n) for n in sizes]
    # A set of two lies flat: it needs the height of a vehicle alone.
    widths = [_ALONE if n == 1 else 2.0 * r + _GAP for n, r in zip(sizes, radii, strict=True)]
    heights = [_ALONE if n <= 2 else w for n, w in zip(sizes, widths, strict=True)]
    area = sum(w * h for w, h in zip(widths, heights, strict=True))
    width = max(float(np.sqrt(1.6 * area)), *widths, 4.0) if sizes else 4.0
    places, x, y, row = [np.zeros((0, 2))], 0.0, 0.0, 0.0
    for n, r, wide, high in zip(sizes, radii, widths, heights, strict=True):
        if x + wide > width + 1e-9:
            x, y, row = 0.0, y + row, 0.0
        row = max(row, high)  # the first of a row is the highest
        turned = 0.5 * np.pi if n == 2 else 0.0
        angles = 0.5 * np.pi + turned + 2.0 * np.pi * np.arange(n) / n
        center = np.array([x + 0.5 * wide, -y - 0.5 * row])
        places.append(center + r * np.column_stack([np.cos(angles), np.sin(angles)]))
        x += wide
    return np.vstack(places), (width, max(y + row, _ALONE))


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
    for coupling in known:
        if coupling.value is None:
            continue
        one, two = sorted(
            (place_of[coupling.vehicle], place_of[coupling.other]), key=lambda place: place[0]
        )
        along = (two - one) / float(np.linalg.norm(two - one))
        middle = 0.5 * (one + two) + _BESIDE * np.array([-along[1], along[0]])
        ax.text(
            float(middle[0]), float(middle[1]), _number(coupling), fontsize=NUMBER_SIZE,
            color=MUTED, ha="center", va="center", zorder=4,
            gid=f"coupling:{coupling.vehicle}:{coupling.other}",
            path_effects=[withStroke(linewidth=1.6, foreground="white")],
        )  # fmt: skip


def _draw_vehicles(ax: Axes, plan: Plan, place_of: dict[str, Matrix]) -> None:
    """Draw a dot per vehicle in its color of the plan's picture, with its name if there is room."""
    colors = vehicle_colors([v.name for v in plan.scenario.vehicles], plan.sets)
    is_named = len(place_of) <= MAX_LABELS
    for name, place in place_of.items():
        ax.plot(
            *place[:, None], linestyle="none", marker="o", markersize=7.0 if is_named else 4.0,
            color=colors[name], markeredgecolor="white", markeredgewidth=0.5, zorder=3,
            gid=f"vehicle:{name}",
        )  # fmt: skip
        if is_named:
            ax.annotate(
                name, (float(place[0]), float(place[1])), xytext=(0.0, -4.5),
                textcoords="offset points", fontsize=LABEL_SIZE, color=colors[name], ha="center",
                va="top", zorder=5, path_effects=[withStroke(linewidth=1.4, foreground="white")],
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
    meanings = {
        "collision": "edge: risk of collision if planned apart (≤ 1)",
        "risk": "edge: risk of collision in the approximation",
        "blocked": "dashed: one blocked the other's way there",
        "distance": "edge: closest approach if planned apart",
        "share": "dashed: shares of Δ too small apart",
        "range": "edge: range to keep",
    }
    told = [
        text for reason, text in meanings.items() if any(c.reason == reason for c in plan.couplings)
    ]
    if unexplained_sets(plan.sets, plan.couplings):
        told.append("shaded: together from the start, no risk apart estimated")
    return "\n".join(told) or "no couplings: everyone planned alone"
