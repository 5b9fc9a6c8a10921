"""Three drones in space.

With three coordinates everything stays the same: vehicles are balls, obstacles solids, and pairs
keep apart along any of six directions. The paths of three drones cross near one point at one time.
Each alone would need 2 L / (T - 1) along each axis; the number is what the fleet needs, relative
to that.
"""

from pathlib import Path

import numpy as np

import radmpc

EXPECTED = 1.0685  # times the effort without the others
TOLERANCE = 0.003  # half-spaces are turned a few rounds, more on a fast machine

HORIZON = 10
WAYS = {  # start and goal [m]
    "ruby": ([0.0, 0.0, 1.0], [10.0, 10.0, 9.0]),
    "jade": ([10.0, 0.0, 5.0], [0.0, 10.0, 5.0]),
    "onyx": ([5.0, 12.0, 8.0], [5.0, -2.0, 2.0]),
}


def drone(name: str) -> radmpc.Vehicle:
    """Return a drone that hovers at both ends of its way."""
    start, goal = WAYS[name]
    return radmpc.Vehicle(
        name=name,
        system=radmpc.double_integrator(1.0, dimension=3),
        start=[*start, 0.0, 0.0, 0.0],
        goal=radmpc.Goal(goal, goal, speed=np.zeros(3)),
        radius=0.4,
        control_limit=np.full(3, 2.0),
        initial_covariance=[1e-3] * 3 + [1e-4] * 3,
        disturbance_covariance=[1e-3] * 3 + [1e-4] * 3,
    )


def main(out: Path) -> float:
    """Plan, draw, and return the effort relative to that of the drones alone."""
    fleet = tuple(drone(name) for name in WAYS)
    scenario = radmpc.Scenario("drones", dt=1.0, horizon=HORIZON, risk_bound=0.05, vehicles=fleet)
    plan = radmpc.plan(scenario).require()
    radmpc.save_figure(plan, out / "07_in_space.png")
    alone = sum(2 * np.abs(np.subtract(*way)).sum() / (HORIZON - 1) for way in WAYS.values())
    assert plan.cost is not None  # only where there is no plan
    return plan.cost / float(alone)


if __name__ == "__main__":
    print("effort relative to the drones alone:", main(Path()))
