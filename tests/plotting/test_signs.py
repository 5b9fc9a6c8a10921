from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.markers import MarkerStyle

from radmpc.model.plan import LedgerRow, Plan, Risk
from radmpc.model.scenario import Scenario
from radmpc.plotting import plot_plan, plot_scenario
from radmpc.plotting.canvas.style import ALERT, MAX_LABELS

from .conftest import make_plan, make_vehicle
from .test_pictures import artists, texts


def legend(ax: Axes) -> list[str]:
    return [text.get_text() for text in ax.get_legend().get_texts()]


def test_a_start_does_not_hide_the_goal_it_coincides_with(flat_scenario: Scenario) -> None:
    ax = plot_scenario(flat_scenario)
    ((start,), (goal,), (star,)) = (artists(ax, f"{x}:c") for x in ("start", "goal", "star"))
    assert start.get_facecolor()[3] == 0.0
    assert start.get_zorder() < goal.get_zorder() < star.get_zorder()


def test_the_worst_steps_are_ringed_where_the_bound_is_exceeded(flat_plan: Plan) -> None:
    rows = (
        LedgerRow("pair", "a", "b", 2, 0.08),
        LedgerRow("obstacle", "c", "ferry", 3, 0.0396),
        LedgerRow("workspace", "a", None, 1, 0.0004),
    )
    ax = plot_plan(replace(flat_plan, risk=Risk(0.05, 0.12, rows)))
    (pair,) = artists(ax, "worst:a:2")
    a, b = flat_plan.trajectories[:2]
    np.testing.assert_allclose(pair.get_xydata(), [a.means[2, :2], b.means[2, :2]])
    assert to_hex(pair.get_color()) == ALERT.lower()
    assert len(artists(ax, "worst:c:3")) == 1
    assert artists(ax, "worst:a:1") == []
    assert legend(ax)[-1] == "most risk"


def test_within_the_bound_nothing_is_ringed(flat_plan: Plan) -> None:
    rows = (LedgerRow("pair", "a", "b", 2, 0.04),)
    ax = plot_plan(replace(flat_plan, risk=Risk(0.05, 0.04, rows)))
    assert artists(ax, "worst:a:2") == []
    assert "most risk" not in legend(ax)


def test_some_steps_have_numbers_but_not_of_a_vehicle_that_stays(flat_plan: Plan) -> None:
    ax = plot_plan(flat_plan)
    for k in (1, 2, 3):
        (number,) = artists(ax, f"step:a:{k}")
        assert number.get_text() == str(k)
    assert artists(ax, "step:a:4") == []
    assert artists(ax, "step:c:2") == []


def test_the_legend_tells_of_numbers_of_steps_only_where_there_are_any(flat_plan: Plan) -> None:
    still = make_vehicle("still", [1.0, 1.0], [1.0, 1.0])
    many = tuple(
        make_vehicle(f"v{i}", [3.0 * i, 0.0], [3.0 * i, 5.0]) for i in range(MAX_LABELS + 1)
    )
    for vehicles, is_told in (((still,), False), (many, False), (many[1:], True)):
        given = replace(flat_plan.scenario, vehicles=vehicles, obstacles=(), workspace=None)
        plan = make_plan(given)
        ax = plot_plan(plan)
        legend = [text.get_text() for text in ax.get_legend().get_texts()]
        assert ("mean path, step no." if is_told else "mean path") in legend
        assert any(text.get_gid().startswith("step:") for text in ax.texts if text.get_gid()) is (
            is_told
        )


def test_a_moving_obstacle_shows_its_way_and_its_name_where_it_starts(
    flat_scenario: Scenario,
) -> None:
    ax = plot_scenario(flat_scenario)
    (way,) = artists(ax, "way:ferry")
    np.testing.assert_allclose(way.get_xydata()[[0, -1]], [[7.5, 7.5], [11.5, 7.5]])
    (arrow,) = artists(ax, "direction:ferry")
    assert arrow.xy == pytest.approx((11.5, 7.5))
    assert [len(artists(ax, f"step:ferry:{k}")) for k in range(5)] == [0, 1, 1, 1, 0]
    assert texts(ax)["ferry"].get_position()[0] < 9.0
    assert artists(ax, "way:wall") == []


def test_vehicles_planned_together_differ_in_line_style(flat_plan: Plan) -> None:
    ax = plot_plan(flat_plan)
    a, b, c = (artists(ax, f"path:{name}")[0].get_linestyle() for name in "abc")
    assert a == c == "-"
    assert b == "--"


def test_dashed_paths_are_in_the_legend_where_there_are_any(flat_plan: Plan) -> None:
    assert "same set (first solid)" in legend(plot_plan(flat_plan))
    alone = replace(flat_plan, sets=(("a",), ("b",), ("c",)))
    assert "same set (first solid)" not in legend(plot_plan(alone))


def test_without_a_plan_the_reason_is_told_and_no_path_explained(empty_plan: Plan) -> None:
    ax = plot_plan(replace(empty_plan, explanation="too tight " * 20))
    (why,) = artists(ax, "explanation")
    assert why.get_text().startswith("too tight too tight")
    assert 1 < len(why.get_text().splitlines()) <= 5
    assert legend(ax) == ["start", "goal"]


def test_run_time_and_planner_can_be_left_out(flat_plan: Plan) -> None:
    ax = plot_plan(flat_plan, details=False)
    (facts,) = artists(ax, "facts")
    assert facts.get_text() == "cost 12 · risk 0.0125 ≤ 0.05"


@pytest.mark.sampled(1)
@pytest.mark.slow
@pytest.mark.parametrize("kind", ["flat_plan", "empty_plan", "space_plan"])
def test_nothing_touches_the_edges(kind: str, request: pytest.FixtureRequest) -> None:
    plan = request.getfixturevalue(kind)
    square = replace(plan, scenario=replace(plan.scenario, name="Square"))
    ax = plot_plan(square)
    ax.figure.draw_without_rendering()
    box, height = ax.get_tightbbox(), ax.figure.get_figheight() * ax.figure.dpi
    assert box.y0 >= 1
    assert box.y1 <= height - 8


@pytest.mark.slow
def test_space_shows_shadows_and_few_ellipsoids_and_stars_in_front(space_plan: Plan) -> None:
    ax = plot_plan(space_plan)
    (shadow,) = artists(ax, "shadow:up")
    assert np.ptp(shadow.get_data_3d()[2]) == 0.0
    (rings,) = artists(ax, "ellipses:up")
    assert len(rings._segments3d) == 3 * 4
    (star,), (path,) = artists(ax, "goal:up"), artists(ax, "path:up")
    assert star.get_zorder() > path.get_zorder()
    assert len(artists(ax, "step:up:2")) == 1


@pytest.mark.parametrize(("inches", "heads"), [(3.5, 2), (0.9, 1), (0.3, 0)])
def test_a_path_has_as_many_arrow_heads_as_leave_it_to_be_seen(
    flat_plan: Plan, inches: float, heads: int
) -> None:
    ax = Figure(figsize=(inches, inches)).add_axes((0.0, 0.0, 1.0, 1.0))
    plot_plan(flat_plan, ax)
    assert len(artists(ax, "arrow:b")) == heads


def test_arrow_heads_are_narrow_point_along_the_path_and_stand_between_steps(
    flat_plan: Plan,
) -> None:
    ax = plot_plan(flat_plan)
    steps = flat_plan.trajectories[1].means[:, :2]
    for head in artists(ax, "arrow:b"):
        marker = MarkerStyle(head.get_marker())
        length, width = np.ptp(marker.get_path().vertices, axis=0)
        assert length > 2.0 * width
        # From (3, 9) down to (3, 1).
        tip = head._marker.get_transform().transform(marker.get_path().vertices)[0]
        np.testing.assert_allclose(tip / np.linalg.norm(tip), [0.0, -1.0], atol=1e-9)
        apart = np.abs(np.ravel(head.get_data())[1] - steps[:, 1])
        assert apart.min() > 0.3 * np.sort(apart)[:2].sum()
