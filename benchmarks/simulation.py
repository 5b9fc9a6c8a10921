"""How long the referee takes: certificates and Monte Carlo, from eight vehicles to a thousand.

Run ``python benchmarks/simulation.py [vehicles ...]``. Fleets are planned scenes of eight, tiled at
the same density. Memory is the peak of the whole process.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from radmpc.experiments.families import paper
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan, Risk
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planning import plan
from radmpc.referee import certify, simulate

SAMPLES = 100_000
SIDE = 20.0


def planned_tile(avoidance: str) -> Plan:
    """Return a plan for eight vehicles."""
    scenario = replace(paper(8, 3), avoidance=avoidance)
    return plan(scenario, "radmpc", rng=0).require()


def tiled(tile: Plan, num_vehicles: int) -> Plan:
    """Return copies of a plan side by side."""
    count = -(-num_vehicles // 8)
    columns = int(np.ceil(np.sqrt(count)))
    vehicles: list[Vehicle] = []
    obstacles: list[Obstacle] = []
    trajectories = []
    for i in range(count):
        shift = SIDE * np.array([i % columns, i // columns])
        for obstacle in tile.scenario.obstacles:
            corners = obstacle.at(0)[0].vertices + shift
            obstacles.append(Obstacle.polygon(f"{obstacle.name}-{i}", corners))
        for vehicle, flown in zip(tile.scenario.vehicles, tile.trajectories, strict=True):
            name, moved = f"{vehicle.name}-{i}", np.concatenate([shift, [0.0, 0.0]])
            goal = Goal(vehicle.goal.lower + shift, vehicle.goal.upper + shift, vehicle.goal.speed)
            vehicles.append(replace(vehicle, name=name, start=vehicle.start + moved, goal=goal))
            trajectories.append(replace(flown, name=name, means=flown.means + moved))
    scenario = replace(
        tile.scenario, vehicles=tuple(vehicles[:num_vehicles]), obstacles=tuple(obstacles)
    )
    cost = sum(float(np.abs(t.controls).sum()) for t in trajectories[:num_vehicles])
    return replace(
        tile,
        scenario=scenario,
        cost=cost,
        risk=Risk(scenario.risk_bound),
        sets=(),
        trajectories=tuple(trajectories[:num_vehicles]),
    )


def seconds(work: Callable[[], object], repeats: int = 1) -> float:
    """Return the least time of some runs."""
    times = []
    for _ in range(repeats):
        begun = time.perf_counter()
        work()
        times.append(time.perf_counter() - begun)
    return min(times)


def draw_numbers(num_vehicles: int, steps: int) -> None:
    """Draw as many standard normals as the simulation needs, on two cores."""
    chunk = max(256, 100_000 // (4 * num_vehicles))
    seeds = np.random.SeedSequence(0).spawn(-(-SAMPLES // chunk))

    def draw(seed: np.random.SeedSequence) -> None:
        rng = np.random.default_rng(seed)
        numbers = np.empty((num_vehicles, 4, chunk))
        for _ in range(steps):
            rng.standard_normal(out=numbers)

    with ThreadPoolExecutor(max_workers=2) as pool:
        list(pool.map(draw, seeds))


def main() -> None:
    """Print one line per fleet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sizes", metavar="vehicles", nargs="*", type=int, default=[8, 64, 256])
    sizes = parser.parse_args().sizes
    print(f"{SAMPLES} flights, T = 10; seconds")
    print(f"{'vehicles':>8} {'avoidance':>10} {'certify':>9} {'draw':>7} {'simulate':>9} {'MB':>6}")
    for size in sizes:
        for avoidance in ("steps", "intervals"):
            fleet = tiled(planned_tile(avoidance), size)
            certifying = seconds(lambda fleet=fleet: certify(fleet), 5 if size <= 64 else 1)
            drawing = seconds(lambda size=size: draw_numbers(size, 11))
            flying = seconds(lambda fleet=fleet: simulate(fleet, SAMPLES, rng=0))
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            print(
                f"{size:>8} {avoidance:>10} {certifying:>9.4f} {drawing:>7.2f} {flying:>9.2f} "
                f"{peak:>6.0f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
