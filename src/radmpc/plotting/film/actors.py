"""What moves in a film: vehicles with all that goes with them, and moving obstacles."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from radmpc.arrays import Matrix
from radmpc.facets import surface
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.vehicle import Vehicle
from radmpc.plotting.artists.flat import Color
from radmpc.plotting.artists.relations import FOR_SOME, name_text
from radmpc.plotting.artists.straying import (
    SPREAD_DASHES,
    grown_outline,
    rings_artist,
    spread_rings,
)
from radmpc.plotting.canvas.style import (
    LABEL_SIZE,
    MAX_LABELS,
    MUTED,
    OBSTACLE_EDGE,
    OBSTACLE_FILL,
    WALL_WIDTH,
)
from radmpc.plotting.film.names import FlatName, MovingName, NamesApart, SolidName
from radmpc.plotting.film.ranges import RangeLine
from radmpc.plotting.interpolation import InterpolatedPath, interpolated_path, moving_outline

__all__ = ["Actor", "draw_actors"]

_ANGLES = np.linspace(0.0, 2.0 * np.pi, 49)
_CIRCLE = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)])
_PLANES = ((0, 1), (1, 2), (0, 2))


class Actor(Protocol):
    """Something that can be shown as it is at a moment."""

    def show(self, frame: int, time: float) -> None:
        """Show it at a moment.

        Parameters
        ----------
        frame : int
            Number of the frame, from 0.
        time : float
            Time since the start [steps].
        """


def draw_actors(ax: Axes, plan: Plan, colors: dict[str, Color], per_step: int) -> list[Actor]:
    """Draw everything that moves.

    Parameters
    ----------
    ax : Axes
        Axes to draw on.
    plan : Plan
        The plan to draw.
    colors : dict
        Color by vehicle.
    per_step : int
        Frames per step.

    Returns
    -------
    list of Actor
        To be shown at every frame.
    """
    actors: list[Actor] = []
    for obstacle in plan.scenario.obstacles:
        if obstacle.is_moving:
            is_flat = not isinstance(ax, Axes3D)
            actors.append(_FlatObstacle(ax, obstacle) if is_flat else _SolidObstacle(ax, obstacle))
    is_named = plan.scenario.num_vehicles <= MAX_LABELS
    places: dict[str, Matrix] = {}
    names: list[MovingName] = []
    for vehicle, trajectory in zip(plan.scenario.vehicles, plan.trajectories, strict=False):
        path = interpolated_path(
            vehicle, trajectory, per_step, intervals=plan.scenario.avoidance == "intervals"
        )
        kind = _SolidVehicle if isinstance(ax, Axes3D) else _FlatVehicle
        actor = kind(ax, vehicle, path, colors[vehicle.name], is_named, per_step)
        actors.append(actor)
        names.append(actor.name)
        places[vehicle.name] = path.positions
    for one, other in (kept.vehicles for kept in plan.scenario.keep if places):
        actors.append(RangeLine(ax, f"{one}:{other}", places[one], places[other]))
    # Last: names are placed where vehicles have come to.
    return [*actors, NamesApart(names)] if is_named else actors


class _FlatVehicle:
    """A vehicle in the plane."""

    def __init__(
        self,
        ax: Axes,
        vehicle: Vehicle,
        path: InterpolatedPath,
        color: Color,
        is_named: bool,
        per_step: int,
    ) -> None:
        self.path, self.per_step = path, per_step
        name, none = vehicle.name, np.zeros((1, 2))
        self.box = Polygon(
            none, facecolor=(*color, 0.07), edgecolor=(*color, 0.6), linewidth=0.5,
            linestyle=(0, (3, 1.5)), zorder=2.2, gid=f"temporal:{name}",
        )  # fmt: skip
        self.region = Polygon(
            none, facecolor=(*color, 0.8), edgecolor="none", linewidth=0.5, zorder=6.5,
            gid=f"ellipse:{name}",
        )  # fmt: skip
        self.hull = Circle(
            (0.0, 0.0), vehicle.radius, facecolor=(*color, 0.3), edgecolor=color, linewidth=0.6,
            zorder=6, gid=f"vehicle:{name}",
        )  # fmt: skip
        for patch in (self.box, self.region, self.hull):
            ax.add_patch(patch)
        [self.trail] = ax.plot([], [], color=color, linewidth=1.0, zorder=5, gid=f"trail:{name}")
        self.name = FlatName(ax, name if is_named else "", color)

    def show(self, frame: int, time: float) -> None:
        """Show it at a frame."""
        place = self.path.positions[frame]
        self.hull.center = (float(place[0]), float(place[1]))
        self.region.set_xy(place + 3.0 * (self.path.roots[frame] @ _CIRCLE).T)
        self.box.set_xy(self.path.boxes[min(int(time), len(self.path.boxes) - 1)])
        self.trail.set_data(*self.path.positions[: frame + 1].T)
        self.name.move(place)


class _SolidVehicle:
    """A vehicle in space."""

    def __init__(
        self,
        ax: Axes3D,
        vehicle: Vehicle,
        path: InterpolatedPath,
        color: Color,
        is_named: bool,
        per_step: int,
    ) -> None:
        self.path, self.per_step, self.ax = path, per_step, ax
        name = vehicle.name
        self.box = Poly3DCollection(
            _triangles(path.boxes[0]), facecolors=[(*color, 0.05)], linewidths=0.0,
            gid=f"temporal:{name}",
        )  # fmt: skip
        self.rings = Line3DCollection(
            self._rings(0), colors=[(*color, 0.7)], linewidths=0.5, gid=f"ellipse:{name}"
        )
        ax.add_collection3d(self.box)
        ax.add_collection3d(self.rings)
        [self.trail] = ax.plot(
            [], [], [], color=color, linewidth=1.0, zorder=50, gid=f"trail:{name}"
        )
        [self.shadow] = ax.plot([], [], [], color=color, linewidth=0.6, alpha=0.35)
        [self.hull] = ax.plot(
            [], [], [], linestyle="none", marker="o", markersize=5.0, color=color, zorder=52,
            gid=f"vehicle:{name}",
        )  # fmt: skip
        self.name = SolidName(ax, name if is_named else "", color)

    def _rings(self, frame: int) -> list[Matrix]:
        """Return the three principal rings of the 3σ ellipsoid."""
        place, root = self.path.positions[frame], self.path.roots[frame]
        return [place + 3.0 * (root[:, list(plane)] @ _CIRCLE).T for plane in _PLANES]

    def show(self, frame: int, time: float) -> None:
        """Show it at a frame."""
        been = self.path.positions[: frame + 1]
        self.trail.set_data_3d(*been.T)
        floor = np.full(len(been), self.ax.get_zlim()[0])
        self.shadow.set_data_3d(been[:, 0], been[:, 1], floor)
        self.hull.set_data_3d(*been[-1:].T)
        self.rings.set_segments(self._rings(frame))
        box = self.path.boxes[min(int(time), len(self.path.boxes) - 1)]
        self.box.set_verts(_triangles(box))
        self.name.move(been[-1])


class _FlatObstacle:
    """A moving obstacle in the plane."""

    def __init__(self, ax: Axes, obstacle: Obstacle) -> None:
        self.obstacle = obstacle
        self.patch = Polygon(
            np.zeros((1, 2)), edgecolor=OBSTACLE_EDGE, linewidth=0.6, zorder=2,
            gid=f"obstacle:{obstacle.name}",
            **({"facecolor": OBSTACLE_FILL} if obstacle.concerns is None else FOR_SOME),
        )  # fmt: skip
        ax.add_patch(self.patch)
        (self.wall,) = ax.plot(
            [], [], color=OBSTACLE_EDGE, linewidth=WALL_WIDTH, marker="o", markersize=WALL_WIDTH,
            markeredgewidth=0.0, zorder=2,
        )  # fmt: skip
        self.name = ax.text(
            0.0, 0.0, name_text(obstacle), fontsize=LABEL_SIZE, color=OBSTACLE_EDGE, ha="center",
            va="center", zorder=2.1, clip_on=True,
        )  # fmt: skip
        (self.ring,) = ax.plot(
            [], [], color=MUTED, linewidth=0.6, linestyle=SPREAD_DASHES, zorder=2.3,
            gid=f"spread:{obstacle.name}",
        )  # fmt: skip

    def show(self, frame: int, time: float) -> None:
        """Show it at a frame."""
        del frame
        outline = moving_outline(self.obstacle, time)
        self.patch.set_xy(outline)
        # What has no area would show as a hairline, or not at all.
        self.wall.set_data(*(outline if len(outline) < 3 else outline[:0]).T)
        self.name.set_position(tuple(outline.mean(axis=0)))
        if self.obstacle.spread is not None:
            ring = grown_outline(self.obstacle, time)
            self.ring.set_data(*np.vstack([ring, ring[:1]]).T)


class _SolidObstacle:
    """A moving obstacle in space."""

    def __init__(self, ax: Axes3D, obstacle: Obstacle) -> None:
        self.obstacle = obstacle
        self.faces = Poly3DCollection(
            _triangles(moving_outline(obstacle, 0.0)), facecolors=OBSTACLE_FILL, alpha=0.5,
            edgecolors=OBSTACLE_EDGE, linewidths=0.0, capstyle="round",
            gid=f"obstacle:{obstacle.name}",
        )  # fmt: skip
        ax.add_collection3d(self.faces)
        self.rings = rings_artist(spread_rings(obstacle, 0.0), f"spread:{obstacle.name}")
        if obstacle.spread is not None:
            ax.add_collection3d(self.rings)

    def show(self, frame: int, time: float) -> None:
        """Show it at a frame."""
        del frame
        outline = moving_outline(self.obstacle, time)
        self.faces.set_verts(_triangles(outline))
        self.faces.set_linewidth(WALL_WIDTH if len(outline) < 3 else 0.0)
        if self.obstacle.spread is not None:
            self.rings.set_segments(spread_rings(self.obstacle, time))


def _triangles(corners: Matrix) -> Matrix:
    """Return the hull's surface; of a wire or post a triangle without area."""
    triangles = surface(corners)
    return triangles if len(triangles) else corners[None, [0, -1, -1]]
