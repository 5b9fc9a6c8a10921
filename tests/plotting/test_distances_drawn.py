"""Which encounters the picture of distances shows, and that it says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.plotting import plot_distances
from radmpc.plotting.clearances import closest_clearances
from radmpc.plotting.interpolation import moving_outline

from .conftest import HORIZON, make_plan, make_vehicle


def test_the_picture_of_distances_says_what_orders_encounters(flat_plan: Plan) -> None:
    ax = plot_distances(flat_plan, most=3)
    assert ax.get_title(loc="left").endswith("closest encounters in σ")
    closest = closest_clearances(flat_plan, 3)
    legend = ax.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == [
        *(f"{c.name}: {c.least(at_steps=False):.1f}σ" for c in closest),
        "band: within 3σ",
    ]


def test_no_pair_is_left_out_that_is_closer_than_what_is_drawn() -> None:
    vehicles = tuple(
        replace(
            make_vehicle(f"v{i}", [4.0 * i, 0.0], [4.0 * i, 1.0]),
            radius=0.1,
            initial_covariance=1e-4,
            disturbance_covariance=0.0,
        )
        for i in range(9)
    )
    post = Obstacle.box("post", [-20.0, 0.0], [-18.0, 1.0])
    scenario = Scenario("line", 1.0, HORIZON, 0.05, vehicles, (post,))
    found = closest_clearances(make_plan(scenario), 6)
    # Neighbors are 3.8 m apart, all else is farther away, also in standard deviations.
    assert [c.name for c in found] == [f"v{i} – v{i + 1}" for i in range(6)]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_two_vehicles_answer_alike_moves_them_not_apart(sign: float) -> None:
    push = np.vstack([0.5 * np.eye(2), np.eye(2)])
    pair = []
    for name, y, answer in (("a", 0.0, push), ("b", 3.0, sign * push)):
        wind = SharedDisturbance("wind", answer, 0.02)
        pair.append(replace(make_vehicle(name, [0.0, y], [6.0, y]), shared=(wind,)))
    plan = make_plan(Scenario("windy", 1.0, HORIZON, 0.05, tuple(pair), ()))
    [found] = closest_clearances(plan, 1)
    step, own, common = pair[0].system.A, 0.002 * np.eye(4), np.zeros((4, 4))
    apart = push - sign * push
    for sigma in found.at_steps(found.sigma):
        # Along the line between them, y.
        assert sigma == pytest.approx(np.sqrt((own + common)[1, 1]), rel=1e-9)
        own = step @ own @ step.T + 0.002 * np.eye(4)
        common = step @ common @ step.T + 0.02 * apart @ apart.T


def test_long_names_in_the_key_of_distances_are_cut_within_the_picture(flat_plan: Plan) -> None:
    long = ["a research vessel that is towed home by", "another of the same company, number 7"]
    vehicles = tuple(
        replace(vehicle, name=name)
        for vehicle, name in zip(flat_plan.scenario.vehicles, [*long, "c"], strict=True)
    )
    scenario = replace(flat_plan.scenario, vehicles=vehicles)
    ax = plot_distances(make_plan(scenario))
    figure = ax.get_figure()
    figure.draw_without_rendering()
    legend = ax.get_legend()
    assert legend is not None
    box = legend.get_window_extent()
    assert 0.0 <= box.x0 <= box.x1 <= figure.bbox.width
    assert ax.get_window_extent().width > 0.7 * figure.bbox.width
    told = [text.get_text() for text in legend.get_texts()]
    assert any(one.startswith("a res") and "…" in one and "number 7:" in one for one in told)


def crossing(variance: float, *, strays: bool) -> Plan:
    """Return vehicles among many obstacles: near, far, standing, moving, some not known exactly."""
    rng = np.random.default_rng(3)
    obstacles = []
    for k, (x, y) in enumerate(rng.uniform(-15.0, 15.0, (24, 2))):
        outline = np.array([[x, y], [x + 1.0, y], [x + 0.5, y + 1.0]])
        if k % 3 == 0:
            obstacles.append(Obstacle.polygon(f"o{k}", outline))
        elif k % 3 == 1 or not strays:
            drift = rng.normal(0.0, 0.5, 2)
            moving = [outline + step * drift for step in range(HORIZON + 1)]
            obstacles.append(Obstacle.moving(f"o{k}", moving))
        else:
            shape = {"start": [x, y, 0.1, -0.2], "covariance": 0.01 * (k + 1)}
            obstacles.append(Obstacle.tracked(f"o{k}", outline - outline[0], **shape))
    vehicles = tuple(
        replace(make_vehicle(f"v{i}", [0.0, 3.0 * i], [9.0, 3.0 * i]), initial_covariance=scale)
        for i, scale in enumerate((variance, 4.0 * variance))
    )
    return make_plan(Scenario("crossing", 1.0, HORIZON, 0.05, vehicles, tuple(obstacles)))


@pytest.mark.parametrize("most", [1, 4, 6])
@pytest.mark.parametrize("strays", [False, True])
def test_the_closest_are_those_of_all(most: int, strays: bool) -> None:
    plan = crossing(1e-3, strays=strays)
    everything = closest_clearances(plan, 1000)
    assert len(everything) == 2 * 24 + 1
    found = closest_clearances(plan, most)
    assert [one.name for one in found] == [one.name for one in everything[:most]]
    for one, same in zip(found, everything, strict=False):
        assert np.array_equal(one.distance, same.distance)
        assert np.array_equal(one.sigma, same.sigma)


def test_obstacles_that_others_are_closer_than_are_not_measured(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    outlined: list[str] = []

    def counting(obstacle: Obstacle, time: float) -> np.ndarray:
        if time == 0.0:
            outlined.append(obstacle.name)
        return moving_outline(obstacle, time)

    monkeypatch.setattr("radmpc.plotting.clearances.moving_outline", counting)
    closest_clearances(crossing(1e-3, strays=False), 2)
    # Where one that moves is at all times is found once, whoever it is measured against.
    assert len(outlined) == len(set(outlined)) <= 6
