"""Ferries on time.

Two ferries cross a channel and call at one jetty in the middle, each within a window of its own:
the first from the west, the second from the east. A call is a stop in a box, so they take turns,
and an islet lies beside the jetty. Before and after, they sail when they like. Below, both
windows are wider by a step at either end. The number is the effort of the tight timetable
relative to that.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import radmpc

EXPECTED, TOLERANCE = 1.030, 0.004  # plans are made to a gap of 0.1 %

DT, HORIZON = 30.0, 14
SYSTEM = radmpc.double_integrator(DT, dimension=2)
WAYS = {"west": ([0.0, 0.0], [600.0, 40.0]), "east": ([600.0, 0.0], [0.0, 40.0])}
TIMETABLE = {"west": [4, 5], "east": [9, 10]}
WIDER = {name: [first - 1, last + 1] for name, (first, last) in TIMETABLE.items()}


def ferry(name: str, between: list[int]) -> radmpc.Vehicle:
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
    """Plan with both timetables, draw, and return the ratio of efforts."""
    islet = radmpc.Obstacle.polygon("islet", [[260, -30], [340, -30], [320, 30], [280, 30]])
    figure = Figure(figsize=(4.5, 3.4), dpi=200, layout="constrained")
    efforts = []
    for axes, timetable in zip(figure.subplots(2), (TIMETABLE, WIDER), strict=True):
        fleet = [ferry(name, timetable[name]) for name in WAYS]
        plan = radmpc.plan(radmpc.Scenario("ferries", DT, HORIZON, 0.01, fleet, [islet])).require()
        title = "tight windows" if timetable is TIMETABLE else "wider windows"
        radmpc.plot_plan(plan, axes, details=False, title=title)
        efforts.append(plan.cost or 0.0)
    figure.savefig(out / "15_ferries.png")
    return efforts[0] / efforts[1]


if __name__ == "__main__":
    print("effort of the tight timetable relative to a wider one:", main(Path()))
