"""Feedback keeps a long mission on its way.

Open loop, the noise of a long mission adds up: halfway a gate takes most of the risk bound, and
the rover's end is uncertain by more than two meters. Under a linear-quadratic regulator the
position's standard deviation settles instead, at the solution Σ of the Lyapunov equation
Σ = (A + B K) Σ (A + B K)ᵀ + W, found here by scipy. The number is that of the plan at the end.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.linalg import solve_discrete_lyapunov

import radmpc

SYSTEM = radmpc.double_integrator(1.0, dimension=2)
NOISE = np.diag([1e-3, 1e-3, 1e-4, 1e-4])
GAIN = radmpc.lqr_gain(SYSTEM, Q=np.eye(4), R=10.0 * np.eye(2))
CLOSED_LOOP = SYSTEM.A + SYSTEM.B @ GAIN

EXPECTED = float(np.sqrt(solve_discrete_lyapunov(CLOSED_LOOP, NOISE)[0, 0]))
TOLERANCE = 1e-6

TITLES = ("open loop", "under feedback")


def main(out: Path) -> float:
    """Plan both ways, draw, and return the final standard deviation under feedback."""
    open_loop = radmpc.Vehicle(
        name="rover",
        system=SYSTEM,
        start=[0.0, 0.0, 0.0, 0.0],
        goal=radmpc.Goal([25.0, 0.0], [25.0, 0.0], speed=[0.0, 0.0]),
        radius=0.4,
        control_limit=[1.0, 1.0],
        initial_covariance=NOISE,
        disturbance_covariance=NOISE,
    )
    gate = (
        radmpc.Obstacle.box("north", [11.5, 1.2], [13.5, 4.0]),
        radmpc.Obstacle.box("south", [11.5, -4.0], [13.5, -1.2]),
    )
    figure = Figure(figsize=(3.5, 3.4), dpi=200, layout="constrained")
    for axes, title, gain in zip(figure.subplots(2), TITLES, (None, GAIN), strict=True):
        rover = replace(open_loop, gain=gain)
        scenario = radmpc.Scenario("gate", 1.0, 25, 0.05, (rover,), gate)
        plan = radmpc.plan(scenario).require()
        radmpc.plot_plan(plan, axes, details=False, title=title)
    figure.savefig(out / "05_feedback.png")
    return float(np.sqrt(plan.trajectories[0].covariances[-1, 0, 0]))


if __name__ == "__main__":
    print("standard deviation at the end under feedback [m]:", main(Path()))
