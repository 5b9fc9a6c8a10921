"""Pictures and films of obstacles without thickness."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.plotting import plot_distances, plot_plan, save_animation

from .conftest import HORIZON

WALL = np.array([[3.0, 6.0], [4.0, 7.0]])
FLAT = (
    Obstacle.line("fence", [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]),
    Obstacle.polygon("post", [[5.0, 8.0]]),
    Obstacle.moving("gate", [WALL + 0.1 * k for k in range(HORIZON + 1)]),
)
HANGING = (
    Obstacle.polygon("sign", [[2, 2, 0], [2, 3, 0], [2, 3, 1], [2, 2, 1]]),
    Obstacle.line("wire", [[3, 2, 0], [3, 2, 4]]),
    Obstacle.polygon("lamp", [[4, 4, 4]]),
    Obstacle.moving("rope", [[[0, 0, k], [1, 1, k]] for k in range(HORIZON + 1)]),
)


def artists(ax: Axes, name: str) -> list[object]:
    return [child for child in ax.get_children() if child.get_gid() == f"obstacle:{name}"]


def with_obstacles(plan: Plan, obstacles: tuple[Obstacle, ...]) -> Plan:
    return replace(plan, scenario=replace(plan.scenario, obstacles=obstacles))


def test_walls_are_lines_and_posts_dots(flat_plan: Plan) -> None:
    ax = plot_plan(with_obstacles(flat_plan, FLAT))
    counts = {name: len(artists(ax, name)) for name in ("fence", "post", "gate")}
    assert counts == {"fence": 2, "post": 1, "gate": HORIZON + 1}
    (dot,) = artists(ax, "post")
    assert isinstance(dot, Line2D)
    assert dot.get_markersize() > 0.0
    assert {"fence", "post", "gate"} <= {text.get_text() for text in ax.texts}


@pytest.mark.slow
def test_plates_wires_and_posts_are_drawn_in_space(space_plan: Plan) -> None:
    ax = plot_plan(with_obstacles(space_plan, HANGING))
    ax.figure.canvas.draw()
    assert all(artists(ax, name) for name in ("sign", "wire", "lamp", "rope"))


@pytest.mark.parametrize("obstacle", FLAT, ids=lambda o: o.name)
def test_distances_from_walls_are_never_negative_outside(
    flat_plan: Plan, obstacle: Obstacle
) -> None:
    assert plot_distances(with_obstacles(flat_plan, (obstacle,))) is not None


@pytest.mark.slow
def test_films_show_walls_and_wires(flat_plan: Plan, space_plan: Plan, tmp_path: Path) -> None:
    for name, plan in (
        ("plane", with_obstacles(flat_plan, FLAT)),
        ("space", with_obstacles(space_plan, HANGING)),
    ):
        save_animation(plan, tmp_path / f"{name}.gif", frames_per_step=1)
        assert (tmp_path / f"{name}.gif").stat().st_size > 1000
