"""Numbers at the axes: legible far from the origin, and beside short sides."""

from __future__ import annotations

from itertools import pairwise

import pytest

from radmpc.model.scenario import Scenario
from radmpc.plotting import plot_distances, plot_plan

from .conftest import make_plan, make_vehicle


def lone(start: list[float], goal: list[float]) -> Scenario:
    return Scenario("far", 1.0, 4, 0.05, (make_vehicle("a", start, goal),))


@pytest.mark.parametrize(
    ("start", "goal"),
    [([5e5, 6e6], [5e5 + 6.0, 6e6 + 3.0]), ([0.0, 0.0], [3e7, 2e7])],
)
def test_what_ticks_have_in_common_covers_no_fact(start: list[float], goal: list[float]) -> None:
    ax = plot_plan(make_plan(lone(start, goal)))
    ax.figure.draw_without_rendering()
    common = ax.yaxis.get_offset_text()
    assert common.get_text()
    [facts] = [text for text in ax.texts if text.get_gid() == "facts"]
    box = common.get_window_extent()
    assert not box.overlaps(facts.get_window_extent())
    assert not box.overlaps(ax.title.get_window_extent())
    low, high = ax.get_ylim()
    drawn = [one for one in ax.get_yticklabels() if low <= one.get_position()[1] <= high]
    assert not any(box.overlaps(tick.get_window_extent()) for tick in drawn)
    assert box.x0 >= ax.figure.bbox.x0
    assert box.y1 <= ax.figure.bbox.y1


def test_what_distances_have_in_common_is_no_larger_than_they() -> None:
    vehicles = (
        make_vehicle("a", [0.0, 0.0], [3e7, 0.0]),
        make_vehicle("b", [0.0, 1e7], [3e7, 1e7]),
    )
    ax = plot_distances(make_plan(Scenario("far", 1.0, 4, 0.05, vehicles)))
    ax.figure.draw_without_rendering()
    common, (tick, *_) = ax.yaxis.get_offset_text(), ax.get_yticklabels()
    assert common.get_text() == "1e7"
    assert common.get_fontsize() == tick.get_fontsize()


def test_where_nothing_is_near_the_red_line_is_named_above_the_numbers() -> None:
    ax = plot_distances(make_plan(lone([0.0, 0.0], [4.0, 0.0])))
    ax.figure.draw_without_rendering()
    [name] = [text for text in ax.texts if text.get_text() == "hulls touch"]
    assert name.get_window_extent().y0 >= ax.bbox.y0


@pytest.mark.parametrize("short", [0, 1])
def test_numbers_beside_a_short_side_in_space_do_not_overlap(short: int) -> None:
    goal = [60000.0, 60000.0, 10000.0]
    goal[short] = 15000.0
    ax = plot_plan(make_plan(lone([0.0, 0.0, 0.0], goal)))
    ax.figure.draw_without_rendering()
    ticks = (ax.xaxis, ax.yaxis)[short].get_major_ticks()
    boxes = [tick.label1.get_window_extent() for tick in ticks if tick.label1.get_text()]
    assert len(boxes) >= 2
    assert not any(one.overlaps(two) for one, two in pairwise(boxes))
