"""Temporal obstacles: where a vehicle's plan will have it, step by step (paper, same section)."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.geometry import hull
from radmpc.model.vehicle import Vehicle
from radmpc.program.keepout import KeepOut
from radmpc.records import dataclass, replace

__all__ = ["TemporalObstacle", "make_temporal_obstacle", "standing_obstacle"]


@dataclass(frozen=True, slots=True, eq=False)
class TemporalObstacle:
    """One convex set per absolute step, not yet grown by the vehicle that avoids it.

    Attributes
    ----------
    name : str
        The vehicle it stands for.
    first_step : int
        Absolute step of the first entry.
    normals : (s, f, d) array
        Outward unit normals.
    offsets : (s, f) array
        Offsets [m]; inf marks a face that is not there.
    directions : (s, f) int array
        Equal numbers are equal normals.
    """

    name: str
    first_step: int
    normals: Tensor
    offsets: Matrix
    directions: Indices

    def at(self, step: int) -> tuple[Matrix, Vector]:
        """Return normals and offsets at an absolute step; they cover the motion to the next one."""
        i = step - self.first_step
        real = np.isfinite(self.offsets[i])
        return self.normals[i, real], self.offsets[i, real]

    def keepout(self, windows: range) -> KeepOut:
        """Return the faces at consecutive absolute steps."""
        chosen = slice(windows.start - self.first_step, windows.stop - self.first_step)
        offsets = self.offsets[chosen]
        return KeepOut(self.name, self.normals[chosen], offsets, offsets, self.directions[chosen])


def make_temporal_obstacle(
    vehicle: Vehicle,
    means: Matrix,
    covariances: Tensor,
    first_step: int,
    *,
    intervals: bool = False,
    controls: Matrix | None = None,
    sigmas: float = 3.0,
) -> TemporalObstacle:
    """Bound a plan's 3σ regions (paper, section Temporal Obstacles).

    Parameters
    ----------
    vehicle : Vehicle
        Whose plan.
    means : (s+1, n) array
        Mean states from ``first_step`` to the horizon.
    covariances : (s+1, n, n) array
        State covariances at these steps.
    first_step : int
        Absolute step of the first entry.
    intervals : bool
        Whether the motion between steps counts: then neither k = 0 nor a goal is an exception.
    controls : (s, m) array or None
        Controls held from step to step, where the motion between steps counts; None leaves the
        square on the chord.
    sigmas : float
        Standard deviations that the squares bound.

    Returns
    -------
    TemporalObstacle
        The hull of the squares at k and k+1, its faces moved out to hold the square's way along
        the curve; a square alone at the horizon and, where only steps count, at k = 0 and where
        the vehicle is in its goal and stays there.
    """
    system = vehicle.system
    positions = means[:, list(system.position)]
    halves = _half_sides(vehicle, covariances, sigmas)
    speeds = None if system.velocity is None else means[:, list(system.velocity)]
    arrived = np.array(
        [
            vehicle.goal.contains(position, None if speeds is None else speeds[i])
            for i, position in enumerate(positions)
        ]
    )
    alone = np.append(arrived[:-1] & arrived[1:] & (not intervals), True)
    alone[0] |= first_step == 0 and not intervals
    following = np.where(alone, np.arange(len(positions)), np.arange(len(positions)) + 1)
    found = _hulls(vehicle.name, first_step, (positions, halves), following)
    if controls is None or not intervals:
        return found
    return _around_curves(found, (positions, halves), following, controls @ system.sagitta.T)


def standing_obstacle(
    vehicle: Vehicle, covariances: Tensor, *, intervals: bool = False, sigmas: float = 3.0
) -> TemporalObstacle:
    """Return the square around a vehicle that has no plan yet: at its start, for all steps.

    Under intervals, the hull with the square that it drifts to within the first step.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    covariances : (T+1, n, n) array
        Covariances of its state; the first counts.
    intervals : bool
        Whether the motion between steps counts.
    sigmas : float
        Half-side of the square beside the radius [standard deviations].
    """
    count = len(covariances)
    half = _half_sides(vehicle, covariances[:1], sigmas)[0]
    state = vehicle.system.A @ vehicle.start
    pushes = vehicle.pushes(1)
    drifted = state if pushes is None else state + np.atleast_2d(pushes)[0]
    ends = [
        vehicle.start_position,
        drifted[list(vehicle.system.position)] if intervals else vehicle.start_position,
    ]
    squares = (np.tile(np.array(ends), (count, 1)), np.full(2 * count, half))
    both = _hulls(vehicle.name, 0, squares, np.arange(2 * count) // 2 * 2 + 1)
    every = slice(0, None, 2)
    return TemporalObstacle(
        vehicle.name, 0, both.normals[every], both.offsets[every], both.directions[every]
    )


def _half_sides(vehicle: Vehicle, covariances: Tensor, sigmas: float) -> Vector:
    """Return ``sigmas √λmax(Σ_position) + radius`` of each step [m]."""
    axes = list(vehicle.system.position)
    largest = np.linalg.eigvalsh(covariances[:, axes, :][:, :, axes])[:, -1]
    return np.asarray(sigmas * np.sqrt(np.maximum(largest, 0.0)) + vehicle.radius)


def _hulls(
    name: str, first_step: int, squares: tuple[Matrix, Vector], following: Indices
) -> TemporalObstacle:
    """Return the hull of each square and the one that follows it."""
    positions, halves = squares
    after, after_halves = positions[following], halves[following]
    num_steps, d = positions.shape
    identity = np.eye(d)
    axes = np.broadcast_to(np.concatenate([identity, -identity]), (num_steps, 2 * d, d))
    extent = np.concatenate(
        [
            np.maximum(positions + halves[:, None], after + after_halves[:, None]),
            np.maximum(halves[:, None] - positions, after_halves[:, None] - after),
        ],
        axis=1,
    )
    corners = _signs(d)
    near = positions[:, None, :] + halves[:, None, None] * corners
    far = after[:, None, :] + after_halves[:, None, None] * corners
    bridges, offsets = _bridges(near, far) if d == 2 else _bridges_in_space(near, far)
    unique = 2 * d + np.arange(offsets.size).reshape(offsets.shape)
    shared = np.tile(np.arange(2 * d), (num_steps, 1))
    return TemporalObstacle(
        name,
        first_step,
        np.concatenate([axes, bridges], axis=1),
        np.concatenate([extent, offsets], axis=1),
        np.concatenate([shared, unique], axis=1),
    )


def _around_curves(
    chords: TemporalObstacle, squares: tuple[Matrix, Vector], following: Indices, sagittas: Matrix
) -> TemporalObstacle:
    """Return temporal obstacles that hold the squares' paths along parabolas, (s, d) below chords.

    A square's support along a face is at a share s of the step ``(1 − s) a + s b + 4 s (1 − s) c``
    with c how far the curve leaves the chord outwards: largest at an end, or in between at
    ``s = ½ + (b − a) / 8c``.
    """
    positions, halves = squares
    normals = chords.normals
    widths = np.abs(normals).sum(axis=2)
    near = np.einsum("sfa,sa->sf", normals, positions) + halves[:, None] * widths
    far = np.einsum("sfa,sa->sf", normals, positions[following])
    far += halves[following][:, None] * widths
    outward = np.zeros_like(near)
    outward[:-1] = -np.einsum("sfa,sa->sf", normals[:-1], sagittas)
    is_out = outward > 0.0
    sagitta = np.where(is_out, outward, 1.0)
    share = np.clip(0.5 + (far - near) / (8.0 * sagitta), 0.0, 1.0)
    curve = (1.0 - share) * near + share * far + 4.0 * share * (1.0 - share) * sagitta
    offsets = np.where(is_out, np.maximum(chords.offsets, curve), chords.offsets)
    return replace(chords, offsets=offsets)


def _bridges(near: Tensor, far: Tensor) -> tuple[Tensor, Matrix]:
    """Return the oblique faces of each hull: those through corresponding corners.

    The hull of two homothetic polygons has no others than these and the polygons' own.
    """
    along = far - near
    length = np.linalg.norm(along, axis=2)
    moving = length > 1e-12
    normals = np.stack([along[..., 1], -along[..., 0]], axis=2)
    normals /= np.where(moving, length, 1.0)[..., None]
    center = near.mean(axis=1, keepdims=True)
    outward = np.sign(np.einsum("sfa,sfa->sf", normals, near - center))
    normals *= outward[..., None]
    offsets = np.einsum("sfa,sfa->sf", normals, near)
    both = np.concatenate([near, far], axis=1)
    beyond = np.einsum("sfa,spa->sfp", normals, both).max(axis=2)
    oblique = np.abs(normals).min(axis=2) > 1e-9
    real = moving & oblique & (outward != 0.0) & (beyond <= offsets + 1e-9)
    return normals, np.where(real, offsets, np.inf)


def _bridges_in_space(near: Tensor, far: Tensor) -> tuple[Tensor, Matrix]:
    """Return the oblique faces of each hull of two cubes, filled up to equal numbers."""
    found = []
    for one, two in zip(near, far, strict=True):
        solid = hull(np.concatenate([one, two]))
        oblique = np.sort(np.abs(solid.normals), axis=1)[:, -2] > 1e-9
        found.append((solid.normals[oblique], solid.offsets[oblique]))
    most = max(len(offsets) for _, offsets in found)
    normals = np.zeros((len(found), most, near.shape[2]))
    padded = np.full((len(found), most), np.inf)
    for i, (faces, offsets) in enumerate(found):
        normals[i, : len(offsets)] = faces
        padded[i, : len(offsets)] = offsets
    return normals, padded


def _signs(dimension: int) -> Matrix:
    """Return the corners of the cube [−1, 1]^d."""
    axes = np.meshgrid(*[[-1.0, 1.0]] * dimension)
    return np.asarray(np.array(axes).reshape(dimension, -1).T)
