"""Random scenarios and plans, of everything that files can hold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.model.noise.measurement import Measurement
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import LedgerRow, Plan, Risk, Status, Trajectory
from radmpc.model.relations.concerns import all_but, only_for
from radmpc.model.relations.keep import Keep
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.model.visits import Visit

texts = st.text(st.characters(exclude_categories=["Cs", "Cc"]), min_size=1, max_size=8)
finite = st.floats(-1e9, 1e9)
positive = st.floats(1e-9, 1e6)
probabilities = st.floats(0.0, 1.0)


def arrays(*shape: int) -> st.SearchStrategy[np.ndarray]:
    return hnp.arrays(np.float64, shape, elements=finite)


def covariances(size: int) -> st.SearchStrategy[np.ndarray]:
    roots = hnp.arrays(np.float64, (size, size), elements=st.floats(-10.0, 10.0))
    return st.one_of(
        st.just(np.zeros((size, size))),
        hnp.arrays(np.float64, size, elements=st.floats(0.0, 10.0)).map(np.diag),
        roots.map(lambda root: root @ root.T),
    )


@st.composite
def obstacles(draw: st.DrawFn, name: str, d: int, horizon: int) -> Obstacle:
    corner = np.array(draw(st.lists(st.floats(-100.0, 100.0), min_size=d, max_size=d)))
    size = draw(st.floats(0.1, 50.0))
    kind = draw(st.sampled_from(["box", "polygon", "line", "halfspaces", "moving", "tracked"]))
    # Bodies, plates, walls and posts.
    flat = np.eye(d)[draw(st.integers(0, d - 1))] * draw(st.booleans())
    points = np.vstack([np.zeros(d), np.eye(d)])
    if kind == "box":
        return Obstacle.box(name, corner, corner + size * (1.0 - flat))
    if kind == "line":
        return Obstacle.line(name, corner + size * np.eye(d)[: draw(st.integers(1, d))])
    if kind == "polygon" and d == 2 and draw(st.booleans()):
        points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.5, 0.5], [0.5, 1.0], [0.0, 1.0]])
    if kind == "polygon":
        return Obstacle.polygon(name, corner + size * points)
    if kind == "moving":
        places = size * points * (1.0 - flat)
        return Obstacle.moving(name, [corner + k + places for k in range(horizon + 1)])
    if kind == "tracked":
        start = np.concatenate([corner, draw(hnp.arrays(np.float64, d, elements=st.floats(-9, 9)))])
        noises = [draw(covariances(2 * d)) for _ in range(2)]
        return Obstacle.tracked(name, size * points * (1.0 - flat), start, *noises)
    normals = np.vstack([np.eye(d), -3.0 * np.eye(d)])
    return Obstacle.halfspaces(name, normals, np.concatenate([corner + size, -3.0 * corner]))


@st.composite
def systems(draw: st.DrawFn, dt: float, d: int) -> LinearSystem:
    if draw(st.booleans()):
        return double_integrator(dt, d)
    n, m = draw(st.integers(2 * d, 2 * d + 1)), draw(st.integers(1, 3))
    order = draw(st.permutations(range(n)))
    velocity = tuple(order[d : 2 * d]) if draw(st.booleans()) else None
    A, B = draw(small(10.0, n, n)), draw(small(10.0, n, m))
    return LinearSystem(A, B, tuple(order[:d]), velocity)


def small(largest: float, *shape: int) -> st.SearchStrategy[np.ndarray]:
    """Dynamics and gains that do not grow beyond all bounds within three steps."""
    return hnp.arrays(np.float64, shape, elements=st.floats(-largest, largest))


@st.composite
def goals(draw: st.DrawFn, d: int, has_speed: bool) -> Goal:
    center = draw(hnp.arrays(np.float64, d, elements=st.floats(-50.0, 50.0)))
    half = draw(hnp.arrays(np.float64, d, elements=st.floats(0.0, 5.0)))
    speed = hnp.arrays(np.float64, d, elements=st.floats(0.0, 5.0))
    wants_speed = has_speed and draw(st.booleans())
    return Goal(center - half, center + half, draw(speed) if wants_speed else None)


def arriving(vehicle: Vehicle, horizon: int) -> st.SearchStrategy[Vehicle]:
    """The same, in some window of arrival."""
    return st.integers(1, horizon).flatmap(
        lambda first: st.integers(first, horizon).map(
            lambda last: replace(vehicle, goal=replace(vehicle.goal, within=(first, last)))
        )
    )


@st.composite
def visits(draw: st.DrawFn, vehicle: Vehicle, horizon: int) -> tuple[Visit, ...]:
    """At most one for each step, in windows that leave them their order."""
    d, found = vehicle.system.dimension, []
    for k in range(1, draw(st.integers(0, horizon)) + 1):
        box = draw(goals(d, vehicle.system.velocity is not None))
        found.append(Visit(box.lower, box.upper, (k, draw(st.integers(k, horizon))), box.speed))
    return tuple(found)


def drifts(system: LinearSystem, dt: float) -> st.SearchStrategy[np.ndarray]:
    """Any, or a current in whole millimeters per second."""
    current = st.integers(-3000, 3000).map(
        lambda speed: np.eye(system.num_states)[system.position[0]] * (speed / 1000.0 * dt)
    )
    return st.one_of(current, arrays(system.num_states))


def correlations(dt: float) -> st.SearchStrategy[float]:
    """None, any, or that of a time constant in whole tenths of a second."""
    constant = st.integers(1, 1000).map(lambda tenths: float(np.exp(-dt / (tenths / 10.0))))
    return st.one_of(st.just(0.0), constant, st.floats(0.0, 0.999999))


@st.composite
def measurements(draw: st.DrawFn, num_states: int) -> Measurement:
    """Some states, or sums of them."""
    count = draw(st.integers(1, num_states))
    chosen = draw(st.permutations(range(num_states)))[:count]
    noise = draw(covariances(count))
    if draw(st.booleans()):
        return Measurement.of(chosen, num_states, noise)
    return Measurement(draw(arrays(count, num_states)), noise)


@st.composite
def vehicles(draw: st.DrawFn, name: str, dt: float, d: int) -> Vehicle:
    system = draw(systems(dt, d))
    n, m = system.num_states, system.num_controls
    has_velocity = system.velocity is not None
    limits = hnp.arrays(np.float64, d, elements=positive)
    at_rest = np.zeros(n)
    at_rest[list(system.position)] = draw(arrays(d))
    return Vehicle(
        name=name,
        system=system,
        start=draw(st.one_of(st.just(at_rest), arrays(n))),
        goal=draw(goals(d, has_velocity)),
        radius=draw(positive),
        control_limit=draw(hnp.arrays(np.float64, m, elements=positive)),
        initial_covariance=draw(covariances(n)),
        disturbance_covariance=draw(covariances(n)),
        speed_limit=draw(st.none() | limits) if has_velocity else None,
        gain=draw(st.none() | small(0.01, m, n)),
        control_sigmas=draw(st.just(3.0) | st.floats(0.0, 10.0)),
        cost_weight=draw(st.just(1.0) | st.floats(0.0, 10.0)),
        drift=draw(st.none() | drifts(system, dt)),
        disturbance_correlation=draw(correlations(dt)),
        measurement=draw(st.none() | measurements(n)),
    )


plain = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**12), 10**12) | finite | texts,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(texts, inner, max_size=3),
    max_leaves=5,
)


def concerning(obstacle: Obstacle, names: list[str]) -> st.SearchStrategy[Obstacle]:
    some = st.lists(st.sampled_from(names), min_size=1, unique=True)
    return st.one_of(
        st.just(obstacle),
        some.map(lambda chosen: only_for(obstacle, chosen)),
        some.map(lambda chosen: all_but(obstacle, chosen)),
    )


@st.composite
def scenarios(draw: st.DrawFn) -> Scenario:
    d = draw(st.sampled_from([2, 3]))
    dt, horizon = draw(st.floats(1e-3, 100.0)), draw(st.integers(1, 3))
    names = draw(st.lists(texts, min_size=1, max_size=3, unique=True))
    stones = draw(st.lists(texts, max_size=2, unique=True))
    # Half of the fleets are of one kind, which files write as defaults.
    kind = draw(st.none() | vehicles("", dt, d))
    faces = st.integers(3, 9) if d == 2 else st.sampled_from([6, 8, 14])
    corner = st.floats(60.0, 1e6)
    fleet = [
        draw(vehicles(name, dt, d)) if kind is None else replace(kind, name=name) for name in names
    ]
    return Scenario(
        name=draw(texts | st.just("")),
        dt=dt,
        horizon=horizon,
        risk_bound=draw(st.floats(1e-12, 0.4999)),
        vehicles=tuple(
            replace(
                draw(st.just(v) | arriving(v, horizon)),
                via=draw(visits(v, horizon)),
            )
            for v in fleet
        ),
        time_weight=draw(st.just(0.0) | st.floats(0.0, 1e6)),
        obstacles=tuple(
            draw(concerning(draw(obstacles(name, d, horizon)), names)) for name in stones
        ),
        avoidance=draw(st.sampled_from(["steps", "intervals"])),
        pair_faces=draw(st.none() | faces),
        workspace=draw(
            st.none() | corner.map(lambda size: Workspace(np.full(d, -size), np.full(d, size)))
        ),
        source=draw(st.none() | st.dictionaries(texts, plain, max_size=3)),
        keep=[Keep(names[:2], draw(positive))] if len(names) > 1 and draw(st.booleans()) else (),
    )


@st.composite
def trajectories(draw: st.DrawFn, vehicle: Vehicle, horizon: int) -> Trajectory:
    n, m = vehicle.system.num_states, vehicle.system.num_controls
    return Trajectory(
        name=vehicle.name,
        controls=draw(arrays(horizon, m)),
        means=draw(arrays(horizon + 1, n)),
        covariances=draw(arrays(horizon + 1, n, n)),
        gain=vehicle.gain,
    )


@st.composite
def ledger_rows(draw: st.DrawFn) -> LedgerRow:
    return LedgerRow(
        draw(st.sampled_from(["obstacle", "pair", "workspace", "range"])),
        draw(texts),
        draw(st.none() | texts),
        draw(st.integers(0, 1000)),
        draw(probabilities),
    )


@st.composite
def plans(draw: st.DrawFn) -> Plan:
    scenario = draw(scenarios())
    is_found = draw(st.booleans())
    rows = st.lists(ledger_rows(), max_size=3).map(tuple)
    return Plan(
        scenario=scenario,
        planner=draw(texts),
        seed=draw(st.none() | st.integers(0, 2**63)),
        status=draw(st.sampled_from(list(Status))),
        cost=draw(finite) if is_found else None,
        lower_bound=draw(st.none() | finite),
        risk=Risk(scenario.risk_bound, draw(st.none() | probabilities), draw(rows)),
        sets=tuple((vehicle.name,) for vehicle in scenario.vehicles),
        seconds=draw(st.dictionaries(texts, positive, max_size=2)),
        versions=draw(st.dictionaries(texts, texts, max_size=2)),
        explanation=draw(st.none() | texts),
        trajectories=tuple(
            draw(trajectories(vehicle, scenario.horizon))
            for vehicle in (scenario.vehicles if is_found else ())
        ),
    )
