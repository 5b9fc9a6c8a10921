"""One vehicle, nothing in the way.

A boat moves from rest to rest with the least effort. The answer is known on paper: push once at
the first step, coast, brake once at the last. A push of u then carries it u (T - 1) dt² far, so
that the way L along an axis costs 2 L / ((T - 1) dt²), and the axes add up. The planner, which
searches over all controls, must find the same number.
"""

from pathlib import Path

import radmpc

DT, HORIZON = 1.0, 10
WAY = (9.0, 4.5)  # east and north [m]

EXPECTED = 2.0 * sum(WAY) / ((HORIZON - 1) * DT**2)
TOLERANCE = 0.001 * EXPECTED  # the planner proves its plan optimal within 0.1 %


def main(out: Path) -> float:
    """Plan, draw, and return the cost."""
    boat = radmpc.Vehicle(
        name="boat",
        system=radmpc.double_integrator(DT, dimension=2),
        start=[0.0, 0.0, 0.0, 0.0],  # position [m], velocity [m/s]
        goal=radmpc.Goal(lower=WAY, upper=WAY, speed=[0.0, 0.0]),
        radius=0.4,
        control_limit=[2.0, 2.0],
        initial_covariance=[1e-3, 1e-3, 1e-4, 1e-4],
        disturbance_covariance=[1e-3, 1e-3, 1e-4, 1e-4],
    )
    scenario = radmpc.Scenario(
        name="one vehicle", dt=DT, horizon=HORIZON, risk_bound=0.05, vehicles=(boat,)
    )
    plan = radmpc.plan(scenario).require()
    radmpc.save_figure(plan, out / "01_one_vehicle.png")
    assert plan.cost is not None  # only where there is no plan
    return plan.cost


if __name__ == "__main__":
    print("effort [m/s²]:", main(Path()))
