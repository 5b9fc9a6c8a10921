"""Pictures and films of a flight show what was flown."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from recorded_flights import drifting

import radmpc
from radmpc.errors import ArgumentError, ArgumentTypeError
from radmpc.io.flight.record import FlightRecord, FlightSettings, Touch
from radmpc.model.scenario import Workspace
from radmpc.plotting.film.animation import FRAMES_PER_STEP
from radmpc.plotting.flight.film import make_flight_film

KEPT = FlightSettings(replan=None, missions=3, seed=1)


ROOM = [-3.0, -6.0], [12.0, 6.0]
"""Corners of a workspace in the plane, as high as leaves the account a little less than an inch."""

DIMENSIONS = [pytest.param(2, id="plane"), pytest.param(3, id="space", marks=pytest.mark.nightly)]


@pytest.fixture(scope="module", params=DIMENSIONS)
def record(request: pytest.FixtureRequest) -> FlightRecord:
    return radmpc.begin_flight(drifting(request.param), KEPT)


def artist(axes: Axes, gid: str) -> object:
    return next(a for a in axes.get_children() if a.get_gid() == gid)


def test_a_picture_shows_paths_over_the_plan_and_the_account_beneath(record: FlightRecord) -> None:
    axes = radmpc.plot_flight(record)
    for number in range(3):
        last = artist(axes, f"flown:{number}:a").get_xydata()[-1]
        assert np.array_equal(last, record.missions[number].rows[-1].states[0][:2])
    assert np.allclose(artist(axes, "planned:a").get_xydata()[-1], [6.0, 0.0])
    account = axes.figure.axes[1]
    wealth = artist(account, "wealth").get_ydata()
    rows = record.missions[0].rows
    assert wealth.tolist() == pytest.approx([row.bank + row.tail for row in rows])
    assert [gid for a in axes.get_children() if (gid := str(a.get_gid())).startswith("cont")] == []


def test_the_label_beside_long_numbers_of_the_account_is_whole(record: FlightRecord) -> None:
    # Two lines of facts above a map as high: the panel beneath becomes lower in a layout.
    d = record.plan.scenario.dimension
    workspace = Workspace(np.array([-3.0, -2.0, -2.0])[:d], np.array([13.0, 11.0, 11.0])[:d])
    plan = replace(record.plan, scenario=replace(record.plan.scenario, workspace=workspace))
    settings = replace(record.settings, replan="certified")
    for remaining in (0.05, 0.092, 0.1, 0.104, 0.22):
        rows = tuple(replace(row, wealth=remaining, bank=remaining) for row in record.rows)
        shown = replace(record, plan=plan, settings=settings, rows=rows)
        figure = radmpc.plot_flight(shown).figure
        figure.draw_without_rendering()
        beneath = figure.axes[1].yaxis
        label = beneath.label.get_window_extent()
        assert label.x0 >= 0.0
        assert not any(label.overlaps(t.get_window_extent()) for t in beneath.get_ticklabels())


def test_the_mission_that_hit_something_is_the_one_that_is_shown(record: FlightRecord) -> None:
    rows = list(record.rows)
    at = next(i for i, row in enumerate(rows) if (row.mission, row.step) == (2, 3))
    rows[at] = replace(rows[at], contacts=(Touch(3, "obstacle", "a", "rock"),))
    axes = radmpc.plot_flight(replace(record, rows=tuple(rows)))
    [place] = artist(axes, "contact:2:a").get_xydata()
    assert place.tolist() == rows[at].states[0][:2].tolist()
    assert artist(axes, "steps:2:a").get_xydata().shape == (7, 2)
    facts = next(t.get_text() for t in axes.figure.texts if t.get_gid() == "facts")
    assert facts == "flown with model, as planned · 1 of 3 missions hit something"


def test_a_single_mission_is_told_of_as_one_of_many(record: FlightRecord) -> None:
    rows = tuple(row for row in record.rows if row.mission == 0)
    one = replace(record, settings=replace(record.settings, missions=1), rows=rows)
    assert repr(one).endswith("1 of 1 missions over, 7 ticks)")
    axes = radmpc.plot_flight(one)
    facts = next(t.get_text() for t in axes.figure.texts if t.get_gid() == "facts")
    assert facts.endswith("0 of 1 missions hit something")


@pytest.mark.parametrize("largest", [0.099, 0.2])
def test_the_label_of_the_account_is_within_the_picture_as_it_is_written(
    record: FlightRecord, tmp_path: Path, largest: float
) -> None:
    rows = tuple(replace(row, wealth=largest) for row in record.rows)
    room = radmpc.Workspace(*(np.resize(c, record.plan.scenario.dimension) for c in ROOM))
    scenario = replace(record.plan.scenario, risk_bound=0.05, workspace=room)
    plan = replace(record.plan, scenario=scenario)
    settings = replace(record.settings, replan="certified")
    axes = radmpc.plot_flight(replace(record, plan=plan, settings=settings, rows=rows))
    axes.figure.savefig(tmp_path / "flight.png")
    account = axes.figure.axes[1]
    assert account.yaxis.label.get_window_extent().x0 >= 0.0
    low, high = account.get_ylim()
    assert low == 0.0
    assert 3 <= sum(tick <= high for tick in account.get_yticks()) <= 6


def test_discs_of_what_is_to_come_shrink_as_a_film_goes_on(record: FlightRecord) -> None:
    film = make_flight_film(record)
    assert film.num_frames == 6 * FRAMES_PER_STEP + 1
    axes = film.figure.axes[0]
    widths = []
    for step in range(7):
        film.show(step * FRAMES_PER_STEP)
        outlines = [path.vertices for path in artist(axes, "ahead:a").get_paths()]
        assert len(outlines) == 6 - step
        widths.append(max((float(np.ptp(o[:, 0])) for o in outlines), default=0.0))
        place = record.missions[0].rows[step].states[0][:2]
        assert np.allclose(artist(axes, "vehicle:a").center, place)
        assert artist(axes, "trail:a").get_xydata().shape == (step * FRAMES_PER_STEP + 1, 2)
    assert widths == sorted(widths, reverse=True)
    assert widths[0] > 1.1 * widths[4] > widths[5] > 0.0
    # Six deviations of the noise of one step.
    assert widths[5] == pytest.approx(0.6, rel=0.01)


def test_a_flight_that_was_cut_short_is_drawn_as_far_as_it_goes(record: FlightRecord) -> None:
    cut = replace(record, rows=record.rows[:4])
    axes = radmpc.plot_flight(cut)
    assert artist(axes, "steps:0:a").get_xydata().shape == (4, 2)
    assert make_flight_film(cut).num_frames == 3 * FRAMES_PER_STEP + 1
    with pytest.raises(ArgumentError, match="at least one tick, got a flight that never began"):
        radmpc.plot_flight(replace(record, rows=()))
    with pytest.raises(ArgumentTypeError, match=r"record must be a FlightRecord, got 'a\.jsonl'"):
        radmpc.plot_flight("a.jsonl")


def test_a_flight_in_space_is_seen_from_above() -> None:
    record = radmpc.begin_flight(drifting(3), replace(KEPT, missions=1))
    axes = radmpc.plot_flight(record)
    last = artist(axes, "flown:0:a").get_xydata()[-1]
    assert np.array_equal(last, record.rows[-1].states[0][:2])
    film = make_flight_film(record)
    film.show(film.num_frames - 1)
    assert np.allclose(artist(film.figure.axes[0], "vehicle:a").center, last)
