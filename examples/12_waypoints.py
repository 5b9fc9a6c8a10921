"""Two buoys on the way, and what time is worth.

A boat inspects two buoys, one to either side of its way past a rock, and may arrive at any step
from 8 to 12. Above is the least effort, below the earliest arrival: the same scenario with a price
on every second. The steps of visits and arrival are choices of the planner. From rest to rest
nothing is faster than full throttle and full brake, u (n² - 1) / 4 in an odd number n of steps of
1 s and u n² / 4 in an even one: at 1.22 m/s² that is 24.4 m in nine steps, and 25 m take ten. The
number of steps until the boat arrives must be that, buoys and rock included.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import radmpc

SYSTEM = radmpc.double_integrator(1.0, dimension=2)

EXPECTED = 10.0
TOLERANCE = 1e-9

TITLES = ("least effort", "earliest arrival")


def main(out: Path) -> float:
    """Plan with both prices of time, draw, and return the steps of the earlier arrival."""
    boat = radmpc.Vehicle(
        name="boat",
        system=SYSTEM,
        start=[0.0, 0.0],
        goal=radmpc.Goal.at([25.0, 0.0], within=[8, 12]),
        radius=0.4,
        control_limit=1.25,
        initial_covariance=1e-4,
        disturbance_covariance=1e-4,
        gain=radmpc.lqr_gain(SYSTEM, np.eye(4), 10.0 * np.eye(2)),
        via=[radmpc.Visit.at([6.0, 2.0], 1.0), radmpc.Visit.at([19.0, -2.0], 1.0)],
    )
    rock = radmpc.Obstacle.box("rock", [10.0, -0.5], [13.0, 1.5])
    idle = radmpc.Scenario("buoys", 1.0, 12, 0.01, [boat], [rock])
    figure = Figure(figsize=(3.5, 3.6), dpi=200, layout="constrained")
    for axes, title, price in zip(figure.subplots(2), TITLES, (0.0, 50.0), strict=True):
        plan = radmpc.plan(replace(idle, time_weight=price)).require()
        radmpc.plot_plan(plan, axes, details=False, title=title)
    figure.savefig(out / "12_waypoints.png")
    path = plan.trajectories[0].means
    return float(boat.goal.arrival(path[:, :2], path[:, 2:]) or np.nan)


if __name__ == "__main__":
    print("steps until the boat arrives:", main(Path()))
