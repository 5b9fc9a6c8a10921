"""Vehicles with waypoints: how soon there is a certified plan, and what is proven.

    python benchmarks/waypoints.py [--vehicles N] [--waypoints N] [--seed S] [--seeds N]
                                   [--seconds S] [--windows W] [--price λ]

Waypoints lie anywhere on the way from west to east, among four boxes; vehicles cross each other,
the more the more there are: the square stays as it is, and so do the ten steps per waypoint. Every
visit may take place at any step: that is 29 · 28 · 27 / 6 choices for each vehicle with three.
``--windows 6`` gives each a window of six steps around where it is at even speed, ``--price 1``
lets vehicles arrive in the second half of the horizon and prices the seconds until then.

The clock of the search is the processor's, so that a machine may be shared.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from functools import partial

import numpy as np

import radmpc

SIZE, STEPS, BOXES = 60.0, 10, 4
"""Sides of the square [m], steps per waypoint, boxes in it."""
SPEED, CONTROL = 8.0, 3.0
"""Limits per axis [m/s, m/s²]."""

CLEAR = 2.5
"""What waypoints keep from boxes [m]."""


@dataclass(frozen=True)
class Kind:
    """What fleets are measured.

    Attributes
    ----------
    vehicles, waypoints : int
        How many, and how many each visits.
    windows : int or None
        Steps in the window of each visit; None is all.
    price : float or None
        Of a second until arrival; None is due at the horizon.
    """

    vehicles: int = 10
    waypoints: int = 3
    windows: int | None = None
    price: float | None = None

    @property
    def horizon(self) -> int:
        """Steps."""
        return STEPS * self.waypoints


def scenario(kind: Kind, seed: int) -> radmpc.Scenario:
    """Return a fleet that crosses a square, everyone by way of some boxes."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(10.0, SIZE - 14.0, (BOXES, 2))
    obstacles = [radmpc.Obstacle.box(f"box {k}", c, c + 4.0) for k, c in enumerate(corners)]
    fleet = []
    for i in range(kind.vehicles):
        rows = SIZE * (np.array([i, (7 * i + 3) % kind.vehicles]) + 0.5) / kind.vehicles
        places = waypoints(kind, corners, rng)
        while turning_time(rows, places) > kind.horizon:
            places = waypoints(kind, corners, rng)
        fleet.append(vehicle(kind, f"v{i}", rows, places))
    return radmpc.Scenario(
        f"waypoints {seed}",
        1.0,
        kind.horizon,
        0.01,
        fleet,
        obstacles,
        time_weight=kind.price or 0.0,
    )


def waypoints(kind: Kind, corners: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return places on the way from west to east that keep clear of boxes, (W, 2) [m]."""
    places = np.column_stack(
        [
            np.sort(rng.uniform(0.15 * SIZE, 0.85 * SIZE, kind.waypoints)),
            rng.uniform(5.0, SIZE - 5.0, kind.waypoints),
        ]
    )
    for place in places:
        for corner in corners:
            if np.all((place > corner - CLEAR) & (place < corner + 4.0 + CLEAR)):
                place[1] = corner[1] + 4.0 + CLEAR
    return places


def turning_time(rows: np.ndarray, places: np.ndarray) -> float:
    """Return about how long the way takes from north to south and back, with a turn at each [s]."""
    way = np.abs(np.diff([rows[0], *places[:, 1], rows[1]]))
    return float(np.sum(way / SPEED + np.where(way > 2.0 * CLEAR, SPEED / CONTROL, 0.0)))


def vehicle(kind: Kind, name: str, rows: np.ndarray, places: np.ndarray) -> radmpc.Vehicle:
    """Return a vehicle that goes from one row in the west to another in the east."""
    system = radmpc.double_integrator(1.0, 2)
    ends = np.array([[0.0, rows[0]], [SIZE, rows[1]]])
    legs = np.linalg.norm(np.diff(np.vstack([ends[:1], places, ends[1:]]), axis=0), axis=1)
    due = np.rint(kind.horizon * np.cumsum(legs)[:-1] / legs.sum()).astype(int)
    early, late = (kind.windows or 0) // 2, ((kind.windows or 0) - 1) // 2
    window = [
        None if kind.windows is None else [max(k - early, 1), min(k + late, kind.horizon - 1)]
        for k in due.tolist()
    ]
    within = None if kind.price is None else [kind.horizon // 2, kind.horizon]
    return radmpc.Vehicle(
        name=name,
        system=system,
        start=ends[0],
        goal=radmpc.Goal.at(ends[1], 0.5, within=within),
        radius=0.4,
        control_limit=CONTROL,
        initial_covariance=1e-3,
        disturbance_covariance=[1e-3, 1e-3, 1e-4, 1e-4],
        speed_limit=SPEED,
        gain=radmpc.lqr_gain(system, np.eye(4), 5.0 * np.eye(2)),
        via=[
            radmpc.Visit.at(place, 1.0, between=between)
            for place, between in zip(places, window, strict=True)
        ],
    )


def note(told: list[tuple[float, float]], begun: float, cost: float, bound: float | None) -> None:
    """Note when a better plan was found, and its cost."""
    del bound
    told.append((time.process_time() - begun, cost))


def main() -> None:
    """Print one line per seed."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--vehicles", type=int, default=10)
    parser.add_argument("--waypoints", type=int, default=3)
    parser.add_argument("--windows", type=int)
    parser.add_argument("--price", type=float)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=60.0)
    asked = parser.parse_args()
    kind = Kind(asked.vehicles, asked.waypoints, asked.windows, asked.price)
    time.monotonic = time.process_time
    print("seed  first plan [CPU s]  its cost  cost  bound  gap  certified  all [CPU s]")
    for seed in range(asked.seed, asked.seed + asked.seeds):
        begun, told = time.process_time(), list[tuple[float, float]]()
        found = partial(note, told, begun)
        result = radmpc.plan(scenario(kind, seed), time_limit=asked.seconds, found=found)
        plan, taken = result.plan, time.process_time() - begun
        if plan is None or not told or plan.cost is None:
            print(f"{seed:4d}  no plan after {taken:.1f} s: {result.explanation}", flush=True)
            continue
        bound = plan.certified_lower_bound or 0.0
        seconds, first = told[0]
        print(
            f"{seed:4d}  {seconds:18.2f}  {first:8.2f}  {plan.cost:.2f}  {bound:.2f}  "
            f"{100.0 * (1.0 - bound / plan.cost):.1f} %  {plan.risk.certified:.4g}  {taken:.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
