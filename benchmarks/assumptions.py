"""What is assumed of the noise, and what it costs: the same problems under one assumption each.

    python benchmarks/assumptions.py [--seeds N] [--gap G] [--seconds S] [--only NAME]

Every assumption is held against a reference of its own: what lasts against what does not, with the
same covariance in each step; what is shared against as much that everyone meets alone; what is
measured against what is known exactly, both with feedback. Costs are the effort of plans relative
to the reference's, seconds are the processor's, both geometric means over the problems and seeds
that have plans under both. A plan that is made to a gap of G may cost 1 + G times the best.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType
from unittest.mock import patch

import numpy as np

import radmpc
from radmpc.experiments.families import circle, clutter, paper
from radmpc.planners import Branch, Certified, Optimal, Planner

Assumption = Callable[[radmpc.Scenario], radmpc.Scenario]


def problems(seeds: int) -> Mapping[str, list[radmpc.Scenario]]:
    """Return the problems of each family."""
    return {
        "paper(4)": [paper(4, seed) for seed in range(seeds)],
        "paper(8)": [paper(8, seed) for seed in range(seeds)],
        "circle(4)": [circle(4)],
        "clutter(2, 10)": [clutter(2, 10, seed) for seed in range(seeds)],
    }


def _each(
    scenario: radmpc.Scenario, change: Callable[[radmpc.Vehicle], radmpc.Vehicle]
) -> radmpc.Scenario:
    """Change every vehicle."""
    return replace(scenario, vehicles=tuple(change(vehicle) for vehicle in scenario.vehicles))


def _as_it_is(scenario: radmpc.Scenario) -> radmpc.Scenario:
    """Assume what the family does: white noise, independent, open loop, all known."""
    return scenario


def _current(scenario: radmpc.Scenario) -> radmpc.Scenario:
    """Let a current of 0.2 m/s carry all."""
    drift = [0.2 * scenario.dt, 0.0, 0.0, 0.0]
    return _each(scenario, lambda vehicle: replace(vehicle, drift=drift))


def _lasting(correlation: float) -> Assumption:
    """Let disturbances last, each step's as large as before."""
    return lambda scenario: _each(
        scenario, lambda vehicle: replace(vehicle, disturbance_correlation=correlation)
    )


def _gusts(*, together: bool) -> Assumption:
    """Let three quarters of the disturbance be gusts: one for all, or one for each."""

    def with_gusts(scenario: radmpc.Scenario) -> radmpc.Scenario:
        """Split everyone's disturbance."""
        whole = scenario.vehicles[0].disturbance_covariance
        name = "gust" if together else "gust of {}"
        return _each(
            scenario,
            lambda vehicle: replace(
                vehicle,
                disturbance_covariance=0.25 * whole,
                shared=(
                    radmpc.SharedDisturbance(
                        name.format(vehicle.name), np.eye(len(whole)), 0.75 * whole
                    ),
                ),
            ),
        )

    return with_gusts


def _feedback(scenario: radmpc.Scenario) -> radmpc.Scenario:
    """Let everyone steer back to the plan by the state itself."""

    def steered(vehicle: radmpc.Vehicle) -> radmpc.Vehicle:
        """Close the loop."""
        return replace(vehicle, gain=radmpc.lqr_gain(vehicle.system, np.eye(4), 10.0 * np.eye(2)))

    return _each(scenario, steered)


def _receivers(deviation: float) -> Assumption:
    """Let everyone steer by positions measured within so many meters."""
    measured = radmpc.Measurement.of([0, 1], 4, deviation**2)
    return lambda scenario: _each(
        _feedback(scenario), lambda vehicle: replace(vehicle, measurement=measured)
    )


def _samples(number: int) -> Assumption:
    """Let the covariances be estimates from so many steps."""
    return lambda scenario: replace(scenario, covariance_samples=number)


def _crossing(deviation: float) -> Assumption:
    """Let something cross the middle of the first vehicle's way at half time."""

    def with_crossing(scenario: radmpc.Scenario) -> radmpc.Scenario:
        """Add it."""
        vehicle = scenario.vehicles[0]
        meeting = 0.5 * (vehicle.start_position + vehicle.goal.center)
        velocity = np.array([0.0, 0.6])
        start = [*(meeting - 0.5 * scenario.dt * scenario.horizon * velocity), *velocity]
        spread = [deviation**2] * 2 + [(0.2 * deviation) ** 2] * 2
        outline = [[-0.5, -1.0], [0.5, -1.0], [0.5, 1.0], [-0.5, 1.0]]
        crossing = radmpc.Obstacle.tracked("crossing", outline, start, spread)
        return replace(scenario, obstacles=(*scenario.obstacles, crossing))

    return with_crossing


ASSUMPTIONS: Mapping[str, tuple[Assumption, Assumption]] = MappingProxyType(
    {
        "a current of 0.2 m/s": (_as_it_is, _current),
        "disturbances that last, correlation 0.5": (_as_it_is, _lasting(0.5)),
        "disturbances that last, correlation 0.8": (_as_it_is, _lasting(0.8)),
        "3/4 of the disturbance is one gust for all": (
            _gusts(together=False),
            _gusts(together=True),
        ),
        "feedback by the state": (_as_it_is, _feedback),
        "receivers of 5 cm": (_feedback, _receivers(0.05)),
        "receivers of 20 cm": (_feedback, _receivers(0.2)),
        "covariances from 100 steps": (_as_it_is, _samples(100)),
        "covariances from 10 steps": (_as_it_is, _samples(10)),
        "somebody crosses, place within 0.1 m": (_crossing(0.0), _crossing(0.1)),
        "somebody crosses, place within 0.3 m": (_crossing(0.0), _crossing(0.3)),
    }
)
"""What is assumed, by name: the reference and the assumption."""


def planned(scenario: radmpc.Scenario, gap: float, seconds: float) -> tuple[float, float]:
    """Return a plan's cost (inf without a certified one) and the seconds of the processor."""
    with patch("time.monotonic", time.process_time):
        begun = time.process_time()
        planner = Planner(Optimal(), Branch(), Certified(), gap=gap)
        result = radmpc.plan(scenario, planner, rng=0, time_limit=seconds)
        taken = time.process_time() - begun
    cost = result.cost if result.is_certified and result.cost is not None else math.inf
    return cost, taken


def compared(
    pair: tuple[Assumption, Assumption],
    scenarios: list[radmpc.Scenario],
    gap: float,
    seconds: float,
) -> Iterator[tuple[tuple[float, float], tuple[float, float]]]:
    """Yield cost and seconds of reference and assumption, problem by problem."""
    for scenario in scenarios:
        first, second = (planned(change(scenario), gap, seconds) for change in pair)
        yield first, second


def _mean(ratios: list[float]) -> str:
    """Return a geometric mean as text."""
    return f"{math.exp(math.fsum(map(math.log, ratios)) / len(ratios)):.3f}" if ratios else "–"


def main() -> None:
    """Print one line per assumption and family."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--gap", type=float, default=0.005)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--only", help="assumptions whose name contains this")
    asked = parser.parse_args()
    if not any((asked.only or "") in name for name in ASSUMPTIONS):
        parser.error(f"no assumption has {asked.only!r} in its name")
    print("| assumption | problems | plans | effort | seconds |\n|---|---|---|---|---|")
    for name, pair in ASSUMPTIONS.items():
        if asked.only and asked.only not in name:
            continue
        for family, scenarios in problems(asked.seeds).items():
            rows = list(compared(pair, scenarios, asked.gap, asked.seconds))
            both = [(a, b) for a, b in rows if math.isfinite(a[0]) and math.isfinite(b[0])]
            with_plan = sum(math.isfinite(b[0]) for _, b in rows)
            effort = _mean([b[0] / a[0] for a, b in both])
            spent = _mean([b[1] / a[1] for a, b in both])
            counted = f"{with_plan} of {len(rows)}"
            print(f"| {name} | {family} | {counted} | {effort} | {spent} |", flush=True)


if __name__ == "__main__":
    main()
