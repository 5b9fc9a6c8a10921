"""Where a vehicle, or one relative to another, is at the instants at which collisions count."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.model.noise.positions import side_by_side, without_common
from radmpc.model.noise.response import response_of
from radmpc.model.obstacle_track import TrackSpread
from radmpc.model.vehicle import Vehicle
from radmpc.program.avoidance import Part
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass, replace

__all__ = ["Instants"]


@dataclass(frozen=True, slots=True, eq=False)
class Instants:
    """A (relative) position at I instants: a share s of the way through a window each.

    Attributes
    ----------
    windows : (I,) int array
        Step at which each instant's interval begins.
    shares : (I,) array
        How far through it the instant is, in (0, 1] [-].
    covariances : (I, d, d) array
        Of the (relative) position [m²].
    lower, upper : (I, d) array
        Box that holds its mean under every admissible control [m].
    parts : tuple of Part
        One vehicle, or two with signs +1 and −1.
    columns : mapping of str to slice, or None
        Of the sources of shared disturbances in what follows; None is none.
    common : (I, d, E) array or None
        What the normals behind them make of the position [m].
    """

    windows: Indices
    shares: Vector
    covariances: Tensor
    lower: Matrix
    upper: Matrix
    parts: tuple[Part, ...]
    columns: Mapping[str, slice] | None = None
    common: Tensor | None = None

    @property
    def count(self) -> int:
        """Number of instants I."""
        return int(self.windows.size)

    @classmethod
    def of(cls, model: CondensedModel, part: Part, shares: Sequence[float]) -> Instants:
        """Return the instants of one vehicle: the same shares of every interval.

        Parameters
        ----------
        model : CondensedModel
            The vehicle.
        part : Part
            Its place among the outputs.
        shares : sequence of float
            Shares of an interval, in (0, 1] [-].
        """
        windows = np.repeat(np.arange(model.horizon), len(shares))
        share = np.tile(np.asarray(shares, dtype=np.float64), model.horizon)
        depth = 4.0 * share * (1.0 - share)
        hang = np.maximum(model.control_bounds, 0.0) @ np.abs(part.sagitta).T
        spread = depth[:, None] * hang[windows]
        s = share[:, None]
        lower, upper = (
            (1.0 - s) * reach[windows] + s * reach[windows + 1]
            for reach in (model.reach_lower, model.reach_upper)
        )
        return cls(
            windows,
            share,
            _covariances(model, windows, share),
            lower - spread,
            upper + spread,
            (part,),
            *_common(model, windows, share),
        )

    def sizes(self) -> Vector:
        """Return the size of the noise, (I,) [m]."""
        variances = self.covariances[:, 0, 0] + self.covariances[:, 1, 1]
        for axis in range(2, self.covariances.shape[1]):
            variances = variances + self.covariances[:, axis, axis]
        return np.asarray(np.sqrt(np.maximum(variances, 0.0)))

    def near(self, lower: Matrix, upper: Matrix, distance: Vector) -> npt.NDArray[np.bool_]:
        """Tell at which instants the body may come near boxes.

        Parameters
        ----------
        lower, upper : (..., I or 1, d) array
            The boxes [m].
        distance : (I,) array
            What counts as near [m].

        Returns
        -------
        (..., I) bool array
            Whatever the controls.
        """
        apart = np.maximum(lower - self.upper, self.lower - upper)
        return np.asarray((apart <= distance[:, None]).all(axis=-1))

    def take(self, chosen: Indices) -> Instants:
        """Return some of the instants, by their numbers."""
        return Instants(
            self.windows[chosen],
            self.shares[chosen],
            self.covariances[chosen],
            self.lower[chosen],
            self.upper[chosen],
            self.parts,
            self.columns,
            None if self.common is None else self.common[chosen],
        )

    def seen_from(self, spread: TrackSpread | None) -> Instants:
        """Return the position relative to the true place of something that spreads.

        Parameters
        ----------
        spread : TrackSpread or None
            How far that is from its mean; None is not at all.
        """
        if spread is None:
            return self
        more = spread.between(self.windows, self.shares)
        return replace(self, covariances=self.covariances + more)

    def relative_to(self, other: Instants) -> Instants:
        """Return the position of this vehicle relative to another, at the same instants."""
        away = tuple(replace(part, sign=-part.sign) for part in other.parts)
        total = self.covariances + other.covariances
        common = side_by_side([self.columns, other.columns], [self.common, other.common])
        return Instants(
            self.windows,
            self.shares,
            without_common(total, *common),
            self.lower - other.upper,
            self.upper - other.lower,
            self.parts + away,
        )


def _covariances(model: CondensedModel, windows: Indices, shares: Vector) -> Tensor:
    """Return position covariances between steps, (I, d, d).

    With P that picks positions, ``F = A + B K`` and ``G = P B K`` the deviation is
    ``((1 − s) P − s (1 − s) G + s P F) δ_k + s P w``; G only where the path is a parabola. Who
    measures has ``B K`` and G act on the estimate of δ_k.
    """
    if np.all(shares == 1.0):
        return model.position_covariances[windows + 1]
    vehicle = model.vehicle
    if vehicle.has_memory:
        return vehicle.spread(model.horizon).of_sums(windows, *_between(vehicle, shares))
    picked, loop, bend = _acts(vehicle)
    s = shares[:, None, None]
    moved = (1.0 - s) * picked - s * (1.0 - s) * bend + s * (picked @ loop)
    states = vehicle.covariances(model.horizon)[windows]
    fresh = picked @ vehicle.disturbance_covariance @ picked.T
    return np.asarray(moved @ states @ moved.transpose(0, 2, 1) + s**2 * fresh)


def _common(
    model: CondensedModel, windows: Indices, shares: Vector
) -> tuple[Mapping[str, slice] | None, Tensor | None]:
    """Return what shared disturbances make of positions between steps, (I, d, E)."""
    if not model.vehicle.shared:
        return None, None
    vehicle = model.vehicle
    response = response_of(vehicle.system, vehicle.noise, vehicle.gain, model.horizon)
    return response.columns, response.of_sums(windows, *_between(vehicle, shares))


def _between(vehicle: Vehicle, shares: Vector) -> tuple[Tensor, Tensor, Tensor]:
    """Return what states, their estimates and disturbances do to positions between steps."""
    picked, loop, bend = _acts(vehicle)
    s = shares[:, None, None]
    # What happens freely happens to the state itself, what feedback does to its estimate.
    free = (1.0 - s) * picked + s * (picked @ vehicle.system.A)
    pushed = s * (picked @ (loop - vehicle.system.A)) - s * (1.0 - s) * bend
    return free, pushed, s * picked


def _acts(vehicle: Vehicle) -> tuple[Matrix, Matrix, Matrix]:
    """Return P, F and G."""
    system = vehicle.system
    picked = np.eye(system.num_states)[list(system.position)]
    loop, bend = system.A, np.zeros_like(picked)
    if vehicle.gain is not None:
        loop = system.A + system.B @ vehicle.gain
        if system.is_double_integrator:
            bend = picked @ system.B @ vehicle.gain
    return picked, loop, bend
