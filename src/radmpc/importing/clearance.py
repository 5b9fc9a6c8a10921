"""Hulls and paths of published problems: what clearance obstacles leave for noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from radmpc.importing.free_space import FreePath, FreeSpace
from radmpc.importing.problem import ForeignProblem, ForeignVehicle
from radmpc.importing.waiting import waiting_times

__all__ = ["fit_hulls", "free_paths", "is_narrow"]

_TARGET_CLEARANCE = 0.8
"""Clearance that paths look for [radii]: four standard deviations of the usual noise."""

_LEAST_CLEARANCE = 0.05
"""Clearance below which a path counts as blocked [radii]."""

_HULL_SHARE = 0.8
"""Share of the widest radius that passes [-] to which hulls are reduced: the rest is for noise."""


def fit_hulls(
    problem: ForeignProblem,
    spaces: Sequence[FreeSpace],
    choices: dict[str, str],
    warnings: list[str],
) -> ForeignProblem:
    """Return the problem with hulls that leave clearance for noise where the published ones do not.

    Parameters
    ----------
    problem : ForeignProblem
        In the plane, with obstacles.
    spaces : sequence of FreeSpace
        What obstacles leave each vehicle.
    choices : dict
        What was chosen, by name; a changed radius is added.
    warnings : list of str
        Where the scenario differs from the problem; smaller hulls are added.

    Returns
    -------
    ForeignProblem
        The same if all hulls fit.
    """
    share = 1.0
    for v, space in zip(problem.vehicles, spaces, strict=True):
        path = space.shortest_path(v, _TARGET_CLEARANCE * v.radius)
        if path is None or path.clearance < _LEAST_CLEARANCE * v.radius:
            share = min(share, _HULL_SHARE * space.widest_radius(v) / v.radius)
    if share <= 0.0 or share >= 1.0:
        return problem
    radii = {v.radius: float(f"{share * v.radius:.2g}") for v in problem.vehicles}
    told = ", ".join(f"{old:g} m to {new:g} m" for old, new in radii.items())
    warnings.append(
        f"hulls were reduced from {told}: some passage is so narrow that the published ones leave "
        "no clearance for noise (a radius that is asked for is kept)"
    )
    choices["radius"] = (
        f"reduced from {told}, so that the narrowest passage has clearance for noise"
    )
    vehicles = tuple(replace(v, radius=radii[v.radius]) for v in problem.vehicles)
    return replace(problem, vehicles=vehicles)


def free_paths(
    problem: ForeignProblem, spaces: Sequence[FreeSpace] | None, warnings: list[str]
) -> list[FreePath]:
    """Return the vehicles' paths around obstacles; straight lines where none is found.

    Parameters
    ----------
    problem : ForeignProblem
        Its hulls fitted.
    spaces : sequence of FreeSpace or None
        What obstacles leave each vehicle; None leaves all paths straight.
    warnings : list of str
        Where the scenario differs from the problem; vehicles without a path are added.

    Returns
    -------
    list of FreePath
        One per vehicle, waiting included.
    """
    if spaces is None:
        return [FreePath(0.0, _TARGET_CLEARANCE * v.radius) for v in problem.vehicles]
    paths = [_path(v, s, warnings) for v, s in zip(problem.vehicles, spaces, strict=True)]
    waits = waiting_times(spaces, problem.vehicles, [path.clearance for path in paths])
    return [replace(path, waiting=wait) for path, wait in zip(paths, waits, strict=True)]


def _path(vehicle: ForeignVehicle, space: FreeSpace, warnings: list[str]) -> FreePath:
    """Return a vehicle's path, the straight line with a warning where it finds none."""
    target = _TARGET_CLEARANCE * vehicle.radius
    path = _route(vehicle, space, target)
    if path is None or path.clearance < _LEAST_CLEARANCE * vehicle.radius:
        widest = space.widest_radius(vehicle)
        hint = f", of {_HULL_SHARE * widest:.2g} m it might" if widest > 0.0 else ""
        warnings.append(
            f"between start and goal of {vehicle.name!r} a hull of {vehicle.radius:g} m finds no "
            f"path with clearance for noise{hint}"
        )
        return FreePath(0.0 if path is None else path.detour, target)
    return path


def _route(vehicle: ForeignVehicle, space: FreeSpace, target: float) -> FreePath | None:
    """Return the path by way of all places that are visited, None if a leg has none."""
    legs = [space.shortest_path(leg, target) for leg in vehicle.legs()]
    found = [leg for leg in legs if leg is not None]
    if len(found) < len(legs):
        return None
    return FreePath(sum(leg.detour for leg in found), min(leg.clearance for leg in found))


def is_narrow(path: FreePath, vehicle: ForeignVehicle) -> bool:
    """Whether a path keeps less clearance than noise of the usual size needs.

    Parameters
    ----------
    path : FreePath
        The vehicle's.
    vehicle : ForeignVehicle
        Whose radius counts.

    Returns
    -------
    bool
        True below 99 % of it.
    """
    return path.clearance < 0.99 * _TARGET_CLEARANCE * vehicle.radius
