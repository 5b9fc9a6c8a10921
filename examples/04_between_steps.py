"""A thin wall between two steps.

A wall of 10 cm stands across the way, and the vehicle covers 2 m in a step. Planned for the steps
alone it is before the wall at one step and behind it at the next: certified, and through the wall
in every sample. Planned along intervals, the default, it goes around. To judge a plan along its
true path, give its scenario another `avoidance`: the number is the share of samples of the first
plan that then collide, and it is all of them.
"""

from dataclasses import replace
from pathlib import Path

from matplotlib.figure import Figure

import radmpc

EXPECTED = 1.0
TOLERANCE = 0.0


def main(out: Path) -> float:
    """Plan both ways, draw, and return the share of collisions between steps."""
    rover = radmpc.Vehicle(
        name="rover",
        system=radmpc.double_integrator(1.0, dimension=2),
        start=[0.0, 0.0, 0.0, 0.0],
        goal=radmpc.Goal([10.0, 0.0], [10.0, 0.0], speed=[0.0, 0.0]),
        radius=0.4,
        control_limit=[4.0, 4.0],
        initial_covariance=[1e-3, 1e-3, 1e-4, 1e-4],
        disturbance_covariance=[1e-3, 1e-3, 1e-4, 1e-4],
    )
    wall = radmpc.Obstacle.box("wall", [4.95, -3.0], [5.05, 1.5])
    intervals = radmpc.Scenario("wall", 1.0, 5, 0.05, (rover,), (wall,), avoidance="intervals")
    steps = replace(intervals, avoidance="steps")

    jumping = radmpc.plan(steps).require()
    around = radmpc.plan(intervals).require()
    figure = Figure(figsize=(3.5, 3.6), dpi=200, layout="constrained")
    upper, lower = figure.subplots(2)
    radmpc.plot_plan(jumping, upper, details=False, title="collisions count at the steps")
    radmpc.plot_plan(around, lower, details=False, title="collisions count between steps, too")
    figure.savefig(out / "04_between_steps.png")

    assert radmpc.simulate(jumping, 10_000, rng=1).rate == 0.0  # nobody looks between the steps
    assert radmpc.simulate(around, 10_000, rng=1).rate_high < intervals.risk_bound
    return radmpc.simulate(replace(jumping, scenario=intervals), 10_000, rng=1).rate


if __name__ == "__main__":
    print("share of samples that collide between steps:", main(Path()))
