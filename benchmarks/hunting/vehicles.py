"""Random vehicles: dynamics, feedback, noise and limits from harmless to hardly possible."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.dynamics import LinearSystem, covariances, double_integrator, lqr_gain
from radmpc.model.vehicle import Goal, Vehicle

__all__ = ["random_vehicle"]


def random_vehicle(
    rng: np.random.Generator,
    name: str,
    way: tuple[Vector, Vector],
    radius: float,
    times: tuple[float, int],
    *,
    is_close: bool,
) -> Vehicle:
    """Return a vehicle.

    Parameters
    ----------
    rng : Generator
        Decides everything else.
    name : str
        For the vehicle.
    way : pair of (d,) array
        Where it starts and where it should be [m].
    radius : float
        Of its hull [m].
    times : pair of float and int
        Step [s], and number of steps.
    is_close : bool
        Whether it starts so near to something that noise at the start leaves no plan.

    Returns
    -------
    Vehicle
        That can mostly reach its goal if it were alone.
    """
    start, goal = way
    (dt, horizon), d = times, start.size
    kind, system = _system(rng, dt, d)
    state = np.zeros(system.num_states)
    state[list(system.position)] = start
    has_speed = system.velocity is not None
    if has_speed and rng.random() < 0.15:
        state[list(system.velocity or ())] = rng.uniform(-0.5, 0.5, d)
    length = float(np.abs(goal - start).max())
    half = float(rng.choice([0.0, 0.02, 0.2]))
    is_free = not has_speed or horizon == 1 or rng.random() < 0.4
    gain = _gain(rng, kind, system, dt)
    initial = _covariance(rng, system, 0.92 if is_close else 0.55)
    disturbance = _covariance(rng, system, 0.1)
    sigmas = float(rng.choice([0.0, 1.0, 3.0]))
    limit = np.full(d, _control_limit(rng, kind, (start, goal), times))
    if gain is not None and rng.random() < 0.9:
        # What the feedback keeps in reserve would mostly leave nothing.
        spread = covariances(system, initial, disturbance, gain, horizon)
        variances = np.einsum("an,knm,am->ka", gain, spread, gain).max(axis=0)
        limit = limit + sigmas * np.sqrt(variances.clip(min=0.0))
    fastest = rng.choice([1.5, 2.1, 5.0]) * length / (dt * horizon) + 0.1
    return Vehicle(
        name=name,
        system=system,
        start=state,
        goal=Goal(
            goal - half, goal + half, None if is_free else np.full(d, rng.choice([0.0, 0.1]))
        ),
        radius=radius,
        control_limit=limit,
        initial_covariance=initial,
        disturbance_covariance=disturbance,
        speed_limit=np.full(d, fastest) if has_speed and rng.random() < 0.25 else None,
        gain=gain,
        control_sigmas=sigmas,
        cost_weight=float(rng.choice([1.0, 1.0, 1.0, 1.0, 0.3, 0.0])),
    )


def _system(rng: np.random.Generator, dt: float, d: int) -> tuple[str, LinearSystem]:
    """Return dynamics and their kind."""
    kind = str(rng.choice(["double", "shuffled", "single", "drag", "skewed"],
                          p=[0.5, 0.15, 0.15, 0.1, 0.1]))  # fmt: skip
    double = double_integrator(dt, d)
    eye = np.eye(d)
    if kind == "double":
        return kind, double
    if kind == "shuffled":
        order = rng.permutation(2 * d)
        place = np.argsort(order)
        return kind, LinearSystem(
            double.A[np.ix_(order, order)],
            double.B[order],
            tuple(int(i) for i in place[:d]),
            tuple(int(i) for i in place[d:]),
        )
    if kind == "single":
        return kind, LinearSystem(eye, dt * eye, tuple(range(d)), None)
    if kind == "drag":
        A = np.array(double.A)
        A[d:, d:] *= rng.uniform(0.3, 0.95)
        return kind, LinearSystem(A, double.B, tuple(range(d)), tuple(range(d, 2 * d)))
    # Stable, no axis apart from the others.
    mixing = rng.normal(size=(d, d))
    A = eye - rng.uniform(0.0, 0.3) * mixing @ mixing.T / float(np.linalg.norm(mixing, 2)) ** 2
    B = dt * (eye + 0.3 * rng.normal(size=(d, d)))
    return kind, LinearSystem(A, B, tuple(range(d)), None)


def _gain(rng: np.random.Generator, kind: str, system: LinearSystem, dt: float) -> Matrix | None:
    """Return no feedback, a soft one, one that cancels a deviation in a step or two, or LQR."""
    choice = str(
        rng.choice(["none", "soft", "dead-beat", "lqr", "any"], p=[0.4, 0.2, 0.15, 0.2, 0.05])
    )
    n, m = system.num_states, system.num_controls
    if choice == "none":
        return None
    if choice == "any":
        return np.asarray(rng.normal(0.0, 0.2, (m, n)))
    gain = np.zeros((m, n))
    if choice == "lqr" or kind in {"drag", "skewed"}:
        weight = 10.0 ** rng.uniform(-2.0, 1.0)
        return lqr_gain(system, np.eye(n), weight * np.eye(m))
    share = 1.0 if choice == "dead-beat" else float(rng.uniform(0.05, 0.6))
    place = list(system.position)
    if kind == "single":
        gain[:, place] = -share / dt * np.eye(m)
        return gain
    gain[:, place] = -share / dt**2 * np.eye(m)
    if system.velocity is not None:
        gain[:, list(system.velocity)] = -1.5 * share**0.5 / dt * np.eye(m)
    return gain


def _covariance(rng: np.random.Generator, system: LinearSystem, zero: float) -> Matrix:
    """Return noise of any shape, none with a given chance; deviations from 0.1 mm to 0.2 m."""
    n = system.num_states
    kind = str(rng.choice(["round", "axes", "one-axis", "line", "full", "slow"]))
    if rng.random() < zero:
        return np.zeros((n, n))
    deviation = float(np.exp(rng.uniform(np.log(1e-4), np.log(0.2))))
    scales = np.full(n, 0.4 * deviation)
    scales[list(system.position)] = deviation
    if kind == "round":
        return np.diag(scales**2)
    if kind == "axes":
        # From as good as nothing to the full deviation, axis by axis.
        return np.diag((scales * 10.0 ** rng.uniform(-6.0, 0.0, n)) ** 2)
    if kind == "one-axis":
        return np.diag((scales * (np.arange(n) == rng.integers(n))) ** 2)
    if kind == "slow":
        scales[list(system.position)] = 0.0
        return np.diag(scales**2)
    mixing = rng.normal(size=(n, 1 if kind == "line" else n)) / np.sqrt(n)
    return np.asarray(scales[:, None] * (mixing @ mixing.T) * scales)


def _control_limit(
    rng: np.random.Generator,
    kind: str,
    way: tuple[Vector, Vector],
    times: tuple[float, int],
) -> float:
    """Return a limit per axis: plenty, or little more than the way asks for."""
    (start, goal), (dt, horizon) = way, times
    if rng.random() < 0.4:
        return float(rng.choice([3.0, 10.0]))
    length, duration = float(np.abs(goal - start).max()), dt * horizon
    needed = 4.0 * length / duration**2 * (horizon**2 / (horizon**2 - 1) if horizon > 1 else 1.0)
    if kind == "single":
        needed = length / duration
    elif kind == "drag":
        needed *= 3.0
    elif kind == "skewed":
        # It has to be held where it is, too.
        needed = 2.0 * length / duration + 0.5 * float(np.abs([start, goal]).max()) / dt
    return float(needed * rng.choice([1.02, 1.3, 3.0]) + 0.05)
