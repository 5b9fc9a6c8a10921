"""Couplings, distances and risk over time."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import shapely
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import minimize

from radmpc.geometry import box
from radmpc.model.plan import Coupling, LedgerRow, Plan, Risk
from radmpc.model.scenario import Scenario
from radmpc.plotting import Chart, plot_chart, plot_couplings, plot_distances, plot_risk
from radmpc.plotting.clearances import closest_clearances
from radmpc.plotting.nearest import nearest_of

from .conftest import HORIZON, make_plan, make_vehicle


def artists(ax: Axes, gid: str) -> list[object]:
    return [child for child in ax.get_children() if child.get_gid() == gid]


def texts(ax: Axes) -> list[str]:
    return [text.get_text() for text in ax.texts]


@pytest.fixture
def coupled(flat_plan: Plan) -> Plan:
    return replace(flat_plan, couplings=(Coupling("a", "b", "collision", 0.25),))


def test_every_vehicle_and_every_coupling_is_drawn(coupled: Plan) -> None:
    ax = plot_couplings(coupled)
    for name in "abc":
        assert len(artists(ax, f"vehicle:{name}")) == 1
        assert name in texts(ax)
    [edges] = artists(ax, "couplings")
    assert len(edges.get_segments()) == 1
    assert "0.2" in texts(ax)
    assert ax.get_title(loc="left") == "bay: 2 sets"
    assert "edge: risk of collision if planned apart (≤ 1)" in texts(ax)


@pytest.mark.parametrize("reason", ["distance", "range"])
def test_distances_at_edges_are_written_without_powers_of_ten(flat_plan: Plan, reason: str) -> None:
    for value, told in ((0.314, "0.31 m"), (9.0, "9 m"), (200.0, "200 m"), (1852.0, "1852 m")):
        ax = plot_couplings(replace(flat_plan, couplings=(Coupling("a", "b", reason, value),)))
        assert told in texts(ax)


def test_an_edge_joins_the_dots_of_its_vehicles(coupled: Plan) -> None:
    ax = plot_couplings(coupled)
    [edges] = artists(ax, "couplings")
    ends = {tuple(np.round(end, 9)) for end in edges.get_segments()[0]}
    dots = {tuple(np.round(np.ravel(artists(ax, f"vehicle:{n}")[0].get_data()), 9)) for n in "ab"}
    assert ends == dots


def test_no_two_vehicles_share_a_place_however_the_sets_are(coupled: Plan) -> None:
    for sizes in ([7, 2, 1], [1] * 30, [2] * 9, [3, 3, 1, 1], [1], [9, 9, 4, 3, 2, 2, 1, 1, 1]):
        names = iter(range(100))
        sets = tuple(tuple(f"v{next(names)}" for _ in range(n)) for n in sizes)
        scenario = coupled.scenario
        vehicles = tuple(
            replace(scenario.vehicles[0], name=name) for group in sets for name in group
        )
        plan = replace(
            coupled, scenario=replace(scenario, vehicles=vehicles), sets=sets, couplings=()
        )
        ax = plot_couplings(plan)
        dots = np.array(
            [np.ravel(artists(ax, f"vehicle:{v.name}")[0].get_data()) for v in vehicles]
        )
        apart = np.linalg.norm(dots[:, None] - dots[None], axis=2) + 9.0 * np.eye(len(dots))
        assert apart.min() > 0.5
        (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
        assert np.all((dots > [left, low]) & (dots < [right, high]))


def test_a_long_name_of_a_coupling_graph_reaches_over_no_other(flat_plan: Plan) -> None:
    names = ["a", "b", "vehicle-with-a-long-name-that-goes-on", "c"]
    row = [make_vehicle(name, [2.0 * k, 0.0], [2.0 * k, 9.0]) for k, name in enumerate(names)]
    scenario = replace(flat_plan.scenario, vehicles=tuple(row))
    sets = (tuple(names[:2]), *((name,) for name in names[2:]))
    ax = plot_couplings(replace(flat_plan, scenario=scenario, sets=sets, couplings=()))
    ax.figure.draw_without_rendering()
    written = [artists(ax, f"name:{name}")[0] for name in names]
    assert written[2].get_text() == "vehicle…-goes-on"
    boxes = [text.get_window_extent() for text in written]
    assert not any(one.overlaps(two) for one, two in combinations(boxes, 2))


@pytest.mark.parametrize("sizes", [(3, 2), (2, 2, 1), (1, 1, 1, 1, 1)])
def test_long_names_of_a_coupling_graph_reach_over_no_others(
    flat_plan: Plan, sizes: tuple[int, ...]
) -> None:
    names = [f"{k}-of-the-harbor-master-{k}" for k in range(sum(sizes))]
    row = [make_vehicle(name, [2.0 * k, 0.0], [2.0 * k, 9.0]) for k, name in enumerate(names)]
    scenario = replace(flat_plan.scenario, vehicles=tuple(row))
    left = iter(names)
    sets = tuple(tuple(next(left) for _ in range(size)) for size in sizes)
    ax = plot_couplings(replace(flat_plan, scenario=scenario, sets=sets, couplings=()))
    ax.figure.draw_without_rendering()
    written = [artists(ax, f"name:{name}")[0] for name in names]
    boxes = [text.get_window_extent() for text in written]
    assert not any(one.overlaps(two) for one, two in combinations(boxes, 2))
    assert len({text.get_text() for text in written}) == len(names)


@pytest.mark.parametrize(("count", "letters"), [(60, 4), (24, 6), (30, 12)])
def test_vehicles_planned_alone_have_names_where_these_have_room(
    flat_plan: Plan, count: int, letters: int
) -> None:
    names = [f"v{k:0{letters - 1}d}" for k in range(count)]
    row = [make_vehicle(name, [2.0 * k, 0.0], [2.0 * k, 9.0]) for k, name in enumerate(names)]
    scenario = replace(flat_plan.scenario, vehicles=tuple(row), workspace=None)
    sets = tuple((name,) for name in names)
    ax = plot_couplings(replace(flat_plan, scenario=scenario, sets=sets, couplings=()))
    ax.figure.draw_without_rendering()
    boxes = [text.get_window_extent() for n in names for text in artists(ax, f"name:{n}")]
    assert len(boxes) == (count if letters < 12 else 0)
    assert not any(one.overlaps(two) for one, two in combinations(boxes, 2))


def test_names_of_a_coupling_graph_lie_on_no_edge(flat_plan: Plan) -> None:
    names = [f"agent{k}" for k in range(7)]
    row = [make_vehicle(name, [2.0 * k, 0.0], [2.0 * k, 9.0]) for k, name in enumerate(names)]
    scenario = replace(flat_plan.scenario, vehicles=tuple(row))
    pairs = [Coupling(a, b, "collision", 0.2) for a, b in combinations(names, 2)]
    ax = plot_couplings(replace(flat_plan, scenario=scenario, sets=(names,), couplings=pairs))
    ax.figure.draw_without_rendering()
    [edges] = artists(ax, "couplings")
    lines = [shapely.LineString(ax.transData.transform(e)) for e in edges.get_segments()]
    for name in names:
        [text] = artists(ax, f"name:{name}")
        place = shapely.box(*text.get_window_extent().extents)
        assert not any(place.intersects(line) for line in lines)
        assert ax.figure.bbox.x0 <= place.bounds[0] < place.bounds[2] <= ax.figure.bbox.x1
    # Too many to be numbered, and the legend promises no numbers.
    assert "edge: the darker, the more risk of collision if planned apart" in texts(ax)
    assert not any(t.startswith("0.") for t in texts(ax))


def test_the_band_of_a_distance_is_in_the_legend(flat_plan: Plan) -> None:
    told = [text.get_text() for text in plot_distances(flat_plan).get_legend().get_texts()]
    assert told[-1] == "band: within 3σ"


def test_couplings_without_a_number_are_dashed(coupled: Plan) -> None:
    ax = plot_couplings(replace(coupled, couplings=(Coupling("a", "b", "blocked"),)))
    [edges] = artists(ax, "couplings")
    assert edges.get_linestyle()[0][1] is not None


def test_a_set_planned_together_without_couplings_is_shaded_and_not_called_alone(
    flat_plan: Plan,
) -> None:
    ax = plot_couplings(flat_plan)
    [shade] = artists(ax, "set:a")
    for name, is_in in (("a", True), ("b", True), ("c", False)):
        [dot] = artists(ax, f"vehicle:{name}")
        assert shade.get_path().contains_point(np.ravel(dot.get_data())) == is_in
    [meaning] = artists(ax, "meaning")
    assert meaning.get_text() == "shaded: together from the start, no risk apart estimated"
    alone = plot_couplings(replace(flat_plan, sets=(("a",), ("b",), ("c",))))
    assert artists(alone, "meaning")[0].get_text() == "no couplings: everyone planned alone"
    for name in "abc":
        assert artists(alone, f"set:{name}") == []


def test_bars_are_the_ledger_and_the_line_is_their_sum(flat_plan: Plan) -> None:
    ledger = (
        LedgerRow("pair", "a", "b", 2, 0.01),
        LedgerRow("obstacle", "a", "hook", 2, 0.002),
        LedgerRow("obstacle", "c", "wall", 4, 0.003),
    )
    ax = plot_risk(replace(flat_plan, risk=Risk(0.05, 0.015, ledger)))
    [total] = artists(ax, "sum")
    np.testing.assert_allclose(total.get_data().values, [0.0, 0.0, 0.012, 0.012, 0.015])
    heights = {
        (round(bar.get_x() + 0.5 * bar.get_width()), round(bar.get_height(), 6))
        for bars in ax.containers
        for bar in bars
        if bar.get_height() > 0.0
    }
    assert heights == {(2, 0.01), (2, 0.002), (4, 0.003)}
    assert ax.get_ylim()[1] > 0.05
    assert "Δ = 0.05" in texts(ax)


def test_without_a_plan_charts_say_so(empty_plan: Plan) -> None:
    assert "no plan" in texts(plot_risk(empty_plan))
    assert "no plan" in texts(plot_distances(empty_plan))
    assert "no sets" in texts(plot_couplings(empty_plan))


def test_distances_are_those_of_the_hulls(flat_plan: Plan) -> None:
    found = {c.name: c for c in closest_clearances(flat_plan, 20)}
    a, b = flat_plan.trajectories[:2]
    between = np.linalg.norm(a.means[:, :2] - b.means[:, :2], axis=1) - 1.0
    pair = found["a – b"]
    np.testing.assert_allclose(pair.at_steps(pair.distance), between, atol=1e-9)
    wall = shapely.box(5.0, 8.0, 5.2, 9.0)
    away = [wall.distance(shapely.Point(p)) - 0.5 for p in b.means[:, :2]]
    obstacle = found["b, wall"]
    np.testing.assert_allclose(obstacle.at_steps(obstacle.distance), away, atol=1e-9)
    assert {"c, ferry", "a, hook", "b – c"} <= set(found)


def test_the_encounters_drawn_are_the_closest(flat_plan: Plan) -> None:
    ax = plot_distances(flat_plan, most=3)
    lines = [line for line in ax.get_lines() if (line.get_gid() or "").startswith("distance:")]
    everything = closest_clearances(flat_plan, 100)
    least = [c.least(at_steps=False) for c in everything]
    assert least == sorted(least)
    assert [line.get_gid() for line in lines] == [f"distance:{c.name}" for c in everything[:3]]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("time [s]", "distance of hulls [m]")


def test_with_avoidance_at_steps_only_the_steps_are_promised(flat_plan: Plan) -> None:
    plan = replace(flat_plan, scenario=replace(flat_plan.scenario, avoidance="steps"))
    assert "at steps (dots) only" in texts(plot_distances(plan))


def test_distances_in_space_agree_with_an_optimizer() -> None:
    rng = np.random.default_rng(3)
    piece = box([0.0, 0.0, 0.0], [1.0, 2.0, 3.0])
    points = rng.uniform(-3.0, 5.0, (20, 3))
    distances, along = nearest_of(points, piece)
    for point, distance, direction in zip(points, distances, along, strict=True):
        nearest = minimize(
            lambda x, p=point: np.sum((x - p) ** 2), [0.5, 1.0, 1.5],
            bounds=[(0.0, 1.0), (0.0, 2.0), (0.0, 3.0)],
        )  # fmt: skip
        if distance > 0.0:
            assert distance == pytest.approx(np.sqrt(nearest.fun), abs=1e-4)
            np.testing.assert_allclose(direction, (point - nearest.x) / distance, atol=1e-3)


def test_charts_are_drawn_on_given_axes_and_leave_no_figure_behind(coupled: Plan) -> None:
    for function in (plot_couplings, plot_distances, plot_risk):
        ax = Figure().add_subplot()
        assert function(coupled, ax) is ax
    assert pyplot.get_fignums() == []


@pytest.mark.parametrize("others", [0, 9])
def test_two_that_rush_past_each_other_between_steps_are_seen_in_any_fleet(others: int) -> None:
    rushing = [
        replace(make_vehicle("a", [-6.0, 0.0], [18.0, 0.0]), initial_covariance=1e-9),
        replace(make_vehicle("b", [6.0, 0.39], [-18.0, 0.4]), initial_covariance=1e-9),
    ]
    far = [
        make_vehicle(f"far{i}", [50.0 + 9.0 * i, 50.0], [50.0 + 9.0 * i, 55.0])
        for i in range(others)
    ]
    vehicles = tuple(replace(v, disturbance_covariance=0.0) for v in (*rushing, *far))
    scenario = Scenario("rush", 1.0, HORIZON, 0.05, vehicles)
    closest = closest_clearances(make_plan(scenario), 1)[0]
    assert closest.name == "a – b"
    assert closest.distance.min() < -0.3


def test_a_moving_obstacle_that_passes_over_between_steps_is_seen(flat_plan: Plan) -> None:
    found = {c.name: c for c in closest_clearances(flat_plan, 100)}
    ferry = found["c, ferry"]
    assert len(ferry.times) == 20 * HORIZON + 1
    still = flat_plan.trajectories[2].means[:, :2]
    away = [
        shapely.box(7.0 + k, 7.0, 8.0 + k, 8.0).distance(shapely.Point(p)) - 0.5
        for k, p in enumerate(still)
    ]
    np.testing.assert_allclose(np.maximum(ferry.at_steps(ferry.distance), -0.5), away, atol=1e-9)


@pytest.mark.filterwarnings("error")
def test_a_chart_of_a_study_without_results_says_so() -> None:
    ax = plot_chart(Chart((), "Runtime", "vehicles N", "seconds", is_log=True))
    assert texts(ax) == ["no results yet"]
    assert ax.get_legend() is None
