from __future__ import annotations

import warnings

import radmpc
from radmpc.experiments.families import paper
from radmpc.model.plan import Plan
from radmpc.plotting import Panel, plot_panels
from radmpc.plotting.canvas.style import TITLE_SIZE


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
