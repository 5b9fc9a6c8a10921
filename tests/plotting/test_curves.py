from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
from matplotlib.colors import rgb_to_hsv, to_rgb

from radmpc.model.dynamics import LinearSystem
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.plotting.canvas.extent import plan_extent, scenario_extent
from radmpc.plotting.canvas.style import HUES, vehicle_colors
from radmpc.plotting.curves import confidence_ellipses, ellipsoid_rings, mean_path, point_along

from .conftest import fly


def test_the_path_between_steps_is_the_parabola(flat_plan: Plan) -> None:
    vehicle, trajectory = flat_plan.scenario.vehicles[0], flat_plan.trajectories[0]
    path = mean_path(vehicle, trajectory)
    # Pushed by 2 m/s² from rest at (1, 1): half a second later 0.25 m on, not half of 1 m.
    np.testing.assert_allclose(path[5], [1.0, 1.25])
    np.testing.assert_allclose(path[10], [1.0, 2.0])
    np.testing.assert_allclose(path[-1], [1.0, 9.0])


def test_other_dynamics_fly_straight_between_steps(flat_plan: Plan) -> None:
    vehicle = flat_plan.scenario.vehicles[0]
    # The control moves velocities alone: nothing tells what happens between steps.
    controls_alone = np.vstack([np.zeros((2, 2)), vehicle.system.B[2:]])
    euler = LinearSystem(vehicle.system.A, controls_alone, (0, 1), (2, 3))
    straight = replace(vehicle, system=euler)
    path = mean_path(straight, flat_plan.trajectories[0])
    np.testing.assert_allclose(path, flat_plan.trajectories[0].means[:, :2])


def test_ellipses_lie_three_deviations_out(flat_plan: Plan) -> None:
    vehicle, trajectory = flat_plan.scenario.vehicles[0], flat_plan.trajectories[0]
    first = confidence_ellipses(vehicle, trajectory)[0]
    distance = np.linalg.norm(first - vehicle.start_position, axis=1)
    np.testing.assert_allclose(distance, 3.0 * np.sqrt(0.001))


def test_rings_lie_three_deviations_out(space_scenario: Scenario) -> None:
    vehicle = space_scenario.vehicles[0]
    rings = ellipsoid_rings(vehicle, fly(vehicle))
    assert len(rings) == 3 * 5
    distance = np.linalg.norm(rings[0] - vehicle.start_position, axis=1)
    np.testing.assert_allclose(distance, 3.0 * np.sqrt(0.001))


def test_a_share_of_the_path_is_found_with_its_direction() -> None:
    path = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]])
    found = point_along(path, 0.75)
    assert found is not None
    np.testing.assert_allclose(found[0], [4.0, 2.0])
    np.testing.assert_allclose(found[1], [0.0, 1.0])


def test_a_path_without_length_has_no_direction() -> None:
    assert point_along(np.zeros((3, 2)), 0.5) is None


def test_the_extent_holds_workspace_paths_and_hulls(flat_plan: Plan) -> None:
    lower, upper = plan_extent(flat_plan)
    assert np.all(lower < 0.0)
    assert np.all(upper > [14.0, 10.0])
    inner = scenario_extent(replace(flat_plan.scenario, workspace=None))
    assert np.all(inner[0] <= [0.5, 0.5])


def test_a_scenario_on_a_line_is_not_drawn_flat(flat_scenario: Scenario) -> None:
    line = replace(flat_scenario, vehicles=flat_scenario.vehicles[:1], obstacles=(), workspace=None)
    lower, upper = scenario_extent(line)
    width, height = upper - lower
    assert width >= 0.25 * height


def test_vehicles_in_no_set_get_hues_of_their_own() -> None:
    colors = vehicle_colors(["a", "b", "c"], [("b", "c")])
    assert len(set(colors.values())) == 3


def apart_of(one: object, other: object) -> float:
    """Return how far apart two colors are, black and white being 441."""
    return float(255.0 * np.linalg.norm(np.subtract(to_rgb(one), to_rgb(other))))


def test_sets_have_hues_of_their_own_as_long_as_there_are_enough() -> None:
    names = [f"v{i}" for i in range(len(HUES))]
    colors = list(vehicle_colors(names, [[name] for name in names]).values())
    assert colors == [to_rgb(hue) for hue in HUES]
    assert min(apart_of(a, b) for a, b in combinations(colors, 2)) > 60.0


def test_where_hues_run_out_vehicles_alone_share_none_with_a_set() -> None:
    sets = [[f"a{i}"] for i in range(9)] + [["b1", "b2"], ["c1", "c2", "c3"]]
    names = [name for group in sets for name in group]
    colors = vehicle_colors(names, sets)
    hues = {name: round(float(rgb_to_hsv(color)[0]), 3) for name, color in colors.items()}
    of_sets = {hues["b1"], hues["c1"]}
    assert len(of_sets) == 2
    assert hues["b1"] == hues["b2"]
    assert of_sets.isdisjoint(hues[f"a{i}"] for i in range(9))
    assert len(set(colors.values())) == len(names)


def test_four_vehicles_of_a_set_differ_in_color() -> None:
    colors = vehicle_colors("abcd", ["abcd"]).values()
    assert min(apart_of(a, b) for a, b in combinations(colors, 2)) > 60.0
