"""Two vehicles swap places.

East and west meet head-on and share one risk bound. The certificate is proven: the probability of
a collision is at most that number. Of 100,000 random samples of the plan, the share that collides
must be below the certificate, and it is a little below: a half-space is charged instead of a disc.
"""

from pathlib import Path

import radmpc

EXPECTED = 0.0453
TOLERANCE = 0.004  # one standard deviation of the count is 0.0005, plans may differ by 0.1 %


def vehicle(name: str, start: list[float], goal: list[float]) -> radmpc.Vehicle:
    """Return a small boat, at rest at both ends."""
    return radmpc.Vehicle(
        name=name,
        system=radmpc.double_integrator(1.0, dimension=2),
        start=[*start, 0.0, 0.0],
        goal=radmpc.Goal(goal, goal, speed=[0.0, 0.0]),
        radius=0.4,
        control_limit=[2.0, 2.0],
        initial_covariance=[1e-3, 1e-3, 1e-4, 1e-4],
        disturbance_covariance=[1e-3, 1e-3, 1e-4, 1e-4],
    )


def main(out: Path) -> float:
    """Plan, draw, and return the share of simulated missions that collide."""
    fleet = (vehicle("east", [0.0, 0.0], [10.0, 0.0]), vehicle("west", [10.0, 0.5], [0.0, 0.5]))
    scenario = radmpc.Scenario("swap", dt=1.0, horizon=10, risk_bound=0.05, vehicles=fleet)
    plan = radmpc.plan(scenario).require()
    radmpc.save_figure(plan, out / "03_two_vehicles.png")

    flown = radmpc.simulate(plan, 100_000, rng=1)
    assert flown.rate_high < radmpc.certify(plan).certified <= scenario.risk_bound
    return flown.rate


if __name__ == "__main__":
    print("share of samples that collide:", main(Path()))
