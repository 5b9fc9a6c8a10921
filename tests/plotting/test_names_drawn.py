"""Where names stand in pictures: inside what they name, and not on each other."""

from __future__ import annotations

import warnings
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import shapely
from matplotlib.axes import Axes
from matplotlib.text import Text
from mpl_toolkits.mplot3d import Axes3D, proj3d

from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Coupling, Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.plotting import plot_couplings, plot_plan, plot_scenario
from radmpc.plotting.canvas.labels import LabelBoard
from radmpc.plotting.canvas.style import MAX_PANEL_LABELS

from .conftest import make_plan, make_vehicle


def boxes_of(ax: Axes) -> dict[str, shapely.Polygon]:
    """Return where texts stand, by what they say [m]."""
    ax.figure.canvas.draw()
    turned = ax.transData.inverted()
    found = {}
    for text in ax.texts:
        corners = turned.transform(text.get_window_extent().get_points())
        found[text.get_text()] = shapely.box(*corners.ravel())
    return found


def scene(*obstacles: Obstacle) -> Scenario:
    vehicles = (
        make_vehicle("v", [0.0, 0.0], [20.0, 0.0]),
        make_vehicle("w", [0.0, 9.0], [20.0, 9.0]),
    )
    return Scenario("names", 1.0, 4, 0.05, vehicles, obstacles=obstacles)


def test_names_of_boxes_stand_in_them() -> None:
    ax = plot_scenario(scene(Obstacle.box("shed", [5.0, 3.0], [12.0, 6.0])))
    assert shapely.box(5.0, 3.0, 12.0, 6.0).covers(boxes_of(ax)["shed"])


@pytest.mark.parametrize("is_upright", [True, False])
def test_names_of_thin_walls_lie_along_them(is_upright: bool) -> None:
    low, high = ([8.0, -4.0], [8.2, 8.0]) if is_upright else ([2.0, 4.0], [18.0, 4.2])
    ax = plot_scenario(scene(Obstacle.box("quay wall", low, high)))
    (text,) = (text for text in ax.texts if text.get_text() == "quay wall")
    assert text.get_rotation() == (90.0 if is_upright else 0.0)
    wall, place = shapely.box(*low, *high), shapely.Point(text.get_position())
    assert wall.covers(place)


def test_names_in_a_triangle_stay_in_it_and_beside_names_of_vehicles() -> None:
    corners = [[2.0, 2.0], [18.0, 2.0], [10.0, 8.0]]
    crowded = scene(Obstacle.polygon("island", corners))
    inside = make_vehicle("name of a vehicle", [10.0, 1.4], [20.0, 5.0])
    ax = plot_scenario(replace(crowded, vehicles=(*crowded.vehicles, inside)))
    boxes = boxes_of(ax)
    assert shapely.Polygon(corners).covers(boxes["island"])
    assert not boxes["island"].intersects(boxes["name of a vehicle"])


def test_no_name_stands_on_another_where_there_is_room_beside_it() -> None:
    boxes = [Obstacle.box(f"r{k}", [3.0 * k, 3.0], [3.0 * k + 2.0, 5.0]) for k in range(1, 6)]
    row = [make_vehicle(f"agent{k}", [3.0 * k + 1.0, 2.3], [3.0 * k + 1.0, -6.0]) for k in range(6)]
    ax = plot_plan(make_plan(replace(scene(*boxes), vehicles=tuple(row))))
    names = {t: box for t, box in boxes_of(ax).items() if t.startswith(("r", "agent"))}
    assert len(names) == 11
    assert not any(a.intersects(b) for a, b in combinations(names.values(), 2))


def test_small_panels_of_pictures_in_space_name_a_few_alone(space_plan: Plan) -> None:
    few = [make_vehicle(f"v{i}", [1.0 * i, 0.5, 1.0], [1.0 * i, 8.0, 1.0]) for i in range(9)]
    for count in (MAX_PANEL_LABELS, MAX_PANEL_LABELS + 1):
        scenario = replace(space_plan.scenario, vehicles=tuple(few[:count]), obstacles=())
        oblique = plot_plan(make_plan(scenario))
        panels = [ax for ax in oblique.figure.axes if not isinstance(ax, Axes3D)]
        named = [any(t.get_text() == "v1" for t in ax.texts) for ax in panels]
        assert any(named) == (count <= MAX_PANEL_LABELS)
        assert any(t.get_text().strip() == "v1" for t in oblique.texts)


def led(ax: Axes) -> set[str]:
    """Return the names with a line to their start."""
    return {line.get_gid()[7:] for line in ax.lines if (line.get_gid() or "").startswith("leader:")}


def crowd() -> Scenario:
    """Two rows of vehicles so close that not all names have room beside their starts."""
    rows = (("agent", 0.0, 12.0), ("other", 1.3, -12.0))
    vehicles = [
        make_vehicle(f"{name}{k}", [1.3 * k, y], [1.3 * k, goal])
        for name, y, goal in rows
        for k in range(8)
    ]
    return replace(scene(), vehicles=tuple(vehicles))


def hull_of(vehicle: Vehicle) -> shapely.Polygon:
    """Return the box around a hull at the start [m]."""
    start, radius = vehicle.start_position, vehicle.radius
    return shapely.box(*(start - radius), *(start + radius))


def test_a_name_beside_its_start_has_no_line_to_it() -> None:
    ax = plot_scenario(scene())
    assert {"v", "w"} <= set(boxes_of(ax))
    assert led(ax) == set()


def test_a_name_that_is_nearer_to_another_vehicle_or_far_away_has_a_line_to_its_start() -> None:
    fleet = crowd().vehicles
    ax = plot_plan(make_plan(crowd()))
    boxes, leaders = boxes_of(ax), led(ax)
    beside = [v for v in fleet if v.name in boxes and v.name not in leaders]
    assert leaders
    assert beside
    for vehicle in beside:
        box = boxes[vehicle.name]
        apart = box.distance(hull_of(vehicle))
        assert apart < 1.5 * (box.bounds[3] - box.bounds[1])
        for other in fleet:
            # Letters are taken for wider than they are.
            assert box.distance(hull_of(other)) >= apart - 0.25


def test_a_line_leads_from_the_hull_at_the_start_to_the_name() -> None:
    scenario = crowd()
    ax = plot_plan(make_plan(scenario))
    boxes, leaders = boxes_of(ax), led(ax)
    assert leaders
    for name in leaders:
        [line] = [one for one in ax.lines if one.get_gid() == f"leader:{name}"]
        start, end = line.get_xydata()
        [vehicle] = [one for one in scenario.vehicles if one.name == name]
        assert np.linalg.norm(start - vehicle.start_position) == pytest.approx(vehicle.radius)
        assert boxes[name].distance(shapely.Point(end)) < 0.3


def test_names_of_vehicles_stay_out_of_obstacles_that_bear_their_own() -> None:
    walls = [
        Obstacle.box("above", [-3.0, 0.6], [23.0, 4.0]),
        Obstacle.box("below", [-3.0, -4.0], [23.0, -0.6]),
    ]
    ax = plot_plan(make_plan(scene(*walls)))
    boxes = boxes_of(ax)
    for wall in walls:
        corners = shapely.box(*np.r_[wall.at(0)[0].vertices.min(0), wall.at(0)[0].vertices.max(0)])
        assert corners.intersection(boxes["v"]).area < 0.5 * boxes["v"].area


def test_step_numbers_that_would_lie_on_other_texts_are_left_out() -> None:
    board = LabelBoard(plot_scenario(scene()))
    place, nothing = np.array([10.0, 4.0]), np.zeros(2)
    for x in np.arange(7.0, 13.0, 0.25):
        for y in np.arange(2.0, 6.0, 0.25):
            board.put("x", np.array([x, y]), "black")
    for is_needed in (False, True):
        board.beside("7", place, nothing, "black", is_needed=is_needed)
        assert any(t.get_text() == "7" for t in board.axes.texts) == is_needed


def test_lines_to_starts_in_space_stay_there_if_the_view_is_turned(space_plan: Plan) -> None:
    crowded = [make_vehicle(f"agent{k}", [1.0, 0.4 * k, 1.0], [9.0, 9.0, 9.0]) for k in range(9)]
    scenario = replace(space_plan.scenario, vehicles=tuple(crowded), obstacles=())
    ax = plot_plan(make_plan(scenario))
    leaders = [line for line in ax.lines if (line.get_gid() or "").startswith("leader:")]
    assert leaders
    starts = {vehicle.name: vehicle.start_position for vehicle in crowded}
    for azimuth in (-60.0, 20.0):
        ax.view_init(azim=azimuth)
        ax.figure.canvas.draw()
        for line in leaders:
            x, y, _ = proj3d.proj_transform(*starts[line.get_gid()[7:]], ax.get_proj())
            away = np.linalg.norm(line.get_xydata()[0] - ax.transData.transform((x, y)))
            assert away < 5.0 * ax.figure.dpi / 72.0


def _text(ax: Axes, gid: str) -> Text:
    """The text of an id."""
    (found,) = [text for text in ax.texts if text.get_gid() == gid]
    return found


@pytest.mark.parametrize("letter", ["W", "丸"])
def test_wide_letters_of_a_coupling_graph_reach_over_no_other_name(
    flat_plan: Plan, letter: str
) -> None:
    names = (10 * letter, 8 * letter, 12 * letter)
    named = zip(flat_plan.scenario.vehicles, names, strict=True)
    vehicles = tuple(replace(vehicle, name=name) for vehicle, name in named)
    scenario = replace(flat_plan.scenario, vehicles=vehicles)
    sets = tuple((name,) for name in names)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of signs that the font lacks
        ax = plot_couplings(replace(flat_plan, scenario=scenario, sets=sets, couplings=()))
        ax.get_figure().draw_without_rendering()
        boxes = [_text(ax, f"name:{name}").get_window_extent() for name in names]
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))


def test_numbers_of_crossing_edges_do_not_read_as_one(flat_plan: Plan) -> None:
    names = ("a", "b", "c", "d", "e")
    vehicles = tuple(make_vehicle(n, [4.0 * i, 0.0], [4.0 * i, 8.0]) for i, n in enumerate(names))
    scenario = replace(flat_plan.scenario, vehicles=vehicles, obstacles=(), workspace=None)
    risks = {
        "ab": 2e-5, "ac": 3e-13, "ad": 0.75, "bc": 2e-5,
        "bd": 1.0, "cd": 1.0, "ce": 3e-13, "de": 1.0,
    }  # fmt: skip
    pairs = tuple(Coupling(*ends, "collision", risk) for ends, risk in risks.items())
    ax = plot_couplings(replace(flat_plan, scenario=scenario, sets=(names,), couplings=pairs))
    ax.get_figure().draw_without_rendering()
    numbers = [_text(ax, f"coupling:{pair.vehicle}:{pair.other}") for pair in pairs]
    gap = ax.get_figure().dpi / 72.0  # 1 pt between any two, twice half of it
    boxes = [Text.get_window_extent(number).padded(0.5 * gap, 0.0) for number in numbers]
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
