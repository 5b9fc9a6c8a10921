"""Which encounters the picture of distances shows, and that it says so."""

from __future__ import annotations

from dataclasses import replace

from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.plotting import plot_distances
from radmpc.plotting.clearances import closest_clearances

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
