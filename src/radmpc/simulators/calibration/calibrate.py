"""Fly, identify, cover: a scenario whose noise is that of a simulator."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.flying.flight import Flight
from radmpc.identification import Identification, Track, identify
from radmpc.importing.logs.applying import provenance
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass, replace
from radmpc.simulators.calibration.covering import Cover, Strays, covering
from radmpc.simulators.calibration.loops import Loop, loops_of
from radmpc.simulators.calibration.missions import (
    Making,
    Rate,
    controls_of_vehicle,
    flown,
    rate_of,
    states_of_vehicle,
)
from radmpc.wording import count_text

__all__ = ["Calibration", "calibrate"]


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """What missions tell of a simulator.

    Attributes
    ----------
    identification : Identification
        Of what steps left unexplained: covariance, drift, time constant, tails, with intervals.
    covers : tuple of Cover
        What is planned with; one for all vehicles, or one for each where they differ.
    loops : tuple of Loop
        Feedback as it was flown, of vehicles that it can be told of.
    scenario : Scenario
        The plan's, with that noise.
    rate : Rate
        How often the plan collided that was flown.
    """

    identification: Identification
    covers: tuple[Cover, ...]
    loops: tuple[Loop, ...]
    scenario: Scenario
    rate: Rate


def calibrate(
    plan: Plan,
    making: Making,
    *,
    missions: int = 20,
    seed: int = 0,
    day: str,
    progress: Callable[[int], None] | None = None,
) -> Calibration:
    """Fly a plan, and return its scenario with the noise that explains the missions.

    Parameters
    ----------
    plan : Plan
        Of double integrators, within its risk bound; its own noise counts for nothing.
    making : callable
        Makes the simulator.
    missions : int
        How often it is flown.
    seed : int
        Of all noise.
    day : str
        When, for the scenario's ``source``.
    progress : callable or None
        Is told how many have been flown, after each.

    Returns
    -------
    Calibration
        The scenario, and what it is made from.

    Raises
    ------
    ArgumentError
        If a number is out of its range.
    FileFormatError
        If missions are too few to tell anything.
    RiskError
        If the plan's certificate exceeds its bound.
    ScenarioError
        If the scenario is none for missions, or for the simulator.
    """
    orders = [_order(plan.scenario, i) for i in range(plan.scenario.num_vehicles)]
    made = flown(plan, making, missions, seed, progress)
    tracks = _tracks(plan.scenario, made, orders)
    found = identify(tracks, dt=plan.scenario.dt)
    strays = [
        Strays(i, vehicle, tuple(order), states_of_vehicle(made, i) - trajectory.means)
        for i, (vehicle, order, trajectory) in enumerate(
            zip(plan.scenario.vehicles, orders, plan.trajectories, strict=True)
        )
    ]
    # A mean that only some have belongs to their maneuvers, and another plan has others.
    drift = found.pooled.drift.value if found.pooled.has_drift else None
    covers = tuple(
        covering(
            one, [s for s in strays if not found.differ or s.vehicle.name in one.vehicles], drift
        )
        for one in found.groups
    )
    changed = _with_covers(plan.scenario, covers, orders, found, day)
    loops = loops_of(plan, tracks, orders)
    return Calibration(found, covers, loops, changed, rate_of(plan.scenario, made))


def _order(scenario: Scenario, number: int) -> list[int]:
    """Return where positions, then velocities, stand in a vehicle's state."""
    system = scenario.vehicles[number].system
    if system.rates is None:
        raise ScenarioError(
            "must be those of a double integrator to be calibrated",
            ("vehicles", number, "dynamics"),
        )
    return [*system.position, *system.rates[0]]


def _tracks(
    scenario: Scenario, missions: Sequence[Flight], orders: Sequence[Sequence[int]]
) -> list[Track]:
    """Return missions as logs: every flight has a clock of its own."""
    times = scenario.dt * np.arange(scenario.horizon + 1, dtype=np.float64)
    d = scenario.dimension
    tracks = []
    for i, vehicle in enumerate(scenario.vehicles):
        states = states_of_vehicle(missions, i)[..., list(orders[i])]
        controls = controls_of_vehicle(missions, i)
        for number, (path, pushes) in enumerate(zip(states, controls, strict=True)):
            # Nothing follows the last sample, but a log has a command there, too.
            commands = np.vstack([pushes, np.zeros((1, d))])
            clock = f"flight {number + 1}"
            source = count_text(len(missions), "mission")
            tracks.append(
                Track(vehicle.name, source, clock, times, path[:, :d], path[:, d:], commands)
            )
    return tracks


def _with_covers(
    scenario: Scenario,
    covers: Sequence[Cover],
    orders: Sequence[Sequence[int]],
    found: Identification,
    day: str,
) -> Scenario:
    """Return a scenario with the noise."""
    vehicles = list(scenario.vehicles)
    for cover in covers:
        for i in cover.vehicles:
            places = np.argsort(orders[i])
            vehicles[i] = replace(
                vehicles[i],
                disturbance_covariance=cover.covariance[np.ix_(places, places)],
                drift=None if cover.drift is None else cover.drift[places],
                shared=(),  # what vehicles share is in what was flown
            )
    source = {
        **(scenario.source or {}),
        "noise": {
            **provenance(found, day),
            "by_deviations": [round(cover.ratio, 3) for cover in covers],
        },
    }
    return replace(scenario, vehicles=tuple(vehicles), source=source, covariance_samples=None)
