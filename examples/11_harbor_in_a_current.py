"""A harbor as it is measured.

A current of 0.5 m/s sets through the harbor, gusts of 30 s meet all boats at once, receivers are
good for 1.5 m, and AIS tells of a freighter, which is within 3σ (dashed). Boats steer by what a
Kalman filter makes of fixes. The number is the effort relative to that past a known track.
"""

from pathlib import Path

import numpy as np

import radmpc

EXPECTED, TOLERANCE = 1.031, 0.004  # plans are made to a gap of 0.1 %

DT, HORIZON = 10.0, 14
WALLS = {
    "breakwater": [[65, 35], [77, 35], [77, 63], [105, 63], [105, 75], [65, 75]],
    "islet": [[154, 38], [174, 34], [186, 50], [176, 68], [156, 64]],
    "pier": [[115, 120], [127, 120], [127, 160], [115, 160]],
}
FELT = np.vstack([DT / 2 * np.eye(2), np.eye(2)])  # what 1 m/s of a gust does in a step
GUST = radmpc.SharedDisturbance("gust", FELT, 0.015**2, np.exp(-DT / 30.0))
STARTS = {"tug": [18, 55], "ferry": [22, 100], "survey": [210, 18]}
GOALS = {"tug": [218, 100], "ferry": [88, 140], "survey": [35, 18]}


def boat(name: str, start: list[int], goal: list[int]) -> radmpc.Vehicle:
    """Return a boat that is carried by the current and sees its position within 1.5 m."""
    system, center = radmpc.double_integrator(DT, dimension=2), np.array(goal, dtype=float)
    return radmpc.Vehicle(
        name, system, start, radmpc.Goal(center - 3.0, center + 3.0, [0.6, 0.6]), radius=4.0,
        control_limit=0.15, speed_limit=3.0, initial_covariance=[2.0, 2.0, 0.01, 0.01],
        disturbance_covariance=[0.1, 0.1, 4e-4, 4e-4], shared=[GUST],
        gain=radmpc.lqr_gain(system, np.diag([1.0, 1.0, 100.0, 100.0]), 1e4 * np.eye(2)),
        drift=[0.4 * DT, 0.3 * DT, 0.0, 0.0], measurement=radmpc.Measurement.of([0, 1], 4, 1.5**2),
    )  # fmt: skip


def main(out: Path) -> float:
    """Plan, draw, and return the effort relative to that beside a track known exactly."""
    hull = [[-18, -5], [18, -5], [18, 5], [-18, 5]]
    track, covariance = radmpc.track_from_course(
        [225, 98], 1.2, 268.0, position_deviation=2.0, speed_deviation=0.04, course_deviation=1.0
    )
    walls = [radmpc.Obstacle.polygon(name, corners) for name, corners in WALLS.items()]
    boats, plans = [boat(name, start, GOALS[name]) for name, start in STARTS.items()], []
    for known in (covariance, 0.0):
        freighter = radmpc.Obstacle.tracked("freighter", hull, track, known)
        scenario = radmpc.Scenario("harbor", DT, HORIZON, 0.05, boats, [*walls, freighter])
        plans.append(radmpc.plan(scenario, "certified(0)", rng=0).require())
    radmpc.save_figure(plans[0], out / "11_harbor_in_a_current.png")
    certificate, flown = radmpc.certify(plans[0]), radmpc.simulate(plans[0], 20_000, rng=0)
    assert flown.rate_low <= certificate.certified <= 0.05
    return (plans[0].cost or 0.0) / (plans[1].cost or 1.0)


if __name__ == "__main__":
    print("effort relative to that beside a known track:", main(Path()))
