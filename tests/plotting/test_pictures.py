from __future__ import annotations

from dataclasses import replace

import matplotlib
import numpy as np
import pytest
import shapely
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import rgb_to_hsv, to_rgb
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from radmpc.model.plan import Plan, Risk
from radmpc.model.scenario import Scenario
from radmpc.plotting import plot_plan, plot_scenario
from radmpc.plotting.artists.obstacles import patch_of
from radmpc.plotting.canvas.style import ALERT, MAX_LABELS

from .conftest import make_plan, make_vehicle


def artists(ax: Axes, gid: str) -> list[object]:
    """All artists with an id."""
    return [child for child in ax.get_children() if child.get_gid() == gid]


def texts(ax: Axes) -> dict[str, object]:
    """All texts on the axes by what they say."""
    return {text.get_text(): text for text in ax.texts}


def hue(color: object) -> float:
    return float(rgb_to_hsv(to_rgb(color))[0])


def test_every_thing_of_a_scenario_is_drawn_and_named(flat_scenario: Scenario) -> None:
    ax = plot_scenario(flat_scenario)
    for name in "abc":
        assert len(artists(ax, f"start:{name}")) == 1
        assert len(artists(ax, f"goal:{name}")) == 1
    for name in ("hook", "wall"):
        assert len(artists(ax, f"obstacle:{name}")) == 1
    assert len(artists(ax, "workspace")) == 1
    assert {"a", "b", "c", "hook", "wall", "ferry"} <= set(texts(ax))
    assert ax.get_title(loc="left") == "bay"


def test_axes_have_units_and_equal_scales(flat_scenario: Scenario) -> None:
    ax = plot_scenario(flat_scenario)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [m]", "y [m]")
    assert ax.get_aspect() == 1.0


def test_a_moving_obstacle_fades_in_over_time(flat_scenario: Scenario) -> None:
    ax = plot_scenario(flat_scenario)
    fading = [artist.get_alpha() for artist in artists(ax, "obstacle:ferry")]
    assert len(fading) == flat_scenario.horizon + 1
    assert fading == sorted(fading)
    assert fading[0] < 0.2 < fading[-1]


def test_the_outline_of_a_split_obstacle_shows_no_seams(flat_scenario: Scenario) -> None:
    hook = artists(plot_scenario(flat_scenario), "obstacle:hook")[0]
    assert len(flat_scenario.obstacles[0].at(0)) > 1
    assert len(np.unique(hook.get_xy(), axis=0)) == 6


def test_a_plan_shows_path_steps_ellipses_hull_and_direction(flat_plan: Plan) -> None:
    ax = plot_plan(flat_plan)
    (steps,) = artists(ax, "steps:a")
    np.testing.assert_allclose(steps.get_xydata(), flat_plan.trajectories[0].means[1:, :2])
    (ellipses,) = artists(ax, "ellipses:a")
    assert len(ellipses.get_paths()) == flat_plan.scenario.horizon + 1
    assert len(artists(ax, "hull:a")) == 1
    assert len(artists(ax, "arrow:a")) == 2


def test_a_hull_that_comes_back_to_where_it_was_leaves_free_what_lies_within() -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 41)
    loop = shapely.LineString(5.0 * np.column_stack([np.cos(angles), np.sin(angles)]))
    fig = Figure(figsize=(2.0, 2.0), dpi=50)
    ax = fig.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(-6.0, 6.0), ylim=(-6.0, 6.0))
    ax.set_axis_off()
    hull = patch_of(loop.buffer(1.0))
    hull.set(facecolor="black")
    ax.add_patch(hull)
    canvas = FigureCanvasAgg(fig)
    canvas.draw()
    shades = np.asarray(canvas.buffer_rgba())[50, :, 0]
    # From the border to the middle: the hull, then nothing.
    assert shades[8] < 50
    assert shades[50] > 200


def test_a_vehicle_that_stays_has_no_arrow(flat_plan: Plan) -> None:
    assert artists(plot_plan(flat_plan), "arrow:c") == []


def test_vehicles_planned_together_share_a_hue_but_not_a_color(flat_plan: Plan) -> None:
    ax = plot_plan(flat_plan)
    a, b, c = (artists(ax, f"path:{name}")[0].get_color() for name in "abc")
    assert hue(a) == pytest.approx(hue(b), abs=1e-6)
    assert a != b
    assert abs(hue(a) - hue(c)) > 0.1


def test_names_do_not_overlap_each_other(flat_plan: Plan) -> None:
    ax = plot_plan(flat_plan)
    ax.figure.draw_without_rendering()
    labels = [t for t in ax.texts if (t.get_gid() or "").startswith("label:")]
    boxes = [label.get_window_extent() for label in labels]
    assert len(boxes) == 6
    for i, first in enumerate(boxes):
        assert not any(first.overlaps(second) for second in boxes[i + 1 :])


def test_the_title_gives_cost_risk_seconds_and_planner(flat_plan: Plan) -> None:
    ax = plot_plan(flat_plan)
    (facts,) = (text.get_text() for text in ax.texts if text.get_gid() == "facts")
    for word in ("cost 12", "risk 0.0125 ≤ 0.05", "0.25 s", "ira, branch, centralized"):
        assert word in facts
    assert ax.get_title(loc="left").strip() == "bay"


def test_numbers_above_a_picture_are_no_other_than_the_verdict(flat_plan: Plan) -> None:
    def above(plan: Plan) -> dict[str, str]:
        return {text.get_gid(): text.get_text() for text in plot_plan(plan).texts}

    still = replace(flat_plan, cost=4.163e-17, risk=Risk(0.05, 0.04995))
    assert above(still)["facts"].startswith("cost 0 · risk 0.04995 ≤ 0.05 ·")
    over = above(replace(flat_plan, risk=Risk(0.05, 0.0500001)))
    assert "risk 0.05001 > 0.05 ·" in over["facts"]
    assert " ".join(over["alert"].split()) == "certificate 0.05001 exceeds the risk bound 0.05"
    least = above(replace(flat_plan, risk=Risk(1e-300, 1e-301)))
    assert "risk 1e-301 ≤ 1e-300 ·" in least["facts"]


def test_a_long_planner_name_gets_a_line_of_its_own(flat_plan: Plan) -> None:
    long = "optimal, branch, " + "x" * 60
    ax = plot_plan(replace(flat_plan, planner=long))
    (facts,) = (text.get_text() for text in ax.texts if text.get_gid() == "facts")
    assert " ".join(facts.splitlines()[1:]) == f"planner: {long}"


def test_a_certificate_above_the_bound_is_said_in_red(flat_plan: Plan) -> None:
    ax = plot_plan(replace(flat_plan, risk=Risk(0.05, 0.12)))
    (alert,) = (text for text in ax.texts if text.get_gid() == "alert")
    assert alert.get_text() == "certificate 0.12 exceeds the risk bound 0.05"
    assert alert.get_color() == ALERT


def test_a_certified_plan_has_no_alert(flat_plan: Plan) -> None:
    assert [t for t in plot_plan(flat_plan).texts if t.get_gid() == "alert"] == []


def test_no_plan_still_gives_the_scenario_and_says_so(empty_plan: Plan) -> None:
    ax = plot_plan(empty_plan)
    assert "no plan" in texts(ax)
    assert len(artists(ax, "start:a")) == 1
    assert artists(ax, "path:a") == []


def test_titles_lie_within_the_figure(flat_plan: Plan) -> None:
    ax = plot_plan(replace(flat_plan, risk=Risk(0.05, 0.12)))
    ax.figure.draw_without_rendering()
    box = ax.get_tightbbox()
    width, height = ax.figure.get_size_inches() * ax.figure.dpi
    assert box.x0 >= 0
    assert box.y0 >= 0
    assert box.x1 <= width + 1
    assert box.y1 <= height + 1


def test_given_axes_are_used_and_returned(flat_plan: Plan) -> None:
    figure = Figure()
    left, right = figure.subplots(1, 2)
    assert plot_scenario(flat_plan.scenario, left) is left
    assert plot_plan(flat_plan, right) is right
    assert len(figure.axes) == 2


def test_plotting_leaves_no_global_state(flat_plan: Plan) -> None:
    before = dict(matplotlib.rcParams)
    plot_plan(flat_plan)
    assert dict(matplotlib.rcParams) == before
    pyplot = pytest.importorskip("matplotlib.pyplot")
    assert pyplot.get_fignums() == []


@pytest.mark.slow
def test_space_gets_three_axes(space_plan: Plan) -> None:
    ax = plot_plan(space_plan)
    assert isinstance(ax, Axes3D)
    assert ax.get_zlabel() == "z [m]"
    names = {text.get_text().strip() for text in ax.texts}
    assert {"up", "down", "tower"} <= names
    (steps,) = artists(ax, "steps:up")
    np.testing.assert_allclose(np.array(steps.get_data_3d()).T[-1], [5.0, 5.0, 5.0])
    assert len(artists(ax, "ellipses:up")) == 1


def test_a_scenario_in_space_shows_its_workspace(space_scenario: Scenario) -> None:
    ax = plot_scenario(space_scenario)
    (edges,) = artists(ax, "workspace")
    assert len(edges._segments3d) == 12


def test_names_of_a_large_fleet_are_left_out() -> None:
    vehicles = [
        make_vehicle(f"v{i}", [3.0 * i, 0.0], [3.0 * i, 8.0]) for i in range(MAX_LABELS + 1)
    ]
    scenario = Scenario("fleet", 1.0, 4, 0.05, tuple(vehicles))
    ax = plot_plan(make_plan(scenario))
    assert not any(name.startswith("v") for name in texts(ax))
    assert len(artists(ax, "path:v7")) == 1
