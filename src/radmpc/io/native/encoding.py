"""From a `Scenario` to a scenario file's content."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Vector
from radmpc.errors import ScenarioError
from radmpc.io.native.moving import encode_track
from radmpc.io.native.noise import encode_correlation, encode_drift, encode_sensor
from radmpc.io.native.plain import plain_mapping
from radmpc.io.native.schema import SCENARIO_FORMAT
from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.model.obstacle import (
    BoxShape,
    HalfspaceShape,
    LineShape,
    Obstacle,
    PolygonShape,
    TrackShape,
)
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle

if TYPE_CHECKING:
    from radmpc.model.visits import Visit

__all__ = ["encode_scenario"]

# What a vehicle has alone; all else moves to the defaults where every vehicle agrees.
_OWN = ("name", "start", "goal", "via")


def encode_scenario(scenario: Scenario) -> dict[str, object]:
    """Return the content of a scenario file: dict, list, str, int, float, bool and None.

    Parameters
    ----------
    scenario : Scenario
        What to write.

    Returns
    -------
    dict
        `decode_scenario` returns an equal scenario, bit for bit. A regulator stands in it as the
        gain it led to.

    Raises
    ------
    ScenarioError
        If ``source`` is not plain.
    """
    content: dict[str, object] = {
        "format": SCENARIO_FORMAT,
        "name": scenario.name,
        "dt": float(scenario.dt),
        "horizon": int(scenario.horizon),
        "risk_bound": float(scenario.risk_bound),
        "avoidance": scenario.avoidance,
    }
    if scenario.pair_faces is not None:
        content["pair_faces"] = int(scenario.pair_faces)
    if scenario.workspace is not None:
        content["workspace"] = {
            "min": scenario.workspace.lower.tolist(),
            "max": scenario.workspace.upper.tolist(),
        }
    if scenario.obstacles:
        content["obstacles"] = [_obstacle(one) | _whom(one) for one in scenario.obstacles]
    vehicles = [_vehicle(v, scenario.dt) for v in scenario.vehicles]
    defaults = _common(vehicles)
    if defaults:
        content["defaults"] = defaults
        vehicles = [{k: e for k, e in v.items() if k not in defaults} for v in vehicles]
    content["vehicles"] = vehicles
    return content | _further(scenario)


def _further(scenario: Scenario) -> dict[str, object]:
    """Return what few scenarios have, in the order of a file."""
    content: dict[str, object] = {}
    if scenario.has_shared:
        from radmpc.io.native.shared import encode_shared  # noqa: PLC0415 - few share

        content["shared_disturbances"] = encode_shared(scenario.vehicles, scenario.dt)
    if scenario.covariance_samples is not None:
        content["covariance_samples"] = int(scenario.covariance_samples)
    if scenario.time_weight != 0.0:
        content["objective"] = {"effort": 1, "time": float(scenario.time_weight)}
    if scenario.goals:
        has_velocity = scenario.vehicles[0].system.velocity is not None
        goals = [_goal(goal, has_velocity) for goal in scenario.goals]
        content |= {"assign": True, "goals": goals}
    if scenario.keep:
        content["keep"] = [
            {"vehicles": list(one.vehicles), "within": float(one.within)} for one in scenario.keep
        ]
    if scenario.source is not None:
        content["source"] = plain_mapping(scenario.source, ("source",))
    return content


def _common(vehicles: Sequence[Mapping[str, object]]) -> dict[str, object]:
    """Return the fields in which several vehicles all agree."""
    first, *others = vehicles
    if not others:
        return {}
    # By text, because 0.0 == -0.0.
    return {
        key: entry
        for key, entry in first.items()
        if key not in _OWN and all(repr(entry) == repr(other.get(key)) for other in others)
    }


def _obstacle(obstacle: Obstacle) -> dict[str, object]:
    """Return an obstacle as it was described."""
    shape = obstacle.shape
    if isinstance(shape, PolygonShape):
        holes = {"holes": [hole.tolist() for hole in shape.holes]} if shape.holes else {}
        return {"name": obstacle.name, "vertices": shape.vertices.tolist(), **holes}
    if isinstance(shape, LineShape):
        return {"name": obstacle.name, "line": shape.points.tolist()}
    if isinstance(shape, BoxShape):
        return {"name": obstacle.name, "min": shape.lower.tolist(), "max": shape.upper.tolist()}
    if isinstance(shape, HalfspaceShape):
        return {
            "name": obstacle.name,
            "normals": shape.normals.tolist(),
            "offsets": shape.offsets.tolist(),
        }
    if isinstance(shape, TrackShape):
        track = encode_track(shape)
        for key in ("covariance", "disturbance_covariance"):
            matrix: Matrix = getattr(shape, key)
            if not _is_zero(matrix):
                track[key] = _covariance(matrix)
        return {"name": obstacle.name, "moving": track}
    return {"name": obstacle.name, "moving": [outline.tolist() for outline in shape.outlines]}


def _whom(obstacle: Obstacle) -> dict[str, object]:
    """Return which vehicles an obstacle concerns; nothing if all."""
    concerns = obstacle.concerns
    if concerns is None:
        return {}
    return {"except" if concerns.are_exempt else "for": list(concerns.names)}


def _vehicle(vehicle: Vehicle, dt: float) -> dict[str, object]:
    """Return a vehicle's fields, without those that are as when absent."""
    if vehicle.belief is not None:
        message = "what was learned under way is in no file: keep the scenario in the program"
        raise ScenarioError(message, ("vehicles", vehicle.name, "belief"))
    content: dict[str, object] = {
        "name": vehicle.name,
        "start": _start(vehicle),
        "goal": _goal(vehicle.goal, vehicle.system.velocity is not None),
        "radius": float(vehicle.radius),
        "control_limit": _limit(vehicle.control_limit, vehicle.control_norm),
    }
    if vehicle.speed_limit is not None:
        content["speed_limit"] = _limit(vehicle.speed_limit, vehicle.speed_norm)
    content["initial_covariance"] = _covariance(vehicle.initial_covariance)
    disturbance = _covariance(vehicle.disturbance_covariance)
    if vehicle.disturbance_correlation == 0.0:
        content["disturbance_covariance"] = disturbance
    else:
        correlation = encode_correlation(vehicle.disturbance_correlation, dt)
        content["disturbance"] = {"covariance": disturbance, **correlation}
    content["dynamics"] = _dynamics(vehicle.system)
    if vehicle.gain is not None:
        content["feedback"] = {"gain": vehicle.gain.tolist()}
    if vehicle.control_sigmas != 3.0:
        content["control_sigmas"] = float(vehicle.control_sigmas)
    if vehicle.cost_weight != 1.0:
        content["cost_weight"] = float(vehicle.cost_weight)
    if vehicle.drift is not None:
        content["drift"] = encode_drift(vehicle.drift, vehicle.system, dt)
    if vehicle.measurement is not None:
        noise = _covariance(vehicle.measurement.covariance)
        content["measurement"] = {**encode_sensor(vehicle.measurement), "covariance": noise}
    if vehicle.via:
        content["via"] = [_visit(visit) for visit in vehicle.via]
    return content


def _start(vehicle: Vehicle) -> list[float]:
    """Return the position where the rest is zero, else the full state."""
    system = vehicle.system
    rest = np.delete(vehicle.start, list(system.position))
    if system.num_states == system.dimension or not _is_zero(rest):
        return _floats(vehicle.start)
    return _floats(vehicle.start_position)


def _box(lower: Vector, upper: Vector) -> dict[str, object]:
    """Return a box by its center where that loses nothing, else by its corners."""
    # Rounded, so that a box written by its center comes back as that center.
    center = np.round(0.5 * (lower + upper), 12)
    half = np.round(0.5 * (upper - lower), 12)
    if _is_same(center - half, lower) and _is_same(center + half, upper):
        return {"center": _floats(center), "half_width": _short(half)}
    return {"min": _floats(lower), "max": _floats(upper)}


def _visit(visit: Visit) -> dict[str, object]:
    """Return a visit's fields, without those that are as when absent."""
    content = _box(visit.lower, visit.upper)
    if visit.between is not None:
        content["between"] = list(visit.between)
    if visit.speed is not None:
        content["speed"] = _short(visit.speed)
    return content


def _goal(goal: Goal, has_speed: bool) -> dict[str, object]:
    """Return a goal's box, and its speed where there is one."""
    content = _box(goal.lower, goal.upper)
    if has_speed:
        content["speed"] = None if goal.speed is None else _short(goal.speed)
    if goal.within is not None:
        content["within"] = list(goal.within)
    return content


def _dynamics(system: LinearSystem) -> dict[str, object]:
    """Return the model's name or the matrices."""
    if _is_named(system):
        return {"model": "double_integrator"}
    content: dict[str, object] = {
        "A": system.A.tolist(),
        "B": system.B.tolist(),
        "position": list(system.position),
    }
    if system.velocity is not None:
        content["velocity"] = list(system.velocity)
    return content


def _is_named(system: LinearSystem) -> bool:
    """Whether it is what a file's `double_integrator` stands for, bit for bit."""
    if system.rates is None:
        return False
    named = double_integrator(system.rates[1], system.dimension)
    return (
        np.array_equal(system.A, named.A)
        and np.array_equal(system.B, named.B)
        and (system.position, system.velocity) == (named.position, named.velocity)
    )


def _covariance(matrix: Matrix) -> float | list[float] | list[list[float]]:
    """Return zero, a diagonal or the matrix."""
    if _is_zero(matrix):
        return 0.0
    diagonal = np.diag(matrix)
    if _is_same(matrix, np.diag(diagonal)):
        return _floats(diagonal)
    rows: list[list[float]] = matrix.tolist()
    return rows


def _limit(axes: Vector, norm: float | None) -> object:
    """Return a limit per axis, or one of the norm with those per axis that are less."""
    if norm is None:
        return _short(axes)
    return {"norm": float(norm)} | ({"axes": _short(axes)} if np.any(axes != norm) else {})


def _short(vector: Vector) -> float | list[float]:
    """Return one number where all axes agree, else a list."""
    if _is_same(vector, np.full(vector.size, vector[0])):
        return float(vector[0])
    return _floats(vector)


def _floats(vector: Vector) -> list[float]:
    """Return a vector as a list."""
    return [float(entry) for entry in vector]


def _is_zero(array: npt.NDArray[np.float64]) -> bool:
    """Whether every entry is 0.0, and none is -0.0."""
    return _is_same(array, np.zeros(array.shape))


def _is_same(first: npt.NDArray[np.float64], second: npt.NDArray[np.float64]) -> bool:
    """Whether two arrays are equal bit for bit: -0.0 is not 0.0."""
    return first.shape == second.shape and bool(
        np.all((first == second) & (np.signbit(first) == np.signbit(second)))
    )
