"""What one would fly otherwise: velocity obstacles, and receding plans without an account.

``orca`` is ORCA of van den Berg et al. by its authors' library (`pip install pyrvo`): at every step
each vehicle takes the velocity nearest to the one that would bring it to where the first plan has
it next, among those that others, who do likewise, cannot turn into a collision. (Alone it finds no
way around what stands between a vehicle and its goal.) ``dmpc`` plans the steps
that are left with the preset of that name, from measured states, at every step: one vehicle after
the other, three standard deviations kept by each row, or as many as leave a plan: two, one, none.
What has no plan at all flies what is left of its last one.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from radmpc.flying.flight import Flight
from radmpc.flying.model import Model
from radmpc.flying.remainder import left_of
from radmpc.flying.tick import Segment
from radmpc.model.plan import Plan
from radmpc.model.vehicle import Vehicle
from radmpc.planning import plan

__all__ = ["PEERS", "flown_by"]

_LOOK_AHEAD, _OBSTACLES_AHEAD = 5.0, 1.0
"""Time over which velocities keep vehicles apart, and from obstacles [steps]. The first plan leads
around those: to look further ahead is to stop before each of them."""

_FAR = 1e3
"""Distance from which on others are overlooked [m]."""

_DEVIATIONS = (3, 2, 1, 0)
"""Standard deviations that receding plans keep; the first number that leaves a plan [-]."""

_SECONDS = 10.0
"""What such a plan may take [s]."""

Controls = list[np.ndarray]
Steering = Callable[[int, Sequence[np.ndarray]], Controls]
"""From a step and the states that are measured there to controls."""


@dataclass(frozen=True)
class Step:
    """What is kept of a step: the decision and the seconds of the processor that it took."""

    segments: tuple[Segment, ...]
    seconds: float
    choice: str = "tail"
    wealth: float = np.inf


def flown_by(peer: str, first: Plan, seed: int) -> Flight:
    """Fly one mission by a peer, in the noise that missions with this seed meet."""
    scenario = first.scenario
    steer, backend = PEERS[peer](first), Model(scenario, seed)
    states, contacts = backend.reset()
    met, visited, ticks, effort = list(contacts), [tuple(states)], list[Any](), 0.0
    for step in range(scenario.horizon):
        begun = time.process_time()
        controls = steer(step, states)
        taken = time.process_time() - begun
        fleet = zip(scenario.vehicles, states, controls, strict=True)
        segments = tuple(_segment(*each) for each in fleet)
        ticks.append(Step(segments, taken))
        for vehicle, control in zip(scenario.vehicles, controls, strict=True):
            effort += vehicle.cost_weight * float(np.abs(control).sum())
        states, contacts = backend.advance(segments)
        met += contacts
        visited.append(tuple(states))
    return Flight(tuple(ticks), (), tuple(met), tuple(visited), effort)


def _segment(vehicle: Vehicle, state: np.ndarray, control: np.ndarray) -> Segment:
    """Return what a vehicle is told."""
    velocity = vehicle.system.velocity
    return Segment(
        vehicle.name,
        control,
        state[list(vehicle.system.position)],
        None if velocity is None else state[list(velocity)],
    )


def _clipped(vehicle: Vehicle, control: np.ndarray) -> np.ndarray:
    """Return a control within its limits."""
    return np.clip(control, -vehicle.control_limit, vehicle.control_limit)


def _orca(first: Plan) -> Steering:
    """Return steering by reciprocal velocity obstacles along a plan; obstacles must rest."""
    import pyrvo  # noqa: PLC0415 - few have it

    scenario = first.scenario
    vehicles, dt = scenario.vehicles, scenario.dt
    ahead = _LOOK_AHEAD * dt, _OBSTACLES_AHEAD * dt
    simulator = pyrvo.RVOSimulator(dt, _FAR, len(vehicles), *ahead, 1.0, _top(vehicles[0], dt))
    for vehicle in vehicles:
        number = simulator.add_agent(vehicle.start_position.tolist())
        simulator.set_agent_radius(number, float(vehicle.radius))
        simulator.set_agent_max_speed(number, _top(vehicle, dt))
    for obstacle in scenario.obstacles:
        for shape in obstacle.at(0):
            corners = _counterclockwise(shape.vertices)
            simulator.add_obstacle([corner.tolist() for corner in corners])
    simulator.process_obstacles()

    def steer(step: int, states: Sequence[np.ndarray]) -> Controls:
        """Tell the library who is where, and turn its velocities into controls."""
        for i, (vehicle, state) in enumerate(zip(vehicles, states, strict=True)):
            axes = list(vehicle.system.position)
            place = state[axes]
            wanted = (first.trajectories[i].means[step + 1][axes] - place) / dt
            simulator.set_agent_position(i, place.tolist())
            if vehicle.system.velocity is not None:
                now = state[list(vehicle.system.velocity)]
                simulator.set_agent_velocity(i, now.tolist())
            simulator.set_agent_pref_velocity(i, wanted.tolist())
        simulator.do_step()
        controls = []
        for i, (vehicle, state) in enumerate(zip(vehicles, states, strict=True)):
            told = simulator.get_agent_velocity(i)
            velocity = np.array([told.x, told.y])
            controls.append(_clipped(vehicle, _control_to(vehicle, state, velocity, dt)))
        return controls

    return steer


def _control_to(vehicle: Vehicle, state: np.ndarray, velocity: np.ndarray, dt: float) -> np.ndarray:
    """Return the control by which a step covers what the velocity would, or ends at it."""
    axes = vehicle.system.velocity
    if axes is None:  # without inertia: to where the velocity leads
        return np.linalg.solve(vehicle.system.B[list(vehicle.system.position)], velocity * dt)
    return (velocity - state[list(axes)]) / dt


def _top(vehicle: Vehicle, dt: float) -> float:
    """Return the greatest speed that a vehicle may have along an axis [m/s]."""
    if vehicle.speed_limit is not None:
        return float(np.min(vehicle.speed_limit))
    return float(np.min(vehicle.control_limit)) / dt


def _counterclockwise(corners: np.ndarray) -> np.ndarray:
    """Return the corners of a convex polygon in the order that the library asks for."""
    offsets = corners - corners.mean(axis=0)
    return corners[np.argsort(np.arctan2(offsets[:, 1], offsets[:, 0]))]


def _dmpc(first: Plan) -> Steering:
    """Return steering by a plan of what is left, made anew at every step."""
    scenario = first.scenario
    kept: list[list[np.ndarray]] = []
    begun = 0

    def steer(step: int, states: Sequence[np.ndarray]) -> Controls:
        """Plan, and take the first controls; without a plan, the next ones of the last."""
        nonlocal kept, begun
        left = left_of(scenario, step, states, scenario.risk_bound)
        for count in _DEVIATIONS:
            result = plan(left, f"dmpc({count})", rng=0, time_limit=_SECONDS)
            if result.plan is not None:
                kept, begun = [list(t.controls) for t in result.plan.trajectories], step
                break
        if not kept:
            return [np.zeros(v.system.num_controls) for v in scenario.vehicles]
        pairs = zip(scenario.vehicles, kept, strict=True)
        return [_clipped(vehicle, controls[step - begun]) for vehicle, controls in pairs]

    return steer


PEERS: dict[str, Callable[[Plan], Steering]] = {"orca": _orca, "dmpc": _dmpc}
"""Who else flies, by name."""
