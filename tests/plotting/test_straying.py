"""Where an obstacle may be whose place is not known exactly, in all pictures."""

from __future__ import annotations

import numpy as np
import pytest

import radmpc
from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.plotting.artists.straying import drawn_steps, grown_outline
from radmpc.plotting.clearances import closest_clearances

DECK = [[-1.0, -0.5], [1.0, -0.5], [1.0, 0.5], [-1.0, 0.5]]


def scene(d: int = 2, covariance: object = 0.04) -> Scenario:
    deck = DECK if d == 2 else [[*corner, h] for corner in DECK for h in (-1.0, 1.0)]
    rest = [0.0] * (d - 2)
    track = Obstacle.tracked("ship", deck, [3, 2, *rest, 0.5, 0, *rest], covariance)
    vehicle = Vehicle(
        "a",
        double_integrator(1.0, d),
        [0.0, 0.0, *rest],
        Goal(np.full(d, -0.5), np.full(d, 0.5), None),
        0.3,
        1.0,
        0.01,
        0.0,
    )
    return Scenario("s", 1.0, 8, 0.05, [vehicle], [track])


def planned(scenario: Scenario) -> Plan:
    return radmpc.plan(scenario, "ira", rng=0).require()


def rings(ax) -> list[str]:
    return sorted(a.get_gid() for a in ax.get_children() if str(a.get_gid()).startswith("spread:"))


def test_the_outline_grows_by_three_deviations_every_way():
    [ship] = scene(covariance=[0.04, 0.09, 0.0, 0.0]).obstacles
    grown = grown_outline(ship, 2.0)
    assert grown.max(axis=0) == pytest.approx([4.0 + 1.0 + 0.6, 2.0 + 0.5 + 0.9])
    assert grown.min(axis=0) == pytest.approx([4.0 - 1.0 - 0.6, 2.0 - 0.5 - 0.9])


def test_between_steps_it_is_that_of_the_place_between():
    # Both ends vary together but for the jolts: halfway the variance is below the mean of both.
    [ship] = scene(covariance=[0.0, 0.0, 0.04, 0.0]).obstacles
    halfway = grown_outline(ship, 1.5)
    assert np.ptp(halfway[:, 0]) == pytest.approx(2.0 + 6.0 * 0.2 * 1.5)


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("d", [2, 3])
def test_pictures_show_it_dashed_at_numbered_steps_and_the_last(d):
    scenario = scene(d)
    names = sorted(f"spread:ship:{k}" for k in drawn_steps(scenario.obstacles[0]))
    assert names[-1] == "spread:ship:8"
    assert rings(radmpc.plot_scenario(scenario)) == names
    assert rings(radmpc.plot_plan(planned(scenario))) == names


def test_what_is_known_exactly_has_none():
    ax = radmpc.plot_plan(planned(scene(covariance=0.0)))
    assert rings(ax) == []
    legend = ax.get_legend()
    assert "obstacle's 3σ" not in [text.get_text() for text in legend.get_texts()]


def test_the_legend_says_what_is_dashed():
    legend = radmpc.plot_plan(planned(scene())).get_legend()
    assert "obstacle's 3σ" in [text.get_text() for text in legend.get_texts()]


def test_deviations_of_distances_are_those_of_both():
    exact, strays = (closest_clearances(planned(scene(covariance=c)), 1)[0] for c in (0.0, 0.04))
    assert strays.sigma[0] == pytest.approx(np.hypot(exact.sigma[0], 0.2), rel=1e-6)


def test_a_film_moves_the_ring_along():
    film = radmpc.animate_plan(planned(scene()), frames_per_step=2)
    [ring] = [line for line in film._fig.axes[0].lines if line.get_gid() == "spread:ship"]
    middles = []
    for frame in (0, 8):
        film._func(frame)
        points = np.array(ring.get_xydata())
        middles.append(0.5 * (points.max(axis=0) + points.min(axis=0)))
    film._draw_was_started = True
    assert middles[0] == pytest.approx([3.0, 2.0])
    assert middles[1] == pytest.approx([5.0, 2.0])


def test_a_film_in_space_moves_the_rings_along():
    film = radmpc.animate_plan(planned(scene(3)), frames_per_step=1)
    [rings] = [
        child for child in film._fig.axes[0].get_children() if child.get_gid() == "spread:ship"
    ]
    film._func(4)
    film._draw_was_started = True
    points = np.concatenate(rings._segments3d)
    # 4 s at 0.5 m/s; velocities deviate by 0.2 m/s, the place by 0.2 m.
    assert points.mean(axis=0) == pytest.approx([5.0, 2.0, 0.0], abs=0.05)
    assert np.ptp(points, axis=0) == pytest.approx(6.0 * np.hypot(0.2, 0.8), rel=0.01)
