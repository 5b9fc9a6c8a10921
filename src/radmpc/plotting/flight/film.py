"""The film of a flight: vehicles as they were, discs of what was still to come, the account."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Circle

from radmpc.arguments import check_path
from radmpc.arrays import Matrix
from radmpc.io.flight.following import Followed, followed
from radmpc.io.flight.record import FlightRecord, FlownMission
from radmpc.model.plan import Trajectory
from radmpc.model.vehicle import Vehicle
from radmpc.plotting.artists.flat import Color
from radmpc.plotting.canvas.headline import PLAIN
from radmpc.plotting.canvas.space_labels import board_of
from radmpc.plotting.canvas.style import ALERT, LABEL_SIZE, MUTED
from radmpc.plotting.curves import ABOVE, confidence_ellipses, mean_path, positions
from radmpc.plotting.film.actors import Actor, draw_actors
from radmpc.plotting.film.animation import FRAMES_PER_STEP, Film
from radmpc.plotting.film.films import check_film_path, write_film
from radmpc.plotting.flight.account import draw_account
from radmpc.plotting.flight.paths import ahead, chosen, flown
from radmpc.plotting.flight.stage import Stage, new_stage
from radmpc.plotting.scenario import draw_surroundings, name_obstacles, name_vehicles

__all__ = ["make_flight_film", "save_flight_film"]


def save_flight_film(record: FlightRecord, path: str | os.PathLike[str]) -> None:
    """Write the film of a flight, in the manner of `save_animation`.

    Parameters
    ----------
    record : FlightRecord
        Of several missions the first that hit something is shown, or else the first.
    path : path
        Ends in ``.gif``, or in ``.mp4`` where the program ``ffmpeg`` is on the PATH.

    Raises
    ------
    FileFormatError
        If the name ends otherwise, or ``ffmpeg`` is missing.
    ArgumentError
        If nothing was flown.
    """
    check_path(path)
    target = Path(path)
    check_film_path(target)
    write_film(make_flight_film(record), target, FRAMES_PER_STEP)


@rc_context(PLAIN)
def make_flight_film(record: FlightRecord) -> Film:
    """Return a flight as a figure that can be set to any frame.

    Parameters
    ----------
    record : FlightRecord
        What is drawn.

    Raises
    ------
    ArgumentError
        If nothing was flown.
    """
    stage = new_stage(record)
    mission = chosen(record)
    if mission is None:  # of which the stage has spoken
        raise RuntimeError("a flight that never began has no film")
    dt, trajectories = record.plan.scenario.dt, flown(record, mission)
    draw_account(stage.account, replace(record, rows=mission.rows), mission)
    # Laid out once, the account's legend in it: a layout per frame would take longer than frames.
    stage.figure.draw_without_rendering()
    stage.figure.set_layout_engine("none")
    cursor = stage.account.axvline(0.0, color="#222222", linewidth=0.8, gid="cursor")
    moving = _draw_surroundings(stage, record, trajectories)
    actors = _actors(stage, record, mission, trajectories)
    clock = stage.above.text(
        1.0, 1.01, "", transform=stage.above.transAxes, fontsize=LABEL_SIZE, color=MUTED,
        ha="right", va="bottom", gid="clock",
    )  # fmt: skip

    def show(frame: int) -> list[Artist]:
        time = frame / FRAMES_PER_STEP
        for one in (*moving, *actors):
            one.show(frame, time)
        cursor.set_xdata([time * dt, time * dt])
        clock.set_text(f"t = {time * dt:.1f} s")
        return []

    show(0)
    steps = len(trajectories[0].means) - 1
    return Film(stage.figure, show, steps * FRAMES_PER_STEP + 1)


def _draw_surroundings(
    stage: Stage, record: FlightRecord, trajectories: tuple[Trajectory, ...]
) -> list[Actor]:
    """Draw what is there beside vehicles; return what of it moves."""
    plan, scenario = record.plan, record.plan.scenario
    board = board_of(stage.above)
    pairs = zip(scenario.vehicles, trajectories, strict=True)
    board.avoid(*(mean_path(vehicle, path)[::2, :2] for vehicle, path in pairs))
    # In space a moving obstacle is drawn at all steps, as seen from above.
    is_flat = scenario.dimension == 2
    draw_surroundings(stage.above, scenario, board, stage.colors, moving=not is_flat)
    name_vehicles(scenario, board, stage.colors)
    name_obstacles(scenario, board, moving=not is_flat)
    bare = replace(plan, trajectories=())
    return draw_actors(stage.above, bare, stage.colors, 1) if is_flat else []


def _actors(
    stage: Stage,
    record: FlightRecord,
    mission: FlownMission,
    trajectories: tuple[Trajectory, ...],
) -> list[_Actor]:
    """Draw the vehicles."""
    known = followed(record, mission)
    made = []
    for i, vehicle in enumerate(record.plan.scenario.vehicles):
        hits = [row.step for row in mission.rows for t in row.contacts if t.vehicle == vehicle.name]
        color = stage.colors[vehicle.name]
        made.append(_Actor(stage.above, i, vehicle, trajectories[i], known, color, hits))
    return made


class _Actor:
    """A vehicle: hull, where it has been, and discs of where it will be."""

    def __init__(
        self,
        ax: Axes,
        number: int,
        vehicle: Vehicle,
        path: Trajectory,
        known: tuple[Followed, ...],
        color: Color,
        hits: list[int],
    ) -> None:
        self._color, self._first_hit = color, min(hits, default=None)
        self._places = _places(vehicle, path)
        coming = [ahead(vehicle, number, one) for one in known]
        self._discs = [
            () if one is None else confidence_ellipses(vehicle, one, plane=ABOVE) for one in coming
        ]
        self._routes = [
            np.zeros((0, 2)) if one is None else positions(vehicle, one)[:, :2] for one in coming
        ]
        self._cone = PolyCollection(
            [], facecolors=[(*color, 0.16)], edgecolors=[(*color, 0.5)], linewidths=0.35, zorder=3,
            gid=f"ahead:{vehicle.name}",
        )  # fmt: skip
        ax.add_collection(self._cone, autolim=False)
        [self._way] = ax.plot([], [], color=(*color, 0.6), linewidth=0.6, linestyle=(0, (2, 1.5)),
                              zorder=3.5)  # fmt: skip
        [self._trail] = ax.plot([], [], color=color, linewidth=1.0, zorder=5,
                                gid=f"trail:{vehicle.name}")  # fmt: skip
        self._hull = Circle(
            (0.0, 0.0), vehicle.radius, facecolor=(*color, 0.45), edgecolor=color, linewidth=0.6,
            zorder=6, gid=f"vehicle:{vehicle.name}",
        )  # fmt: skip
        ax.add_patch(self._hull)

    def show(self, frame: int, time: float) -> None:
        """Show it at a frame; red from the step on at which it hit something."""
        place, step = self._places[frame], frame // FRAMES_PER_STEP
        self._hull.center = (float(place[0]), float(place[1]))
        if self._first_hit is not None and self._first_hit <= time:
            self._hull.set_edgecolor(ALERT)
            self._hull.set_linewidth(1.4)
        else:
            self._hull.set_edgecolor(self._color)
            self._hull.set_linewidth(0.6)
        self._trail.set_data(*self._places[: frame + 1].T)
        self._cone.set_verts(self._discs[step])
        self._way.set_data(*np.vstack([place, self._routes[step]]).T)


def _places(vehicle: Vehicle, path: Trajectory) -> Matrix:
    """Return where a vehicle is at every frame, seen from above, (f, 2) [m]."""
    curve = mean_path(vehicle, path)[:, :2]
    frames = np.linspace(0.0, 1.0, (len(path.means) - 1) * FRAMES_PER_STEP + 1)
    drawn = np.linspace(0.0, 1.0, len(curve))
    return np.column_stack([np.interp(frames, drawn, column) for column in curve.T])
