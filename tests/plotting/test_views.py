"""Pictures in space, moving obstacles beside those who pass, and figures that users made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text
from mpl_toolkits.mplot3d import Axes3D

from radmpc.errors import ArgumentError, ArgumentTypeError
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.plotting import (
    Panel,
    plot_distances,
    plot_ledger,
    plot_panels,
    plot_plan,
    plot_risk,
    plot_scenario,
    plot_views,
)
from radmpc.plotting.artists import ghosts
from radmpc.plotting.artists.ghosts import Ghost, nearest_ghosts
from radmpc.plotting.canvas.figure import drawn_box

from .conftest import HORIZON, make_vehicle

CUBE = np.array(np.meshgrid([0.0, 1.0], [0.0, 1.0], [0.0, 1.0])).reshape(3, -1).T
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def artists(ax: Axes, start: str) -> list[object]:
    return [child for child in ax.get_children() if (child.get_gid() or "").startswith(start)]


def moving(name: str, shape: np.ndarray, places: list[list[float]]) -> Obstacle:
    return Obstacle.moving(name, [shape + np.array(place) for place in places])


def with_obstacles(plan: Plan, *obstacles: Obstacle) -> Plan:
    return replace(plan, scenario=replace(plan.scenario, obstacles=obstacles))


@pytest.fixture
def crossed_plan(flat_plan: Plan) -> Plan:
    """The ferry passes behind a, which goes up from (1, 1) to (1, 9), and far from c."""
    places = [[2.0 - 1.5 * k, 4.5] for k in range(HORIZON + 1)]
    return with_obstacles(flat_plan, moving("ferry", SQUARE, places))


@pytest.mark.slow
def test_space_is_seen_from_above_from_the_side_and_oblique(space_plan: Plan) -> None:
    for ax in (plot_plan(space_plan), plot_scenario(space_plan.scenario)):
        top, side, oblique = ax.figure.axes
        assert ax is oblique
        assert isinstance(oblique, Axes3D)
        assert (top.get_xlabel(), top.get_ylabel()) == ("x [m]", "y [m]")
        assert (side.get_xlabel(), side.get_ylabel()) == ("x [m]", "z [m]")
        assert ax.figure.get_suptitle().strip() == "sky"


@pytest.mark.slow
def test_flat_panels_show_the_coordinates_they_name(space_plan: Plan) -> None:
    _, side, _ = plot_plan(space_plan).figure.axes
    [steps] = artists(side, "steps:down")
    means = space_plan.trajectories[1].means[1:]
    np.testing.assert_allclose(steps.get_xydata(), means[:, [0, 2]])
    [tower] = artists(side, "obstacle:tower")
    assert np.ptp(tower.get_xy(), axis=0) == pytest.approx([1.0, 8.0])


@pytest.mark.slow
def test_the_oblique_panel_fills_its_room_in_one_direction(space_plan: Plan) -> None:
    ax = plot_plan(space_plan)
    ax.figure.draw_without_rendering()
    drawn, room = drawn_box(ax), ax.figure.axes[0].get_window_extent()
    width, height = ax.figure.bbox.width, ax.figure.bbox.height
    free = width - room.x1
    assert drawn.width > 0.8 * free or drawn.height > 0.8 * height
    assert drawn.x0 > room.x1
    assert drawn.x1 <= width


@pytest.mark.slow
def test_the_heading_of_the_oblique_panel_stands_at_what_is_drawn(space_plan: Plan) -> None:
    ax = plot_plan(space_plan)
    ax.figure.draw_without_rendering()
    [heading] = [t for t in ax.findobj(Text) if t.get_text() == "oblique"]
    drawn, box = drawn_box(ax), heading.get_window_extent()
    assert box.x0 == pytest.approx(drawn.x0, abs=15.0)
    assert drawn.y1 <= box.y0 < drawn.y1 + 60.0


@pytest.mark.slow
def test_names_in_space_do_not_overlap_each_other(space_plan: Plan) -> None:
    ax = plot_plan(space_plan)
    ax.figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in artists(ax, "label:") + artists(ax, "step:")]
    assert len(boxes) > 4
    for i, first in enumerate(boxes):
        assert not any(first.overlaps(second) for second in boxes[i + 1 :])


@pytest.mark.slow
def test_nothing_in_space_is_cut_off(space_plan: Plan) -> None:
    ax = plot_plan(space_plan)
    assert not any(artist.get_clip_on() for artist in (*ax.lines, *ax.collections))


@pytest.mark.parametrize("place", [[1e6, 1e6], [1e6, 1e6, 1e6]])
def test_what_ticks_far_from_the_origin_have_in_common_is_as_large_as_they(
    place: list[float],
) -> None:
    away = [place[0] + 6.0, *place[1:]]
    drawn = plot_scenario(Scenario("far", 1.0, 4, 0.05, (make_vehicle("a", place, away),)))
    drawn.figure.draw_without_rendering()
    in_space = [drawn.zaxis] if isinstance(drawn, Axes3D) else []
    for axis in (drawn.xaxis, drawn.yaxis, *in_space):
        common, (tick, *_) = axis.get_offset_text(), axis.get_ticklabels()
        assert "1e6" in common.get_text()
        assert common.get_fontsize() == tick.get_fontsize()


def test_a_moving_obstacle_is_drawn_where_who_crosses_is_nearest(crossed_plan: Plan) -> None:
    ax = plot_plan(crossed_plan)
    found = nearest_ghosts(crossed_plan)
    assert [(ghost.index, ghost.step) for ghost in found] == [(0, 2), (1, 1)]
    [outline], [hull] = artists(ax, "ghost:ferry:a"), artists(ax, "near:ferry:a")
    assert outline.get_xy().min(axis=0) == pytest.approx([-1.0, 4.5])
    assert hull.center == pytest.approx(tuple(crossed_plan.trajectories[0].means[2, :2]))
    assert [text.get_text() for text in artists(ax, "ghost-step:ferry:a")] == ["step 2"]
    names = [text.get_text() for text in ax.get_legend().get_texts()]
    assert "when nearest" in names


def test_ghosts_of_one_obstacle_at_one_step_leave_each_other_gaps(
    crossed_plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    [ferry] = crossed_plan.scenario.obstacles
    at = [(0, 2), (1, 2), (2, 1)]
    nearest = tuple(Ghost(ferry, i, step, 1.0) for i, step in at)
    monkeypatch.setattr(ghosts, "nearest_ghosts", lambda _: nearest)
    ax = plot_plan(crossed_plan)
    a, b, c = (artists(ax, f"ghost:ferry:{name}")[0] for name in "abc")
    assert not any(outline.get_fill() for outline in (a, b, c))
    (begin, (dash, gap)), (other, _) = a.get_linestyle(), b.get_linestyle()
    assert (begin, other, dash) == (0.0, dash, gap)
    assert c.get_linestyle() == "solid"


def test_where_nobody_crosses_the_nearest_alone_gets_a_ghost(flat_plan: Plan) -> None:
    far = moving("ferry", SQUARE, [[8.0, 1.0 + 0.1 * k] for k in range(HORIZON + 1)])
    assert len(nearest_ghosts(with_obstacles(flat_plan, far))) == 1


def test_what_stands_still_has_no_ghost(flat_plan: Plan, empty_plan: Plan) -> None:
    still = with_obstacles(flat_plan, *(o for o in flat_plan.scenario.obstacles if not o.is_moving))
    for plan in (still, empty_plan):
        ax = plot_plan(plan)
        assert artists(ax, "ghost:") == []
        assert "when nearest" not in [text.get_text() for text in ax.get_legend().get_texts()]


@pytest.mark.slow
def test_ghosts_are_drawn_in_space_and_without_thickness(space_plan: Plan) -> None:
    rope = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0]])
    places = [[3.0 + 0.5 * k, 3.0, 3.0] for k in range(HORIZON + 1)]
    solids = moving("balloon", CUBE, places), moving("rope", rope, places)
    for ax in plot_plan(with_obstacles(space_plan, *solids)).figure.axes:
        assert artists(ax, "ghost:balloon:up")
        assert artists(ax, "ghost:rope:up")


@pytest.mark.slow
def test_whole_figures_stand_in_parts_of_the_users_figure(
    flat_plan: Plan, space_plan: Plan
) -> None:
    figure = Figure(figsize=(7.0, 12.0), layout="constrained")
    first, second, third = figure.subfigures(3, 1)
    assert plot_views(space_plan, first) is first
    assert plot_ledger(flat_plan, second) is second
    assert plot_panels([Panel("one", flat_plan)], third) is third
    assert len(figure.axes) == 3 + 2 + 1
    figure.draw_without_rendering()


def test_three_views_of_a_flat_plan_and_other_figures_are_refused(
    flat_plan: Plan, space_plan: Plan
) -> None:
    with pytest.raises(ArgumentError, match="plan must be in 3-D, got 2-D"):
        plot_views(flat_plan)
    with pytest.raises(ArgumentTypeError, match="figure must be one of matplotlib's Figure"):
        plot_views(space_plan, Figure().add_subplot())


@pytest.mark.parametrize("layout", ["constrained", None])
def test_stacked_axes_do_not_cover_each_others_legends(flat_plan: Plan, layout: str | None) -> None:
    figure = Figure(figsize=(3.5, 5.0), layout=layout)
    upper, lower = figure.subplots(2, 1)
    plot_distances(flat_plan, upper)
    plot_risk(flat_plan, lower)
    figure.draw_without_rendering()
    legend = upper.get_legend().get_window_extent()
    assert not legend.overlaps(lower.get_window_extent())
    assert legend.overlaps(upper.get_window_extent()) == (layout is None)
