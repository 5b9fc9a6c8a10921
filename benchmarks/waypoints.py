"""Ten vehicles with three waypoints each: how soon there is a certified plan, and what is proven.

    python benchmarks/waypoints.py [--seeds N] [--seconds S]

Waypoints lie anywhere on the way from west to east, among four boxes; vehicles cross each other.
Every visit may take place at any step: that is 29 · 28 · 27 / 6 choices for each vehicle.
"""

from __future__ import annotations

import argparse
import time
from functools import partial

import numpy as np

import radmpc

SIZE, HORIZON, VEHICLES, WAYPOINTS, BOXES = 60.0, 30, 10, 3, 4
CLEAR = 2.5
"""What waypoints keep from boxes [m]."""


def scenario(seed: int) -> radmpc.Scenario:
    """Return a fleet that crosses a square, everyone by way of some boxes."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(10.0, SIZE - 14.0, (BOXES, 2))
    obstacles = [radmpc.Obstacle.box(f"box {k}", c, c + 4.0) for k, c in enumerate(corners)]
    system = radmpc.double_integrator(1.0, 2)
    gain = radmpc.lqr_gain(system, np.eye(4), 5.0 * np.eye(2))
    fleet = []
    for i in range(VEHICLES):
        places = np.column_stack(
            [
                np.sort(rng.uniform(0.15 * SIZE, 0.85 * SIZE, WAYPOINTS)),
                rng.uniform(5.0, SIZE - 5.0, WAYPOINTS),
            ]
        )
        for place in places:
            for corner in corners:
                if np.all((place > corner - CLEAR) & (place < corner + 4.0 + CLEAR)):
                    place[1] = corner[1] + 4.0 + CLEAR
        rows = SIZE * (np.array([i, (7 * i + 3) % VEHICLES]) + 0.5) / VEHICLES
        fleet.append(
            radmpc.Vehicle(
                name=f"v{i}",
                system=system,
                start=[0.0, rows[0]],
                goal=radmpc.Goal.at([SIZE, rows[1]], 0.5),
                radius=0.4,
                control_limit=3.0,
                initial_covariance=1e-3,
                disturbance_covariance=[1e-3, 1e-3, 1e-4, 1e-4],
                speed_limit=8.0,
                gain=gain,
                via=[radmpc.Visit.at(place, 1.0) for place in places],
            )
        )
    return radmpc.Scenario(f"waypoints {seed}", 1.0, HORIZON, 0.01, fleet, obstacles)


def note(told: list[tuple[float, float]], begun: float, cost: float, bound: float | None) -> None:
    """Note when a better plan was found, and its cost."""
    del bound
    told.append((time.process_time() - begun, cost))


def main() -> None:
    """Print one line per seed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=60.0)
    asked = parser.parse_args()
    print("seed  first plan [CPU s]  its cost  cost  bound  gap  certified  all [CPU s]")
    for seed in range(asked.seeds):
        begun, told = time.process_time(), list[tuple[float, float]]()

        found = partial(note, told, begun)
        result = radmpc.plan(scenario(seed), time_limit=asked.seconds, found=found)
        plan = result.require()
        bound = plan.certified_lower_bound or 0.0
        seconds, first = told[0]
        print(
            f"{seed:4d}  {seconds:18.2f}  {first:8.2f}  {plan.cost:.2f}  {bound:.2f}  "
            f"{100.0 * (1.0 - bound / plan.cost):.1f} %  {plan.risk.certified:.4g}  "
            f"{time.process_time() - begun:.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
