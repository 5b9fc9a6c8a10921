"""Ferries on time.

Two ferries cross a channel and call at one jetty in the middle, each within its own two minutes: the
first from the west, the second from the east. A call is a stop in a box as wide as a ferry is long,
so they have to take turns, and an islet lies beside the jetty. Before and after, they sail when they
like. Below, their calls may take place at any step. The number is the effort of the timetable
relative to that.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import radmpc

EXPECTED, TOLERANCE = 1.2, 0.01

DT, HORIZON = 30.0, 14
SYSTEM = radmpc.double_integrator(DT, dimension=2)
WAYS = {"west": ([0.0, 0.0], [600.0, 40.0]), "east": ([600.0, 0.0], [0.0, 40.0])}
TIMETABLE = {"west": [4, 5], "east": [8, 9]}


def ferry(name: str, between: list[int] | None) -> radmpc.Vehicle:
    """Return a ferry that calls at the jetty within a window."""
    start, goal = WAYS[name]
    return radmpc.Vehicle(
        name, SYSTEM, start, radmpc.Goal.at(goal, 5.0, 0.1), radius=15.0, control_limit=0.1,
        speed_limit=5.0, initial_covariance=[1.0, 1.0, 1e-3, 1e-3],
        disturbance_covariance=[1.0, 1.0, 1e-3, 1e-3],
        gain=radmpc.lqr_gain(SYSTEM, np.diag([1.0, 1.0, 900.0, 900.0]), 1e6 * np.eye(2)),
        via=[radmpc.Visit.at([300.0, 80.0], [15.0, 5.0], between, speed=0.1)],
    )  # fmt: skip


def main(out: Path) -> float:
    """Plan with and without a timetable, draw, and return the ratio of efforts."""
    islet = radmpc.Obstacle.polygon("islet", [[260, -30], [340, -30], [320, 30], [280, 30]])
    figure = Figure(figsize=(4.5, 3.4), dpi=200, layout="constrained")
    efforts = []
    for axes, timetable in zip(figure.subplots(2), (TIMETABLE, {}), strict=True):
        fleet = [ferry(name, timetable.get(name)) for name in WAYS]
        plan = radmpc.plan(radmpc.Scenario("ferries", DT, HORIZON, 0.01, fleet, [islet])).require()
        title = "by the timetable" if timetable else "at any time"
        radmpc.plot_plan(plan, axes, details=False, title=title)
        efforts.append(plan.cost or 0.0)
    figure.savefig(out / "15_ferries.png")
    return efforts[0] / efforts[1]


if __name__ == "__main__":
    print("effort by the timetable relative to that at any time:", main(Path()))
