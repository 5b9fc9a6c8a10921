"""Legends and headlines stay within their figures, however many signs and letters there are."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.text import Text

from radmpc import Keep, Obstacle, Scenario, Visit
from radmpc.model.plan import LedgerRow, Plan, Risk
from radmpc.model.relations.concerns import all_but
from radmpc.plotting import (
    Chart,
    Panel,
    animate_plan,
    plot_chart,
    plot_couplings,
    plot_distances,
    plot_ledger,
    plot_plan,
    plot_risk,
    plot_scenario,
    save_animation,
    save_axes,
    save_figure,
    save_ledger,
    save_panels,
)
from radmpc.plotting.canvas.columns import columns_within, lines_within
from radmpc.plotting.canvas.headline import shorten
from radmpc.plotting.chart import Spread

from .conftest import HORIZON, make_plan, make_vehicle


def crowded(dimension: int, *, is_zoned: bool = True) -> Plan:
    """A plan with every sign that a legend can hold: visits, ranges, noise, who passes through.

    Without a zone that one passes through, ten signs are left.
    """
    up = [2.0] * (dimension - 2)
    first = make_vehicle("a", [1.0, 1.0, *up], [9.0, 9.0, *up])
    first = replace(first, via=(Visit.at([5.0, 5.0, *up], 0.5),))
    second = make_vehicle("b", [1.0, 9.0, *up], [9.0, 2.0, *up])
    zone = Obstacle.box("zone", [4.0] * dimension, [5.0] * dimension)
    still = [0.0] * (dimension - 2)
    ship = Obstacle.tracked("ship", _cube(dimension), [2.0, 3.0, *up, 1.0, 0.0, *still], 0.01)
    obstacles = [all_but(zone, ["a"]), ship] if is_zoned else [ship]
    keep = [Keep(["a", "b"], 20.0)]
    given = Scenario("crowd", 1.0, HORIZON, 0.05, [first, second], obstacles, keep=keep)
    return make_plan(given, (("a", "b"),))


def long_names(plan: Plan) -> Plan:
    """The same plan of vehicles whose names are long."""
    vehicles = [replace(v, name=f"{v.name}, on reconnaissance") for v in plan.scenario.vehicles]
    scenario = replace(plan.scenario, vehicles=vehicles, keep=(), obstacles=())
    return make_plan(scenario, (tuple(v.name for v in vehicles),))


def _cube(dimension: int) -> np.ndarray:
    return np.array(np.meshgrid(*[[-0.5, 0.5]] * dimension)).reshape(dimension, -1).T


def drawn_legend(figure: Figure) -> Legend:
    """The one legend of a figure that is laid out as it will be written."""
    figure.draw_without_rendering()
    (found,) = figure.findobj(Legend)
    return found


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_legend_with_every_sign_stays_within_the_picture(dimension: int) -> None:
    figure = plot_plan(crowded(dimension)).figure
    legend = drawn_legend(figure)
    assert {
        "visit, no. ①",
        "range, widest",
        "for some only",
        "when nearest",
        "same set (first solid)",
    } <= {text.get_text() for text in legend.get_texts()}
    box = legend.get_window_extent()
    assert 0.0 <= box.x0 < box.x1 <= figure.bbox.width
    assert box.y0 >= 0.0


def test_below_flat_panels_in_space_obstacles_for_some_are_hatched_as_there() -> None:
    figure = plot_plan(crowded(3)).figure
    legend = drawn_legend(figure)
    told = [text.get_text() for text in legend.get_texts()]
    [drawn] = [p for p in figure.axes[0].patches if p.get_gid() == "obstacle:zone"]
    sign = legend.legend_handles[told.index("for some only")]
    assert sign.get_hatch() == drawn.get_hatch() == "////"


@pytest.mark.parametrize("is_zoned", [True, False])
def test_a_crowded_legend_leaves_the_map_its_width(is_zoned: bool) -> None:
    ax = plot_plan(crowded(2, is_zoned=is_zoned))
    legend = drawn_legend(ax.figure).get_window_extent()
    assert ax.get_window_extent().width > 0.8 * ax.figure.bbox.width
    assert not legend.overlaps(ax.get_window_extent())
    assert 0.0 <= legend.x0 < legend.x1 <= ax.figure.bbox.width


@pytest.mark.parametrize("dimension", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_nothing_is_warned_of_when_a_crowded_plan_is_drawn(dimension: int, tmp_path: Path) -> None:
    plan = crowded(dimension, is_zoned=dimension == 3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        save_figure(plan, tmp_path / "plan.png")
        save_animation(plan, tmp_path / "plan.gif", frames_per_step=1)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_legend_of_a_film_stays_within_it(dimension: int) -> None:
    film = animate_plan(crowded(dimension), frames_per_step=1)
    film._draw_was_started = True
    legend = drawn_legend(film._fig)
    box = legend.get_window_extent()
    assert 0.0 <= box.x0 < box.x1 <= film._fig.bbox.width
    assert box.y0 >= 0.0


@pytest.mark.parametrize("change", [lambda plan: plan, long_names])
def test_the_causes_in_a_ledger_stand_beside_the_heading_not_on_it(change) -> None:
    plan = change(crowded(2, is_zoned=False))
    one, other = (vehicle.name for vehicle in plan.scenario.vehicles)
    rows = (
        LedgerRow("pair", one, other, 1, 0.004),
        LedgerRow("obstacle", one, None, 2, 0.003),
        LedgerRow("workspace", other, None, 2, 0.003),
        LedgerRow("range", one, other, 3, 0.002),
    )
    figure = plot_ledger(replace(plan, risk=Risk(0.05, 0.012, rows)))
    legend = drawn_legend(figure).get_window_extent()
    (heading,) = [t for t in figure.findobj(Text) if t.get_text() == "by vehicle"]
    assert not legend.overlaps(heading.get_window_extent())
    assert legend.x1 <= figure.bbox.width


def test_long_names_of_encounters_take_lines_and_the_picture_grows() -> None:
    plan = crowded(2)
    usual, ax = plot_distances(plan), plot_distances(long_names(plan_of_four(plan)))
    usual.figure.draw_without_rendering()
    legend = drawn_legend(ax.figure).get_window_extent()
    assert 0.0 <= legend.x0 < legend.x1 <= ax.figure.bbox.width
    assert legend.y0 >= 0.0
    assert ax.figure.get_figheight() > usual.figure.get_figheight()
    assert ax.get_window_extent().height > 0.9 * usual.get_window_extent().height


def plan_of_four(plan: Plan) -> Plan:
    """Twice as many vehicles, whose six pairs are all worth a line."""
    one, other = plan.scenario.vehicles
    more = [make_vehicle("c", [1.0, 3.0], [9.0, 6.0]), make_vehicle("d", [1.0, 6.0], [9.0, 3.0])]
    return make_plan(replace(plan.scenario, vehicles=[one, other, *more]))


def test_long_labels_of_a_chart_stand_below_each_other() -> None:
    labels = [f"the planner that was the {number} one to be tried here" for number in "12"]
    spreads = [Spread(label, [1.0, 2.0], [1, 1], [2, 2], [3, 3]) for label in labels]
    figure = plot_chart(Chart(spreads, "", "vehicles", "seconds")).figure
    legend = drawn_legend(figure).get_window_extent()
    assert 0.0 <= legend.x0 < legend.x1 <= figure.bbox.width


def test_a_legend_has_the_fewest_lines_that_fit_its_width() -> None:
    entries = {f"an entry of some length {i}": Line2D([], []) for i in range(7)}
    lines = [lines_within(entries, width, {}) for width in (0.1, 3.0, 5.0, 99.0)]
    assert lines[0] == 7
    assert lines == sorted(lines, reverse=True)
    assert lines[-1] == 1
    assert columns_within(entries, 99.0, {}, most=3) == 3
    assert columns_within({}, 1.0, {}) == 1


LONG = "a name that goes on and on " * 7


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("draw", "dimension"),
    [
        (plot_plan, 2),
        (plot_plan, 3),
        (plot_distances, 2),
        (plot_risk, 2),
        (plot_couplings, 2),
        (plot_ledger, 2),
    ],
)
def test_a_long_name_of_a_scenario_is_cut_and_shrinks_nothing(draw, dimension: int) -> None:
    plan = crowded(dimension)
    long = replace(plan, scenario=replace(plan.scenario, name=LONG))
    usual, figure = (
        found if isinstance(found := draw(one), Figure) else found.figure for one in (plan, long)
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        usual.draw_without_rendering()
        figure.draw_without_rendering()
    [headline] = [t for t in figure.findobj(Text) if t.get_text().startswith("a name that")]
    assert "…" in headline.get_text()
    assert headline.get_window_extent().x1 <= figure.bbox.width
    for one, other in zip(usual.axes, figure.axes, strict=True):
        assert other.get_window_extent().width == pytest.approx(
            one.get_window_extent().width, rel=0.02
        )


def test_a_headline_that_fits_is_not_cut_and_one_that_does_not_keeps_its_ending() -> None:
    assert shorten("bay", 3.0, ": 2 sets") == "bay: 2 sets"
    cut = shorten(LONG, 2.0, ": 2 sets")
    assert cut.startswith("a name")
    assert cut.endswith("…: 2 sets")
    assert shorten(LONG, 0.01) == "a…"


def test_dollars_in_names_are_letters_and_no_formulas(tmp_path: Path) -> None:
    plan = crowded(2)
    names = {"a": "a$b{$", "b": "$\\frac$"}
    vehicles = [replace(v, name=names[v.name]) for v in plan.scenario.vehicles]
    scenario = replace(
        plan.scenario, name="$x^$", vehicles=vehicles, keep=(),
        obstacles=[Obstacle.box("o $\\sqrt$", [4.0, 4.0], [5.0, 5.0])],
    )  # fmt: skip
    rows = (LedgerRow("pair", *names.values(), 1, 0.01),)
    dear = replace(make_plan(scenario, (tuple(names.values()),)), risk=Risk(0.05, 0.01, rows))
    for draw in (plot_plan, plot_distances, plot_risk, plot_couplings):
        save_axes(draw(dear), tmp_path / "own.png")
        ax = Figure().add_subplot()
        save_axes(draw(dear, ax), tmp_path / "other.png")
        assert ax.get_title(loc="left").startswith("$x^$")
    save_axes(plot_scenario(scenario), tmp_path / "scenario.png")
    save_ledger(dear, tmp_path / "ledger.png")
    save_panels([Panel("$y^$", dear)], tmp_path / "panels.png")
    save_animation(dear, tmp_path / "film.gif", frames_per_step=1)
