"""Drones change their formation.

Eight drones fly from a line to a ring, and any may take any place: `goals` leaves to planning who
takes which, and its plan's explanation tells. Alone and from rest to rest a move by L along an
axis costs 2 L / (T - 1), so what the best assignment costs in empty space, found here by another
way, bounds every plan of every assignment. The number is what the certified plan costs relative to
that bound: no other assignment, however planned, is cheaper. With the places in the order of the
list, round the ring, the drones would need at least 1.36 times as much.
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
    """Plan, draw, and return the effort relative to a bound on all assignments."""
    system = radmpc.double_integrator(1.0, dimension=2)
    places = [radmpc.Goal.at(place) for place in PLACES]
    fleet = [
        radmpc.Vehicle(
            name=f"drone {i + 1}",
            system=system,
            start=start,
            goal=place,
            radius=0.4,
            control_limit=3.0,
            initial_covariance=1e-4,
            disturbance_covariance=1e-4,
            gain=radmpc.lqr_gain(system, np.eye(4), 10.0 * np.eye(2)),
        )
        for i, (start, place) in enumerate(zip(STARTS, places, strict=True))
    ]
    scenario = radmpc.Scenario("formation", 1.0, HORIZON, 0.01, fleet, goals=places)
    plan = radmpc.plan(scenario, rng=0).require()
    radmpc.save_figure(plan, out / "14_formation.png")
    assert plan.cost is not None  # only where there is no plan
    efforts = np.abs(STARTS[:, None] - PLACES).sum(axis=2) * 2.0 / (HORIZON - 1)
    return float(plan.cost / efforts[linear_sum_assignment(efforts)].sum())


if __name__ == "__main__":
    print("effort relative to a bound on all assignments:", main(Path()))
