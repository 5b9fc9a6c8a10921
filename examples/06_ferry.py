"""A ferry crosses the way.

A moving obstacle is one outline per step; between steps its corners move linearly, and collisions
count there too. With nothing in its way the boat would need 2 L / (T - 1). It could wait for the
ferry to pass, but it is cheaper to hurry past its bow, with a little lead. The number is what that
costs relative to the free path: no more than 0.1 % above the least by the hull's own faces.
"""

from pathlib import Path

import numpy as np

import radmpc

EXPECTED = 1.959  # times the effort of the free path
TOLERANCE = 0.006  # the planner turns half-spaces until a round gains less than 0.01 %

HORIZON, WAY = 10, 10.0
HULL = np.array([[-1.5, -0.6], [1.5, -0.6], [1.5, 0.6], [-1.5, 0.6]])  # of the ferry [m]


def main(out: Path) -> float:
    """Plan, draw, and return the cost relative to that of the free way."""
    ferry = radmpc.Obstacle.moving(
        "ferry", [HULL + np.array([k - 4.0, WAY / 2]) for k in range(HORIZON + 1)]
    )
    boat = radmpc.Vehicle(
        name="boat",
        system=radmpc.double_integrator(1.0, dimension=2),
        start=[1.0, 0.0, 0.0, 0.0],
        goal=radmpc.Goal([1.0, WAY], [1.0, WAY], speed=[0.0, 0.0]),
        radius=0.4,
        control_limit=[2.0, 2.0],
        initial_covariance=[1e-3, 1e-3, 1e-4, 1e-4],
        disturbance_covariance=[1e-3, 1e-3, 1e-4, 1e-4],
    )
    scenario = radmpc.Scenario("ferry", 1.0, HORIZON, 0.05, (boat,), (ferry,))
    plan = radmpc.plan(scenario).require()
    radmpc.save_figure(plan, out / "06_ferry.png")
    assert plan.cost is not None  # only where there is no plan
    return plan.cost / (2 * WAY / (HORIZON - 1))


if __name__ == "__main__":
    print("effort relative to the free way:", main(Path()))
