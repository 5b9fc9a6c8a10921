"""Plans that the second simulator flies, too: clipped, turning, hovering, in space."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from fleets import PLENTY, euler, permuted, stepper, thrusters
from referee_scenes import make_plan

from radmpc.model.dynamics import LinearSystem, double_integrator, lqr_gain
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle

KINDS = (
    "collisions",
    "pair_collisions",
    "obstacle_collisions",
    "workspace_exits",
    "saturated",
)


def craft(
    name: str,
    system: LinearSystem,
    place: list[float],
    *,
    gain: np.ndarray | None = None,
    limit: float = PLENTY,
    noise: float = 0.1,
    radius: float = 0.3,
    speed: list[float] | None = None,
) -> Vehicle:
    """A vehicle somewhere, with noise on velocities alone where it has any."""
    d, n = system.dimension, system.num_states
    axes = list(system.position)
    start, variances = np.zeros(n), np.full(n, noise**2)
    start[axes] = place
    if n > d:
        variances[axes] = 0.0
    if speed is not None:
        start[[i for i in range(n) if i not in axes]] = speed
    return Vehicle(
        name=name,
        system=system,
        start=start,
        goal=Goal(np.full(d, -PLENTY), np.full(d, PLENTY), None),
        radius=radius,
        control_limit=np.full(system.num_controls, limit),
        initial_covariance=np.diag(variances),
        disturbance_covariance=np.diag(variances),
        gain=gain,
    )


def pd(position: float, velocity: float, d: int = 2) -> np.ndarray:
    """Feedback on position and velocity of a double integrator in its usual order."""
    return -np.hstack([position * np.eye(d), velocity * np.eye(d)])


def still(*fleet: Vehicle, horizon: int = 8, **more: object) -> Plan:
    """A plan whose nominal controls are zero."""
    controls = [np.zeros((horizon, v.system.num_controls)) for v in fleet]
    return pushed(fleet, controls, **more)


def pushed(fleet: tuple[Vehicle, ...], controls: list[np.ndarray], **more: object) -> Plan:
    """A plan with given controls."""
    options = {"dt": 1.0, "risk_bound": 0.05, **more}
    scenario = Scenario("s", horizon=len(controls[0]), vehicles=fleet, **options)  # type: ignore[arg-type] # keys by name
    return make_plan(scenario, controls)


DI = double_integrator(1.0, 2)


def wall(gap: float) -> Obstacle:
    """A wall that leaves a vehicle at the origin so much room."""
    return Obstacle.box("wall", [0.3 + gap, -50.0], [3.0, 50.0])


def beside_a_wall(gain: np.ndarray | None, gap: float, **more: object) -> Plan:
    """A hovering vehicle."""
    return still(craft("a", DI, [0, 0], gain=gain), obstacles=(wall(gap),), **more)


def soft() -> Plan:
    return beside_a_wall(pd(0.3, 0.9), 0.2)


def dead_beat() -> Plan:
    return beside_a_wall(pd(1.0, 1.5), 0.07)


def dead_beat_at_steps() -> Plan:
    return beside_a_wall(pd(1.0, 1.5), 0.05, avoidance="steps")


def overcorrecting() -> Plan:
    return beside_a_wall(pd(1.3, 1.4), 0.09)


def quick_and_dear() -> Plan:
    return beside_a_wall(lqr_gain(DI, np.eye(4), 0.1 * np.eye(2)), 0.1)


def without_feedback() -> Plan:
    return still(craft("a", DI, [0, 0], noise=0.05), obstacles=(wall(0.3),), horizon=4)


def clipped_beside_a_wall() -> Plan:
    # Two deviations of what the feedback asks for are not there: nearly all missions saturate.
    vehicle = craft("a", DI, [0, 0], gain=pd(1.0, 1.5), limit=0.12)
    return still(vehicle, obstacles=(wall(0.3),))


def clipped_on_the_way() -> Plan:
    # Braking takes nearly all there is; what drifts off flies into walls thought out of reach.
    far = Obstacle.box("far", [-50.0, 1.6], [50.0, 3.0])
    vehicle = craft("a", DI, [-3, 0], gain=pd(0.8, 1.3), limit=0.35, noise=0.15, speed=[1.2, 0])
    push = np.array([[-0.3, 0.0]] * 4 + [[0.0, 0.0]] * 4)
    return pushed((vehicle,), [push], obstacles=(wall(0.3), far))


def clipped_at_steps() -> Plan:
    return replace(
        clipped_on_the_way(),
        scenario=replace(clipped_on_the_way().scenario, avoidance="steps"),
    )


def clipped_pair() -> Plan:
    a = craft("a", DI, [0, 0], gain=pd(1.0, 1.5), limit=0.15)
    b = craft("b", DI, [1.2, 0.2], gain=pd(0.3, 0.9), limit=0.1)
    return still(a, b)


def clipped_stepper() -> Plan:
    system = stepper(1.0, 2, np.random.default_rng(1))
    vehicle = craft("a", system, [0, 0], gain=-0.9 * np.linalg.inv(system.B), limit=0.15)
    return still(vehicle, obstacles=(wall(0.2),))


def permuted_and_clipped() -> Plan:
    system = permuted(1.0, 2, np.random.default_rng(3))
    gain = lqr_gain(system, np.eye(4), 0.1 * np.eye(2))
    vehicle = craft("a", system, [0, 0], gain=gain, limit=0.25)
    push = np.random.default_rng(0).normal(0.0, 0.05, (6, 2))
    return pushed((vehicle,), [push], obstacles=(wall(0.06),))


def three_thrusters() -> Plan:
    system = thrusters(1.0, 2, np.random.default_rng(4))
    gain = lqr_gain(system, np.eye(4), 0.1 * np.eye(3))
    push = np.random.default_rng(1).normal(0.0, 0.1, (5, 3))
    return pushed((craft("a", system, [0, 0], gain=gain),), [push], obstacles=(wall(0.1),))


def in_space() -> Plan:
    box = Obstacle.box("box", [0.4, 0.35, -5.0], [3.0, 3.0, 5.0])
    system = double_integrator(1.0, 3)
    a = craft("a", system, [0, 0, 0], gain=pd(1.0, 1.5, 3))
    b = craft("b", system, [-0.55, -0.5, -0.4], gain=pd(0.3, 0.9, 3), limit=0.2)
    return still(a, b, obstacles=(box,), horizon=4)


def turning_ferry() -> Plan:
    deck = np.array([[-1.5, -0.4], [1.5, -0.4], [1.5, 0.4], [-1.5, 0.4]])
    places = []
    for k in range(6):
        c, s = np.cos(0.4 * k), np.sin(0.4 * k)
        places.append(deck @ np.array([[c, s], [-s, c]]) + [2.6 - 0.5 * k, 1.2 + 0.1 * k])
    vehicle = craft("a", DI, [0, 0], gain=pd(1.0, 1.5), speed=[0.2, 0])
    push = np.array([[0.1, -0.1], [0.1, -0.1], [-0.2, 0.0], [-0.2, 0.0], [0.0, 0.1]])
    return pushed((vehicle,), [push], obstacles=(Obstacle.moving("ferry", places),))


def turning_solid() -> Plan:
    corners = np.array([[1, 0, 0], [-1, 0.4, 0], [-0.4, -1, 0.2], [0.2, 0.3, 1.0]]) * 0.8
    places = []
    for k in range(4):
        c, s = np.cos(0.5 * k), np.sin(0.5 * k)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        places.append(corners @ turn.T + [1.2 - 0.1 * k, 0.6, 0.1])
    system = double_integrator(1.0, 3)
    vehicle = craft("a", system, [0, 0, 0], gain=pd(1.0, 1.5, 3), noise=0.15)
    return still(vehicle, obstacles=(Obstacle.moving("solid", places),), horizon=3)


def in_a_room() -> Plan:
    vehicle = craft("a", DI, [0, 0], gain=pd(1.0, 1.5), speed=[0.3, 0.0], limit=0.5)
    push = np.array([[-0.2, 0.1], [-0.2, -0.1], [0.1, 0.0], [0.0, 0.0]])
    return pushed((vehicle,), [push], workspace=Workspace([-0.5, -0.15], [0.28, 0.25]))


def mixed_pairs() -> Plan:
    rng = np.random.default_rng(2)
    a = craft("a", DI, [0, 0], gain=pd(1.0, 1.5), limit=0.3)
    b = craft("b", euler(1.0, 2, rng), [0.9, 0.1], gain=pd(0.2, 0.7))
    c = craft("c", stepper(1.0, 2, rng), [-0.3, 0.95])
    other = craft("d", permuted(1.0, 2, rng), [0.7, 1.0])
    return still(a, b, c, other, horizon=3)


def around_a_corner() -> Plan:
    outline = np.array([[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4]])
    corner = Obstacle.polygon("corner", outline - np.array([0.5, 1.5]))
    vehicle = craft("a", DI, [1.2, 1.1], gain=pd(1.0, 1.5), speed=[0.0, -0.4])
    push = np.array([[0.2, 0.1], [0.0, -0.1], [-0.2, 0.1], [-0.1, 0.2]])
    return pushed((vehicle,), [push], obstacles=(corner,))


def unclipped(plan: Plan) -> Plan:
    """The same with all the control anybody may ask for."""
    fleet = tuple(
        replace(v, control_limit=np.full(v.system.num_controls, PLENTY))
        for v in plan.scenario.vehicles
    )
    return replace(plan, scenario=replace(plan.scenario, vehicles=fleet))


SCENES = [
    soft,
    dead_beat,
    dead_beat_at_steps,
    overcorrecting,
    quick_and_dear,
    without_feedback,
    clipped_beside_a_wall,
    clipped_on_the_way,
    clipped_at_steps,
    clipped_pair,
    clipped_stepper,
    permuted_and_clipped,
    three_thrusters,
    in_space,
    turning_ferry,
    turning_solid,
    in_a_room,
    mixed_pairs,
    around_a_corner,
]
