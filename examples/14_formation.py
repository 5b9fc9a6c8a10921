"""Drones change their formation.

Eight drones fly from a line to a ring, and any may take any place. Alone and from rest to rest a
move by L along an axis costs 2 L / (T - 1), so the cheapest assignment in empty space is a linear
assignment of distances along the axes; its cost is a bound on every plan of every assignment.
With it nobody is in anybody's way. The number is what the certified plan costs relative to that
bound: no other assignment, however planned, is cheaper.
"""

from pathlib import Path

import numpy as np
from scipy.optimize import linear_sum_assignment

import radmpc

EXPECTED, TOLERANCE = 1.0, 0.005

DRONES, HORIZON, RING = 8, 9, 4.0
ANGLES = 2.0 * np.pi * (np.arange(DRONES) + 0.5) / DRONES
STARTS = np.column_stack([np.zeros(DRONES), 2.0 * np.arange(DRONES) - DRONES + 1.0])
PLACES = np.column_stack([12.0 + RING * np.cos(ANGLES), RING * np.sin(ANGLES)])


def main(out: Path) -> float:
    """Assign, plan, draw, and return the effort relative to a bound on all assignments."""
    system = radmpc.double_integrator(1.0, dimension=2)
    efforts = np.abs(STARTS[:, None] - PLACES).sum(axis=2) * 2.0 / (HORIZON - 1)
    drones, places = linear_sum_assignment(efforts)
    fleet = [
        radmpc.Vehicle(
            name=f"drone {i + 1}",
            system=system,
            start=STARTS[i],
            goal=radmpc.Goal.at(PLACES[k]),
            radius=0.4,
            control_limit=3.0,
            initial_covariance=1e-4,
            disturbance_covariance=1e-4,
            gain=radmpc.lqr_gain(system, np.eye(4), 10.0 * np.eye(2)),
        )
        for i, k in zip(drones, places, strict=True)
    ]
    plan = radmpc.plan(radmpc.Scenario("formation", 1.0, HORIZON, 0.01, fleet), rng=0).require()
    radmpc.save_figure(plan, out / "14_formation.png")
    assert plan.cost is not None  # only where there is no plan
    return float(plan.cost / efforts[drones, places].sum())


if __name__ == "__main__":
    print("effort relative to a bound on all assignments:", main(Path()))
