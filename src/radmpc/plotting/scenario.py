"""The picture of a scenario: obstacles, starts and goals."""

from __future__ import annotations

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes

from radmpc.arrays import Matrix, Vector
from radmpc.model.given import check_scenario
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.plotting.artists.flat import Color, draw_ends, draw_workspace, number_visits
from radmpc.plotting.artists.obstacles import draw_obstacle, name_obstacle, seen
from radmpc.plotting.artists.relations import draw_ranges
from radmpc.plotting.artists.space import (
    draw_ends_3d,
    draw_obstacle_3d,
    draw_workspace_3d,
)
from radmpc.plotting.artists.straying import draw_spread, draw_spread_3d
from radmpc.plotting.canvas.extent import scenario_extent
from radmpc.plotting.canvas.figure import check_axes, new_axes, settle_axes, settle_layout
from radmpc.plotting.canvas.headline import PLAIN, figure_headline, write_headline
from radmpc.plotting.canvas.space_labels import Board, SpaceBoard, board_of, show_all
from radmpc.plotting.canvas.style import (
    MAX_LABELS,
    MAX_PANEL_LABELS,
    vehicle_colors,
)
from radmpc.plotting.canvas.title import draw_headline
from radmpc.plotting.curves import ABOVE, Plane
from radmpc.plotting.views import new_views, settle_views

__all__ = [
    "draw_surroundings",
    "most_named",
    "name_obstacles",
    "name_vehicles",
    "plot_scenario",
]


@rc_context(PLAIN)
def plot_scenario(scenario: Scenario, ax: Axes | None = None) -> Axes:
    """Draw obstacles, workspace, starts and goals.

    Parameters
    ----------
    scenario : Scenario
        What to draw.
    ax : Axes or None
        Where; three-dimensional for a scenario in space. None makes a figure of one column, or in
        space of two columns with three panels: from above, from the side, and oblique.

    Returns
    -------
    Axes
        The axes drawn on, of several the oblique ones; nothing is shown and nothing saved.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> radmpc.plot_scenario(paper(2, seed=1)).get_title(loc="left")
    'paper-2-1'
    """
    check_scenario(scenario)
    check_axes(ax, scenario.dimension)
    extent = scenario_extent(scenario)
    if ax is None and scenario.dimension == 3:
        views = new_views(extent, 1)
        draw_headline(views.figure, figure_headline(views.figure, scenario.name))
        settle_views(views)
        for axes, plane in views.panels:
            _draw(axes, scenario, plane)
        oblique: Axes = views.oblique
        return oblique
    axes = new_axes(extent) if ax is None else ax
    settle_axes(axes, extent)
    write_headline(axes, scenario.name)
    settle_layout(axes)
    _draw(axes, scenario, ABOVE)
    return axes


def _draw(ax: Axes, scenario: Scenario, plane: Plane) -> None:
    """Draw all of a scenario within axes whose limits and size are final."""
    colors = vehicle_colors([v.name for v in scenario.vehicles], [])
    board = board_of(ax)
    draw_surroundings(ax, scenario, board, colors, plane=plane)
    most = most_named(scenario, board)
    draw_ranges(ax, scenario, board, plane, is_named=scenario.num_vehicles <= most)
    name_vehicles(scenario, board, colors, plane, most=most)
    name_obstacles(scenario, board, plane, most=most)
    show_all(ax)


def most_named(scenario: Scenario, board: Board) -> int:
    """Return how many vehicles, or obstacles, are named at most in one panel of a picture.

    Parameters
    ----------
    scenario : Scenario
        What is drawn.
    board : LabelBoard or SpaceBoard
        Of the panel: flat ones of a picture in space are small.
    """
    is_small = scenario.dimension == 3 and not isinstance(board, SpaceBoard)
    return MAX_PANEL_LABELS if is_small else MAX_LABELS


def draw_surroundings(
    ax: Axes,
    scenario: Scenario,
    board: Board,
    colors: dict[str, Color],
    *,
    moving: bool = True,
    strength: float = 1.0,
    plane: Plane = ABOVE,
) -> None:
    """Draw everything but trajectories and names; in space with those of obstacles.

    Moving obstacles on request, with what strength is asked for.

    Parameters
    ----------
    ax : Axes
        Where, flat or in space.
    scenario : Scenario
        The scenario to draw.
    board : LabelBoard or SpaceBoard
        Where texts stand.
    colors : dict
        Color by vehicle.
    moving : bool
        Whether moving obstacles are drawn.
    strength : float
        Opacity of those, as a share of the usual [-].
    plane : (int, int)
        The two coordinates that are drawn.
    """
    pale = {o.name: strength if o.is_moving else 1.0 for o in scenario.obstacles}
    obstacles = [o for o in scenario.obstacles if moving or not o.is_moving]
    if isinstance(board, SpaceBoard):
        if scenario.workspace is not None:
            draw_workspace_3d(ax, scenario.workspace)
        is_named = _are_named(scenario, MAX_LABELS)
        for obstacle in obstacles:
            draw_obstacle_3d(ax, obstacle, board, is_named=is_named, strength=pale[obstacle.name])
            draw_spread_3d(board.axes, obstacle)
        for vehicle in scenario.vehicles:
            draw_ends_3d(ax, vehicle, colors[vehicle.name])
        return
    coordinates = list(plane)
    if scenario.workspace is not None:
        draw_workspace(ax, scenario.workspace, board, plane)
    for vehicle in scenario.vehicles:
        draw_ends(ax, vehicle, colors[vehicle.name], plane)
        start, goal = vehicle.start_position[coordinates], vehicle.goal.center[coordinates]
        board.avoid(_ring(start, vehicle.radius), _ring(goal, 0.5 * vehicle.radius))
    if scenario.num_vehicles <= most_named(scenario, board):
        for vehicle in scenario.vehicles:
            number_visits(vehicle, colors[vehicle.name], board, plane)
    is_named = _are_named(scenario, most_named(scenario, board))
    for obstacle in obstacles:
        draw_obstacle(ax, obstacle, board, plane=plane, strength=pale[obstacle.name])
        if is_named and not obstacle.is_moving:
            board.solids += [one for p in obstacle.at(0) if (one := seen(p, plane)).area > 0.0]
        draw_spread(ax, obstacle, plane)


def name_vehicles(
    scenario: Scenario,
    board: Board,
    colors: dict[str, Color],
    plane: Plane = ABOVE,
    *,
    most: int = MAX_LABELS,
) -> None:
    """Write every vehicle's name beside its start, unless there are too many to read.

    Parameters
    ----------
    scenario : Scenario
        Whose vehicles.
    board : LabelBoard or SpaceBoard
        Where other texts stand.
    colors : dict
        Color by vehicle.
    plane : (int, int)
        The two coordinates that are drawn.
    most : int
        How many can be read.
    """
    if scenario.num_vehicles > most:
        return
    for vehicle in scenario.vehicles:
        color = colors[vehicle.name]
        if isinstance(board, SpaceBoard):
            others = [v for v in scenario.vehicles if v is not vehicle]
            rivals = [place for v in others for place in (v.start_position, v.goal.center)]
            board.name(vehicle.name, vehicle.start_position, color, rivals)
            continue
        place = vehicle.start_position[list(plane)]
        board.name(vehicle.name, place, vehicle.radius, color, _ends(scenario, vehicle, plane))


def _ends(scenario: Scenario, besides: Vehicle, plane: Plane) -> list[Vector]:
    """Return boxes around the starts and goals of all vehicles but one, (4,) each [m]."""
    coordinates = list(plane)
    boxes = []
    for vehicle in scenario.vehicles:
        if vehicle is besides:
            continue
        place, goal = vehicle.start_position[coordinates], vehicle.goal
        boxes.append(np.concatenate([place - vehicle.radius, place + vehicle.radius]))
        boxes.append(np.concatenate([goal.lower[coordinates], goal.upper[coordinates]]))
    return boxes


def name_obstacles(
    scenario: Scenario,
    board: Board,
    plane: Plane = ABOVE,
    *,
    moving: bool = True,
    most: int = MAX_LABELS,
) -> None:
    """Write names of obstacles in a flat picture where other texts leave room, if there are few.

    Parameters
    ----------
    scenario, board, plane, most
        As in `name_vehicles`.
    moving : bool
        Whether moving ones are named.
    """
    if isinstance(board, SpaceBoard) or not _are_named(scenario, most):
        return
    for obstacle in scenario.obstacles:
        if moving or not obstacle.is_moving:
            name_obstacle(obstacle, board, plane)


def _are_named(scenario: Scenario, most: int) -> bool:
    """Whether there are few enough to read the names of obstacles."""
    return max(len(scenario.obstacles), scenario.num_vehicles) <= most


def _ring(center: Matrix, radius: float) -> Matrix:
    """Return points on and in a circle, for texts to stay off."""
    angles = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    circle = center + radius * np.column_stack([np.cos(angles), np.sin(angles)])
    return np.vstack([circle, center])
