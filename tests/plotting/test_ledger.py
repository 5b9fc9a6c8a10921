from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from radmpc.model.plan import LedgerRow, Plan, Risk
from radmpc.model.scenario import Scenario
from radmpc.plotting import plot_ledger, plot_risk_map, plot_risk_shares, save_ledger
from radmpc.plotting.canvas.style import ALERT
from radmpc.plotting.risk.ledger_rows import map_rows, share_rows

from .conftest import make_plan, make_vehicle

ROWS = (
    LedgerRow("pair", "a", "b", 1, 0.01),
    LedgerRow("pair", "a", "b", 2, 0.002),
    LedgerRow("obstacle", "c", "ferry", 3, 0.004),
    LedgerRow("workspace", "c", None, 4, 0.001),
    LedgerRow("pair", "a", None, 0, 1e-18),
)


@pytest.fixture
def spent(flat_plan: Plan) -> Plan:
    """Three causes and a trifle; 0.017 of 0.05 spent."""
    return replace(flat_plan, risk=Risk(0.05, 0.017, ROWS))


def artist(ax: Axes, gid: str) -> object:
    """The one artist with an id."""
    (found,) = [child for child in ax.get_children() if child.get_gid() == gid]
    return found


def row_names(ax: Axes) -> list[str]:
    return [label.get_text() for label in ax.get_yticklabels()]


def test_the_map_shows_powers_of_ten_by_cause_and_step(spent: Plan) -> None:
    ax = plot_risk_map(spent)
    powers = artist(ax, "risk-map").get_array()
    assert row_names(ax) == ["a – b", "c, ferry", "c, workspace", "1 other"]
    assert powers.shape == (4, spent.scenario.horizon + 1)
    assert powers[0, 1] == pytest.approx(-2.0)
    assert powers[1, 3] == pytest.approx(np.log10(0.004))
    assert powers.mask.sum() == powers.size - 4


def test_each_row_of_the_map_tells_its_share_of_the_bound(spent: Plan) -> None:
    ax = plot_risk_map(spent)
    assert artist(ax, "share:a – b").get_text() == "24.0 %"
    assert artist(ax, "share:1 other").get_text() == "< 0.1 %"


def test_at_most_twenty_causes_get_a_row_and_nothing_is_lost(flat_plan: Plan) -> None:
    rows = tuple(LedgerRow("obstacle", "a", f"o{i}", i % 5, 0.001 + 1e-5 * i) for i in range(30))
    names, risks = map_rows(replace(flat_plan, risk=Risk(0.05, 0.03, rows)), 8)
    assert len(names) == len(risks) == 21
    assert names[0] == "a, o29"
    assert names[-1] == "10 others"
    assert risks.sum() == pytest.approx(sum(row.risk for row in rows))


def test_the_color_bar_has_whole_powers_and_a_unit(spent: Plan) -> None:
    figure = plot_risk_map(spent).figure
    bar = figure.axes[1]
    assert "log₁₀" in bar.get_xlabel()
    assert all(float(tick).is_integer() for tick in bar.get_xticks())
    assert figure.axes[0].get_xlabel() == "step [-]"


def test_vehicles_share_a_pair_half_and_half(spent: Plan) -> None:
    ax = plot_risk_shares(spent)
    assert artist(ax, "pair:a").get_width() == pytest.approx(12.0)
    assert artist(ax, "pair:b").get_width() == pytest.approx(12.0)
    assert artist(ax, "obstacle:c").get_width() == pytest.approx(8.0)
    assert artist(ax, "workspace:c").get_x() == pytest.approx(8.0)
    assert ax.get_xlabel() == "share of Δ [%]"


def test_bars_and_the_unused_rest_make_up_the_bound(spent: Plan) -> None:
    ax = plot_risk_shares(spent)
    assert artist(ax, "unused").get_width() == pytest.approx(66.0)
    assert row_names(ax)[-1] == "unused"
    assert sum(patch.get_width() for patch in ax.patches) == pytest.approx(100.0)


def test_an_excess_is_red_and_named(spent: Plan) -> None:
    over = replace(spent, risk=Risk(0.01, 0.017, ROWS))
    ax = plot_risk_shares(over)
    assert row_names(ax)[-1] == "above Δ"
    assert artist(ax, "unused").get_width() == pytest.approx(70.0)
    assert to_hex(artist(ax, "unused").get_facecolor()) == ALERT.lower()


def test_of_many_vehicles_the_largest_stand_alone() -> None:
    vehicles = [make_vehicle(f"v{i}", [3.0 * i, 0.0], [3.0 * i, 8.0]) for i in range(24)]
    plan = make_plan(Scenario("fleet", 1.0, 4, 0.05, tuple(vehicles)))
    rows = tuple(LedgerRow("workspace", f"v{i}", None, 0, 1e-4 * (i + 1)) for i in range(24))
    names, shares = share_rows(replace(plan, risk=Risk(0.05, 0.03, rows)))
    assert names[0] == "v23"
    assert names[-1] == "4 others"
    assert shares[-1].sum() == pytest.approx(0.02)


def test_the_whole_picture_has_both_parts_and_the_certificate(spent: Plan) -> None:
    figure = plot_ledger(spent)
    assert [ax.get_title(loc="left") for ax in figure.axes[:2]] == [
        "by cause and step",
        "by vehicle",
    ]
    (text,) = [t for t in figure.texts if t.get_gid() == "certificate"]
    assert text.get_text() == "risk at most 0.017, within Δ = 0.05"
    assert figure.get_figwidth() == 3.5


def test_a_sum_above_one_is_told_as_such_and_in_red(flat_plan: Plan) -> None:
    rows = tuple(LedgerRow("pair", "a", "b", k, 1.0) for k in range(4))
    figure = plot_ledger(replace(flat_plan, risk=Risk(0.05, 4.0, rows)))
    (text,) = [t for t in figure.texts if t.get_gid() == "certificate"]
    assert text.get_text() == "risk at most 1 (the bounds sum to 4): ABOVE Δ = 0.05"
    assert text.get_color() == ALERT


def test_everything_lies_within_the_figure(flat_plan: Plan) -> None:
    rows = tuple(LedgerRow("pair", "a", "b", k, 1.0) for k in range(4))
    figure = plot_ledger(replace(flat_plan, risk=Risk(0.05, 4.0, rows)))
    figure.draw_without_rendering()
    box, (width, height) = figure.get_tightbbox(), figure.get_size_inches()
    assert box.x0 >= -0.01
    assert box.y0 >= -0.01
    assert box.x1 <= width + 0.01
    assert box.y1 <= height + 0.01


def test_without_a_plan_the_picture_says_so(empty_plan: Plan) -> None:
    figure = plot_ledger(empty_plan)
    assert [ax.texts[0].get_text() for ax in figure.axes] == ["no plan", "no plan"]


def test_a_plan_without_any_risk_has_an_empty_map(flat_plan: Plan) -> None:
    plan = replace(flat_plan, risk=Risk(0.05, 0.0))
    assert plot_risk_map(plan).texts[0].get_text() == "no risk at all"
    assert artist(plot_risk_shares(plan), "unused").get_width() == pytest.approx(100.0)


def test_a_plan_nobody_certified_says_so(flat_plan: Plan) -> None:
    assert plot_risk_map(replace(flat_plan, risk=Risk(0.05))).texts[0].get_text() == (
        "no certificate"
    )


def test_given_axes_are_drawn_on_and_nothing_global_changes(spent: Plan) -> None:
    before = dict(matplotlib.rcParams)
    left, right = Figure().subplots(1, 2)
    assert plot_risk_map(spent, left) is left
    assert plot_risk_shares(spent, right) is right
    assert dict(matplotlib.rcParams) == before


def test_long_names_leave_room_and_are_told_apart_by_their_ends(flat_plan: Plan) -> None:
    rows = tuple(
        LedgerRow("obstacle", "a", f"the-old-lighthouse-{number}", 1, risk)
        for number, risk in ((1, 0.01), (2, 0.005))
    )
    names, _ = map_rows(replace(flat_plan, risk=Risk(0.05, 0.015, rows)), 8)
    assert names == ["a, the-o…ouse-1", "a, the-o…ouse-2"]


@pytest.mark.slow
def test_a_ledger_is_saved_as_the_suffix_says(spent: Plan, tmp_path: Path) -> None:
    save_ledger(spent, tmp_path / "risk.pdf")
    assert (tmp_path / "risk.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize("count", [1, 3])
def test_a_map_of_few_rows_keeps_its_label_off_the_color_bar(spent: Plan, count: int) -> None:
    rows = ROWS[:count]
    figure = plot_ledger(replace(spent, risk=Risk(0.05, 0.017, rows)))
    figure.draw_without_rendering()
    upper, _, bar = figure.axes
    assert upper.xaxis.label.get_window_extent().y0 > bar.get_window_extent().y1
    share = artist(upper, "share").get_window_extent()
    above = share.y0 - upper.get_window_extent().y1
    assert 0.0 < above < share.height
