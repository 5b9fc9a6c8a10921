from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import radmpc
from radmpc.experiments.families import paper
from radmpc.model.plan import Plan
from radmpc.plotting import (
    CostPoint,
    Panel,
    plot_costs,
    plot_couplings,
    plot_distances,
    plot_panels,
    plot_plan,
    plot_risk,
    plot_risk_shares,
    save_axes,
)
from radmpc.plotting.canvas.style import TITLE_SIZE

from .conftest import make_vehicle


def test_headlines_of_panels_are_as_large_and_bold_as_those_of_plans() -> None:
    plan = radmpc.plan(paper(2, seed=1), rng=0).require()
    figure = plot_panels([Panel("one", plan), Panel("two", plan)])
    for axes, headline in zip(figure.axes, ("one", "two"), strict=True):
        title = axes._left_title
        assert title.get_text().startswith(headline)
        assert title.get_fontsize() == TITLE_SIZE
        assert title.get_fontweight() == "bold"


def test_panels_in_space_are_laid_out_without_a_warning(space_plan: Plan) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = plot_panels([Panel(title, space_plan) for title in ("one", "two", "three")])
        figure.draw_without_rendering()
    for axes in figure.axes:
        box = axes.get_tightbbox(for_layout_only=True)
        assert 0.0 <= box.x0 < box.x1 <= figure.bbox.width


@pytest.mark.sampled(1)
@pytest.mark.parametrize("count", [3, 36, 64])
def test_what_edges_mean_stands_below_the_names(flat_plan: Plan, count: int) -> None:
    names = [f"v{k}" for k in range(count)]
    row = [make_vehicle(name, [2.0 * k, 0.0], [2.0 * k, 9.0]) for k, name in enumerate(names)]
    scenario = replace(flat_plan.scenario, vehicles=tuple(row), workspace=None)
    sets = tuple((name,) for name in names)
    plan = replace(flat_plan, scenario=scenario, sets=sets, couplings=())
    figure = Figure(figsize=(3.5, 6.2), dpi=200, layout="constrained")
    upper, lower = figure.subplots(2, 1, height_ratios=[3, 2])
    upper.plot([0.0, 1.0])
    for ax in (plot_couplings(plan), plot_couplings(plan, lower)):
        ax.figure.draw_without_rendering()
        named = {str(text.get_gid()): text.get_window_extent() for text in ax.texts}
        meaning = named.pop("meaning")
        assert len(named) == count
        assert all(meaning.y1 <= box.y0 for box in named.values())
        assert ax.figure.bbox.y0 <= meaning.y0


def tick_formulas(ax: Axes) -> list[bool]:
    """Whether each label of the axes' ticks that is no number alone is drawn as a formula."""
    ax.figure.draw_without_rendering()
    ticks = [*ax.get_xticklabels(), *ax.get_yticklabels()]
    return [tick.get_parse_math() for tick in ticks if "$" in tick.get_text()]


@pytest.mark.parametrize("is_last", [False, True])
def test_powers_of_ten_beside_a_plan_stay_formulas(flat_plan: Plan, is_last: bool) -> None:
    figure = Figure(layout="constrained")
    upper, lower = figure.subplots(2, 1)
    if is_last:
        lower.loglog([1e-4, 1e-1], [1.0, 1e3])
    plot_plan(flat_plan, upper)
    if not is_last:
        lower.loglog([1e-4, 1e-1], [1.0, 1e3])
    assert len(tick_formulas(lower)) > 3
    assert all(tick_formulas(lower))


def test_where_users_let_dollars_be_letters_a_plan_beside_keeps_them(flat_plan: Plan) -> None:
    with rc_context({"text.parse_math": False}):
        figure = Figure(layout="constrained")
        upper, lower = figure.subplots(2, 1)
        plot_plan(flat_plan, upper)
        lower.plot(["a$", "$b", "$c$", "$d$"], [1.0, 2.0, 3.0, 4.0])
        assert not any(tick_formulas(lower))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("draw", [plot_plan, plot_distances, plot_risk, plot_risk_shares])
def test_numbers_at_the_axes_are_read_where_a_style_writes_them_as_formulas(
    flat_plan: Plan, draw: Callable[..., Axes]
) -> None:
    with rc_context({"axes.formatter.use_mathtext": True}):
        for ax in (draw(flat_plan), draw(flat_plan, Figure().add_subplot())):
            assert all(tick_formulas(ax))


@pytest.mark.parametrize("values", [(0.001, 0.1), ("$x^$", "$\\frac$")])
def test_costs_have_their_unit_and_dollars_in_names_are_letters(
    values: tuple[float | str, ...], tmp_path: Path
) -> None:
    key = "vehicles.$x^$.radius"
    points = [CostPoint(v, curve, 2.0, 1.0, True) for curve in ("a$^$", "b$") for v in values]
    ax = plot_costs(key, points)
    save_axes(ax, tmp_path / "costs.png")
    assert ax.get_xlabel() == key
    assert ax.get_ylabel() == "cost [m/s²]"
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["a$^$", "b$"]
    if isinstance(values[0], float):
        assert all(tick_formulas(ax))
