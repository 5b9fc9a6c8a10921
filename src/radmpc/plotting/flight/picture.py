"""The picture of a flight: what was flown over what was planned, and the account beneath."""

from __future__ import annotations

import os
from pathlib import Path

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.transforms import ScaledTranslation

from radmpc.arguments import check_kind
from radmpc.io.flight.record import FlightRecord, FlownMission
from radmpc.plotting.canvas.headline import PLAIN
from radmpc.plotting.canvas.space_labels import board_of
from radmpc.plotting.canvas.style import (
    ALERT,
    MUTED,
    TICK_SIZE,
)
from radmpc.plotting.curves import confidence_ellipses, mean_path
from radmpc.plotting.flight.account import draw_account
from radmpc.plotting.flight.paths import flown
from radmpc.plotting.flight.stage import MOST_PATHS, Stage, is_measured, new_stage, shown_mission
from radmpc.plotting.save import save_axes
from radmpc.plotting.scenario import draw_surroundings, name_obstacles, name_vehicles

__all__ = ["plot_flight", "save_flight"]

_DROP = 0.27
"""Distance of the legend from the map's lower edge, past ticks and label [in]."""


@rc_context(PLAIN)
def plot_flight(record: FlightRecord) -> Axes:
    """Draw a flight seen from above: paths over the plan, discs, what was hit, the account.

    Pale outlines are where the plan expected vehicles with three standard deviations, full discs
    where they were expected one step before they were there. Of several missions one is drawn
    strongly: the first that hit something, or else the first.

    Parameters
    ----------
    record : FlightRecord
        With at least one tick.

    Returns
    -------
    Axes
        The upper axes, in a figure of one column; nothing is shown and nothing saved.

    Raises
    ------
    ArgumentTypeError
        If it is no flight.
    ArgumentError
        If nothing was flown.
    """
    check_kind(record, FlightRecord, "record", "a FlightRecord")
    stage = new_stage(record)
    mission = shown_mission(record)
    _draw_plan(stage, record)
    others = [m for m in record.missions if m.number != mission.number][:MOST_PATHS]
    for other in others:
        _draw_paths(stage, record, other, is_main=False)
    _draw_paths(stage, record, mission, is_main=True)
    for one in (*others, mission):
        _draw_contacts(stage, record, one)
    board = board_of(stage.above)
    pairs = zip(record.plan.scenario.vehicles, flown(record, mission), strict=True)
    board.avoid(*(mean_path(vehicle, path)[::2, :2] for vehicle, path in pairs))
    draw_surroundings(stage.above, record.plan.scenario, board, stage.colors, strength=0.4)
    name_vehicles(record.plan.scenario, board, stage.colors)
    name_obstacles(record.plan.scenario, board)
    _draw_legend(stage, bool(others), any(m.contacts for m in record.missions))
    draw_account(stage.account, record, mission)
    return stage.above


def save_flight(record: FlightRecord, path: str | os.PathLike[str]) -> None:
    """Write the picture of a flight; an interrupted write leaves an old file as it was.

    Parameters
    ----------
    record : FlightRecord
        What to draw.
    path : path
        Ends in ``.png``, ``.pdf`` or ``.svg``.

    Raises
    ------
    FileFormatError
        If the name ends otherwise.
    ArgumentError
        If nothing was flown.
    """
    save_axes(plot_flight(record), Path(path))


def _draw_plan(stage: Stage, record: FlightRecord) -> None:
    """Draw the plan palely: mean paths, and the outlines of its 3σ ellipses."""
    for vehicle, trajectory in zip(
        record.plan.scenario.vehicles, record.plan.trajectories, strict=True
    ):
        color = stage.colors[vehicle.name]
        path = mean_path(vehicle, trajectory)
        stage.above.plot(
            path[:, 0], path[:, 1], color=(*color, 0.55), linewidth=0.7, linestyle=(0, (4, 2)),
            zorder=3.5, gid=f"planned:{vehicle.name}",
        )  # fmt: skip
        outlines = PolyCollection(
            confidence_ellipses(vehicle, trajectory), facecolors="none", zorder=3,
            edgecolors=[(*color, 0.45)], linewidths=0.4, gid=f"ellipses:{vehicle.name}",
        )  # fmt: skip
        stage.above.add_collection(outlines, autolim=False)


def _draw_paths(
    stage: Stage, record: FlightRecord, mission: FlownMission, *, is_main: bool
) -> None:
    """Draw where a mission went; of the main one steps and discs, too."""
    if not is_measured(mission):
        return
    pairs = zip(record.plan.scenario.vehicles, flown(record, mission), strict=True)
    for vehicle, trajectory in pairs:
        color, name = stage.colors[vehicle.name], f"{mission.number}:{vehicle.name}"
        path = mean_path(vehicle, trajectory)
        width, strength, order = (1.1, 1.0, 5.2) if is_main else (0.4, 0.35, 4.5)
        stage.above.plot(
            path[:, 0], path[:, 1], color=(*color, strength), linewidth=width, zorder=order,
            gid=f"flown:{name}",
        )  # fmt: skip
        if not is_main:
            continue
        discs = PolyCollection(
            confidence_ellipses(vehicle, trajectory), facecolors=[(*color, 0.30)], zorder=5,
            edgecolors="none", gid=f"discs:{name}",
        )  # fmt: skip
        stage.above.add_collection(discs, autolim=False)
        steps = trajectory.means[:, list(vehicle.system.position)]
        stage.above.plot(
            steps[:, 0], steps[:, 1], linestyle="none", marker=".", markersize=3.2, color=color,
            zorder=5.5, gid=f"steps:{name}",
        )  # fmt: skip


def _draw_contacts(stage: Stage, record: FlightRecord, mission: FlownMission) -> None:
    """Mark where something was hit."""
    numbers = {v.name: i for i, v in enumerate(record.plan.scenario.vehicles)}
    for row in mission.rows:
        for touch in row.contacts:
            if row.states is None or touch.vehicle not in numbers:
                continue
            number = numbers[touch.vehicle]
            axes = record.plan.scenario.vehicles[number].system.position
            x, y = (float(row.states[number][a]) for a in axes[:2])
            stage.above.plot(
                [x], [y], marker="x", color=ALERT, markersize=5.0, markeredgewidth=1.2, zorder=9,
                gid=f"contact:{mission.number}:{touch.vehicle}",
            )  # fmt: skip


def _draw_legend(stage: Stage, has_others: bool, has_contacts: bool) -> None:
    """Say below the map what the signs mean."""
    entries = {
        "planned, 3σ": Line2D([], [], color=MUTED, linewidth=0.7, linestyle=(0, (4, 2)),
                              marker="o", markersize=7.0, markerfacecolor="none"),
        "flown": Line2D([], [], color=MUTED, linewidth=1.1, marker=".", markersize=4.0),
        "3σ a step ahead": Line2D([], [], linestyle="none", marker="o", markersize=5.0,
                                  markerfacecolor="#5555554D", markeredgecolor="none"),
    }  # fmt: skip
    if has_others:
        entries["other missions"] = Line2D([], [], color="#55555580", linewidth=0.4)
    if has_contacts:
        entries["hit"] = Line2D([], [], linestyle="none", marker="x", color=ALERT, markersize=5.0)
    below = ScaledTranslation(0.0, -_DROP, stage.figure.dpi_scale_trans)
    stage.above.legend(
        list(entries.values()), list(entries), loc="upper center", bbox_to_anchor=(0.5, 0.0),
        bbox_transform=stage.above.transAxes + below,
        ncols=len(entries), fontsize=TICK_SIZE, frameon=False, handlelength=1.6,
        columnspacing=0.8, handletextpad=0.3, borderaxespad=0.0,
    )  # fmt: skip
