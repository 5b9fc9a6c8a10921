"""Signs that the model is wrong, and the guarantee with it: reported, never acted upon."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import fdtri, gammaincinv

from radmpc.arrays import Matrix, Vector
from radmpc.gaussian import Tail
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass, field
from radmpc.referee.conditional.scales import Scale, squares_of

__all__ = ["Watcher"]

_FAR = 5.0
"""Deviations from which a single disturbance is an alarm [-]: 6e-7 of all components."""

_RECENT = 5
"""Steps whose disturbances are summed [-]."""

_LIKELY = 0.999
"""Quantile of the sum of their squares beyond which they are an alarm [-]."""

_ALONG_NOTHING = 1e-6
"""What a state may move by along directions without noise, relative to its size and at least to 1:
rounding, and the tolerance of solvers [-]."""


@dataclass(slots=True, eq=False)
class Watcher:
    """Compares what is measured with what was expected.

    Attributes
    ----------
    scenario : Scenario
        Of the mission, for names and noise.
    squares : list of (float, int, Scale)
        Of the steps so far: the sum of squared deviations as stated, of how many components, and
        what was known of the factor of covariances before.
    axes : dict
        Variances of noise and the directions they belong to, by vehicle, and whether at step 0.
    """

    scenario: Scenario
    squares: list[tuple[float, int, Scale]] = field(default_factory=list)
    axes: dict[tuple[str, bool], tuple[Vector, Matrix]] = field(default_factory=dict)

    def look(
        self,
        step: int,
        expected: Sequence[Vector],
        measured: Sequence[Vector],
        corrections: Sequence[Matrix | None],
        scale: Scale,
        together: tuple[Matrix, Vector] | None = None,
    ) -> list[str]:
        """Return the alarms of a measurement, one sentence each.

        Parameters
        ----------
        step : int
            Of the mission; at 0 the initial covariance counts.
        expected, measured : sequence of (n,) array
            States of all vehicles, or estimates; more of what was expected is not looked at.
        corrections : sequence of (n, n) array or None
            Covariance by which each was to move; None is that of the noise of a step.
        scale : Scale
            What was known before of the factor of covariances.
        together : tuple of (p, p) and (p,) array, or None
            Deviation from what was expected of all vehicles that are estimated together, its
            covariance first: what moves all of them counts once. None is of none.
        """
        alarms = []
        larger, far = float(np.sqrt(scale.factor)), Tail(scale.samples).beyond(_FAR)
        total, components = 0.0, 0
        vehicles = self.scenario.vehicles
        for vehicle, longer, found, noise in zip(
            vehicles, expected, measured, corrections, strict=True
        ):
            hoped = longer[: found.size]
            axes = _directions(noise) if noise is not None else self._axes(vehicle, step)
            scores, rest = _scores(axes, found - hoped)
            if together is None or not vehicle.shared:
                total, components = total + float(scores @ scores), components + scores.size
            largest = float(np.abs(scores).max(initial=0.0)) / larger
            if largest > far:
                alarms.append(
                    f"vehicle {vehicle.name!r}: a disturbance of {largest:.1f} deviations"
                )
            if rest > _ALONG_NOTHING * max(1.0, float(np.abs(hoped).max())):
                alarms.append(
                    f"vehicle {vehicle.name!r}: moved by {rest:.3g} where the model has no noise"
                )
        if together is not None:
            squares, directions = squares_of(together[0], together[1][None])
            total, components = total + float(squares[0]), components + directions
        self.squares.append((total, components, scale))
        return alarms + self._unlikely()

    def _axes(self, vehicle: Vehicle, step: int) -> tuple[Vector, Matrix]:
        """Return the variances by which a state differs from what was expected, and directions."""
        key = vehicle.name, step == 0
        if key not in self.axes:
            self.axes[key] = _directions(_noise(vehicle, step))
        return self.axes[key]

    def _unlikely(self) -> list[str]:
        """Return an alarm if recent disturbances are too large together."""
        recent = self.squares[-_RECENT:]
        total, components = sum(s for s, _, _ in recent), sum(n for _, n, _ in recent)
        samples, factor = recent[0][2].samples, recent[0][2].factor
        if components and samples is not None:
            # Of two sums of squares, this one's and that of all that was known before.
            ratio = total / components / float(factor)
            if ratio <= float(fdtri(components, samples, _LIKELY)):
                return []
            return [
                f"the last {len(recent)} disturbances have an F of {ratio:.2f} with {components} "
                f"and {samples} degrees of freedom, beyond {_LIKELY}"
            ]
        if not components or total <= 2.0 * float(gammaincinv(0.5 * components, _LIKELY)):
            return []
        return [
            f"the last {len(recent)} disturbances have a χ² of {total:.1f} with {components} "
            f"degrees of freedom, beyond {_LIKELY}"
        ]


def _noise(vehicle: Vehicle, step: int) -> Matrix:
    """Return the covariance by which a state differs from what was expected."""
    if not step:
        return vehicle.initial_covariance
    noise = vehicle.disturbance_covariance
    for part in vehicle.shared:
        noise = noise + part.matrix @ part.covariance @ part.matrix.T
    return noise


def _directions(covariance: Matrix) -> tuple[Vector, Matrix]:
    """Return variances, rising, and the directions they belong to."""
    values, vectors = np.linalg.eigh(covariance)
    return values, vectors


def _scores(axes: tuple[Vector, Matrix], deviation: Vector) -> tuple[Vector, float]:
    """Return independent components in deviations, and what lies where there is no noise."""
    values, vectors = axes
    along = vectors.T @ deviation
    noisy = values > 1e-12 * max(float(values[-1]), 1e-300)
    rest = float(np.linalg.norm(along[~noisy]))
    return along[noisy] / np.sqrt(values[noisy]), rest
