from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely

from radmpc import Goal, LinearSystem, Obstacle, Scenario, Vehicle, Workspace, double_integrator
from radmpc.geometry import box, hull
from radmpc.preflight.concerns import concerns_of
from radmpc.preflight.distances import Surroundings, side_of
from radmpc.preflight.grid import grid_of, widened
from radmpc.preflight.outlook import outlook_of
from radmpc.preflight.places import Narrowest, Passage

DEVIATION = 0.1


def boat(**changes: object) -> Vehicle:
    """A boat that goes 20 m east, uncertain by 0.1 m all along."""
    vehicle = Vehicle(
        name="boat",
        system=double_integrator(1.0, 2),
        start=[0.0, 0.0],
        goal=Goal.at([20.0, 0.0], 0.5),
        radius=0.5,
        control_limit=2.0,
        initial_covariance=np.diag([DEVIATION**2, DEVIATION**2, 0.0, 0.0]),
        disturbance_covariance=0.0,
        speed_limit=2.0,
    )
    return replace(vehicle, **changes)


def past(*obstacles: Obstacle, horizon: int = 16, **changes: object) -> Scenario:
    """The boat's way with something in it."""
    scenario = Scenario("way", 1.0, horizon, 0.02, (boat(),), obstacles)
    return replace(scenario, **changes)


def gap(width: float, middle: float = 0.0, reach: float = 200.0) -> tuple[Obstacle, Obstacle]:
    """Two walls across the way."""
    low, high = middle - 0.5 * width, middle + 0.5 * width
    return (
        Obstacle.box("south", [9.0, low - reach], [10.0, low]),
        Obstacle.box("north", [9.0, high], [10.0, high + reach]),
    )


def narrowest(scenario: Scenario) -> Narrowest:
    place = outlook_of(scenario).vehicles[0].narrowest
    assert isinstance(place, Narrowest)
    return place


def is_wide(scenario: Scenario) -> bool:
    return outlook_of(scenario).vehicles[0].narrowest is Passage.WIDE


@pytest.mark.parametrize("width", [1.2, 1.5, 1.9])
@pytest.mark.parametrize("middle", [0.0, 0.13, 2.07])
def test_a_gap_that_must_be_passed_is_measured(width: float, middle: float) -> None:
    place = narrowest(past(*gap(width, middle)))
    assert place.clearance == pytest.approx(0.5 * width - 0.5, abs=0.03)
    assert place.deviations == pytest.approx((0.5 * width - 0.5) / DEVIATION, rel=0.1)
    assert set(place.beside) == {"south", "north"}
    assert 8.4 <= place.position[0] <= 10.6
    assert place.position[1] == pytest.approx(middle, abs=0.1)
    assert 3 <= place.step <= 12


def test_what_does_not_fit_lacks_what_it_lacks() -> None:
    assert narrowest(past(*gap(0.6))).clearance == pytest.approx(-0.2, abs=0.03)


def test_a_wall_without_thickness_has_no_way_through() -> None:
    fence = Obstacle.line("fence", [[9.7, -200.0], [9.7, 200.0]])
    (seen,) = outlook_of(past(fence)).vehicles
    assert seen.narrowest is Passage.CLOSED
    (concern,) = concerns_of(outlook_of(past(fence)))
    assert "cannot be at its goal by step 16 (16 s): around obstacles that takes" in concern.text


def test_a_gap_of_plenty_is_wide() -> None:
    assert is_wide(past(*gap(8.0)))
    assert is_wide(past())


def test_a_way_around_counts_if_there_is_time_for_it() -> None:
    south, north = gap(1.2, reach=15.0)
    assert narrowest(past(south, north, horizon=12)).clearance == pytest.approx(0.1, abs=0.03)
    assert is_wide(past(south, north, horizon=30))


def test_noise_across_the_gap_counts_rather_than_along_it() -> None:
    along = boat(initial_covariance=np.diag([1.0, DEVIATION**2, 0.0, 0.0]))
    place = narrowest(replace(past(*gap(1.5)), vehicles=(along,)))
    assert place.deviation == pytest.approx(DEVIATION, rel=0.02)


def test_noise_counts_as_it_is_when_the_gap_is_passed() -> None:
    growing = boat(disturbance_covariance=np.diag([0.01, 0.01, 0.0, 0.0]), initial_covariance=0.0)
    place = narrowest(replace(past(*gap(1.9)), vehicles=(growing,)))
    assert place.deviation == pytest.approx(0.1 * np.sqrt(place.step), rel=1e-6)
    # Sooner is surer: it goes through at full speed.
    assert place.step <= 6


def test_without_noise_there_is_a_clearance_but_no_number_of_deviations() -> None:
    still = boat(initial_covariance=0.0)
    place = narrowest(replace(past(*gap(0.8)), vehicles=(still,)))
    assert place.deviations is None
    assert place.clearance == pytest.approx(-0.1, abs=0.03)
    assert is_wide(replace(past(*gap(1.2)), vehicles=(still,)))


def test_at_steps_alone_walls_may_be_jumped_over() -> None:
    walls = gap(0.6)
    fast = boat(speed_limit=6.0, control_limit=6.0)
    scenario = replace(past(*walls, horizon=8), vehicles=(fast,))
    assert narrowest(scenario).clearance < 0.0
    assert is_wide(replace(scenario, avoidance="steps"))


def test_a_border_is_a_wall_for_the_center_alone() -> None:
    (south, _) = gap(0.0, middle=0.0)
    place = narrowest(past(south, workspace=Workspace([-1.0, -10.0], [21.0, 0.8])))
    # Between the radius and the border 0.3 m are left, half of it on each side.
    assert place.clearance == pytest.approx(0.15, abs=0.03)
    assert set(place.beside) == {"south", None}


def test_a_gate_that_opens_late_is_waited_for() -> None:
    shut, open_ = [[9.0, -0.7], [10.0, -0.7]], [[9.0, 60.0], [10.0, 60.0]]

    def gate(opens: int) -> Obstacle:
        outlines = [(shut if k < opens else open_) + [[9.5, 60.5]] for k in range(17)]
        return Obstacle.moving("gate", outlines)

    south = Obstacle.box("south", [9.0, -200.0], [10.0, -0.7])
    assert is_wide(past(south, gate(6)))
    late = outlook_of(past(south, gate(14)))
    assert late.vehicles[0].narrowest is Passage.CLOSED
    texts = [concern.text for concern in concerns_of(late)]
    said = "no path to the goal in time is wide enough, and straight ahead 'gate' stands"
    assert any(said in text for text in texts)


def test_a_gap_in_space_is_measured() -> None:
    drone = Vehicle(
        name="drone",
        system=double_integrator(1.0, 3),
        start=[0.0, 0.0, 2.0],
        goal=Goal.at([8.0, 0.0, 2.0], 0.5),
        radius=0.5,
        control_limit=2.0,
        initial_covariance=np.diag([DEVIATION**2] * 3 + [0.0] * 3),
        disturbance_covariance=0.0,
        speed_limit=2.0,
    )
    slabs = (
        Obstacle.box("floor", [3.0, -50.0, -50.0], [4.0, 50.0, 1.3]),
        Obstacle.box("ceiling", [3.0, -50.0, 2.7], [4.0, 50.0, 50.0]),
    )
    place = narrowest(Scenario("slot", 1.0, 9, 0.02, (drone,), slabs))
    assert place.clearance == pytest.approx(0.2, abs=0.05)
    assert set(place.beside) == {"floor", "ceiling"}


def test_a_world_too_large_for_the_hull_is_not_judged() -> None:
    small = boat(radius=0.001, speed_limit=None, control_limit=50.0)
    scenario = replace(past(*gap(0.5)), vehicles=(small,))
    assert outlook_of(scenario).vehicles[0].narrowest is Passage.TOO_LARGE


def test_other_dynamics_have_a_narrowest_place_too() -> None:
    system = LinearSystem(np.eye(2), np.eye(2), (0, 1), None)
    walker = Vehicle(
        "walker", system, [0.0, 0.0], Goal.at([20.0, 0.0], 0.5, None), 0.5, 2.0,
        DEVIATION**2 * np.eye(2), 0.0,
    )  # fmt: skip
    scenario = replace(past(*gap(1.5)), vehicles=(walker,))
    seen = outlook_of(scenario).vehicles[0]
    assert seen.least_steps == 10
    assert narrowest(scenario).clearance == pytest.approx(0.25, abs=0.03)


def test_other_dynamics_saturate_at_what_the_cheapest_way_leaves() -> None:
    system = LinearSystem(np.eye(2), np.eye(2), (0, 1), None)
    walker = Vehicle(
        "walker", system, [0.0, 0.0], Goal.at([19.0, 0.0], 0.0, None), 0.5, 2.0,
        0.0, 0.04 * np.eye(2), gain=-0.5 * np.eye(2), control_sigmas=0.0,
    )  # fmt: skip
    seen = outlook_of(replace(past(horizon=10), vehicles=(walker,))).vehicles[0]
    assert (seen.least_steps, seen.least_steps_with_feedback) == (10, 10)
    # Nine of ten steps are flown at the limit, and all but the first under feedback.
    assert seen.saturation == 1.0
    slow = replace(walker, control_sigmas=3.0)
    kept = outlook_of(replace(past(horizon=40), vehicles=(slow,))).vehicles[0]
    assert kept.least_steps == 10
    assert kept.least_steps_with_feedback is not None
    assert 11 <= kept.least_steps_with_feedback <= 13
    assert kept.saturation is not None
    assert 1e-3 < kept.saturation < 0.05
    assert kept.reserve.share == pytest.approx(3 * 0.5 * 0.2 * np.sqrt(4 / 3) / 2.0, rel=1e-3)


@pytest.mark.parametrize("count", [1, 2, 3, 6])
def test_distances_in_the_plane_are_those_of_another_library(count: int) -> None:
    rng = np.random.default_rng(count)
    piece = hull(rng.uniform(-3, 3, (count, 2)))
    points = rng.uniform(-6, 6, (200, 2))
    near = side_of("reef", piece, points, np.arange(200), 0.0)
    shape = shapely.MultiPoint(piece.vertices).convex_hull
    expected = shapely.distance(shape, shapely.points(points))
    assert np.maximum(near.distances, 0.0) == pytest.approx(expected, abs=1e-12)
    # A step against the direction leads nearer by as much.
    outside = expected > 0.01
    moved = points[outside] - 0.01 * near.normals[outside]
    nearer = shapely.distance(shape, shapely.points(moved))
    assert nearer == pytest.approx(expected[outside] - 0.01, abs=1e-9)


def test_distances_in_space_are_exact_for_boxes_and_not_above_for_others() -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform(-4, 4, (300, 3))
    low, high = np.array([-1.0, -2.0, 0.0]), np.array([1.5, 0.5, 0.0])
    expected = np.linalg.norm(points - np.clip(points, low, high), axis=1)
    every = np.arange(300)
    plate = side_of("plate", box(low, high), points, every, 0.5)
    assert plate.distances == pytest.approx(expected - 0.5, abs=1e-12)
    body = hull(rng.uniform(-1, 1, (12, 3)))
    corners = np.linalg.norm(points[:, None] - body.vertices, axis=2).min(axis=1)
    assert np.all(side_of("body", body, points, every, 0.0).distances <= corners + 1e-12)


def test_far_things_are_left_out_where_that_is_asked_for() -> None:
    around = Surroundings.of(past(*gap(1.0)), 0.5, 0)
    points = np.array([[0.0, 0.0], [8.0, 0.0]])
    assert np.isinf(around.nearest(points, 2.0).distances).tolist() == [True, False]
    assert around.nearest(points, 2.0).distances[1] == around.nearest(points).distances[1]


def test_a_cell_is_crossed_in_a_tick_at_full_speed_and_no_faster() -> None:
    for step, radius in (([2.0, 1.0], 0.5), ([0.2, 0.1], 1.0)):
        grid = grid_of(np.zeros(2), np.array([40.0, 20.0]), np.array(step), radius, 30, 1e7)
        assert grid is not None
        ticks = len(grid.steps) - 1
        assert ticks * grid.size[0] >= 30 * step[0] - 1e-9
        assert (ticks - 1) * grid.size[0] < 30 * step[0]
        assert grid.steps[0] == 0
        assert grid.steps[-1] == 30
        assert grid.is_step.sum() == min(ticks, 30) + 1
        assert grid.centers.min() <= 0.5 * grid.size.max()


@pytest.mark.parametrize("radius", [1e-6, 0.3, 0.5, 0.9, 1.6, 7.0, 40.0, 1e6])
def test_cells_grow_until_there_are_few_enough_and_no_further_than_the_hull(radius: float) -> None:
    room, step = np.full(2, 400.0), np.full(2, 2.0)
    sizes = []
    for work in (1e9, 1e7, 1e5, 10.0):
        grid = grid_of(np.zeros(2), room, step, radius, 100, work)
        if grid is not None:
            sizes.append(float(grid.size.max()))
            assert np.prod(grid.shape) * (len(grid.steps) - 1) <= work
    assert sizes == sorted(sizes)
    assert all(size <= 1.4 * radius + 2.0 for size in sizes)


def test_fields_widen_by_one_cell_along_each_axis() -> None:
    field = np.zeros((5, 6, 4), dtype=np.float32)
    field[2, 0, 3] = 1.0
    wide = widened(field)
    assert np.argwhere(wide).min(axis=0).tolist() == [1, 0, 2]
    assert np.argwhere(wide).max(axis=0).tolist() == [3, 1, 3]
    assert wide.sum() == 3 * 2 * 2


def test_what_a_freighter_strays_counts_beside_it() -> None:
    """The gap lies between a wall and a barge at anchor, whose place is known within 0.2 m."""
    south, north = gap(1.9)
    hull = np.array([[9.0, 0.95], [10.0, 0.95], [10.0, 200.0], [9.0, 200.0]])
    barge = Obstacle.tracked("north", hull, [0.0] * 4, [0.04, 0.04, 0.0, 0.0])
    known = Obstacle.tracked("north", hull, [0.0] * 4)
    place, exact = (narrowest(past(south, thing)) for thing in (barge, known))
    assert exact.clearance == pytest.approx(narrowest(past(south, north)).clearance, abs=0.03)
    assert place.deviation == pytest.approx(np.hypot(DEVIATION, 0.2), rel=0.02)
    assert place.deviations < exact.deviations


def test_a_place_on_an_axis_is_named_without_rounding_errors() -> None:
    gate = [
        Obstacle.box("north", [8.0, 0.62], [9.0, 30.0]),
        Obstacle.box("south", [8.0, -30.0], [9.0, -0.62]),
    ]
    scenario = past(*gate, workspace=Workspace([-5.0, -30.0], [30.0, 30.0]))
    [told] = [one.text for one in concerns_of(outlook_of(scenario)) if one.kind == "narrow"]
    assert "must pass between 'north' and 'south' near (8.167, 0) with 0.12 m to spare" in told
