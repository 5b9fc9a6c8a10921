"""Disturbance with or without memory beside measurement noise, by Whittle's likelihood."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.special import chdtri, ndtri

from radmpc.arrays import Matrix, Vector
from radmpc.identification.intervals import LEVEL, Interval, normal_interval
from radmpc.identification.model import StepModel
from radmpc.identification.sharing import nearest_covariance
from radmpc.identification.spectral.spectra import Source, spectra
from radmpc.identification.spectral.whittle import Whittle
from radmpc.records import dataclass

__all__ = ["Mixed", "Mixture"]

_SHORTEST, _LONGEST = 0.3, 200.0
"""Time constants [steps] that are looked for: correlations of 0.04 and 0.995 after a step."""

_GRID = 9
"""Time constants that are tried before the best is refined."""

_CHANCE = 0.5 - 0.5 * LEVEL
"""Chance [-] that any variance of measurement noise that is not there gets a lower end above zero;
by each one's own interval alone, this happened in a fifth of simulated logs."""

_CLOSE = 0.02
"""Relative change [-] of a time constant that ends the search for it."""


@dataclass(frozen=True, slots=True, eq=False)
class Mixed:
    """Covariances that are the likeliest with one autocorrelation.

    Attributes
    ----------
    color : float
        Autocorrelation of the disturbance from step to step [-].
    likelihood : Whittle
        Of covariances.
    entries : (m,) array
        The likeliest.
    value, peak : float
        Their log-likelihood, and the largest as if covariances might be indefinite.
    """

    color: float
    likelihood: Whittle
    entries: Vector
    value: float
    peak: float

    @property
    def loss(self) -> float:
        """By how much the taper makes variances of estimates larger [-]."""
        return self.likelihood.seen.loss


class Mixture:
    """What residuals, and differences of two sensors beside them, may be made of.

    Parameters
    ----------
    pieces : sequence of (k, n) or (k, n + d) array
        Residuals, and behind them the first sensor less the second, runs without a gap.
    model : StepModel
        Dynamics.
    repeated : float
        How many times vehicles tell the same [-].
    """

    def __init__(self, pieces: Sequence[Matrix], model: StepModel, repeated: float = 1.0) -> None:
        n, d = model.num_states, model.dimension
        scale = np.concatenate(pieces).std(axis=0)
        scale = np.maximum(scale, 1e-9 * max(float(scale.max()), 1e-150))
        self._pieces = [piece / scale for piece in pieces]
        self._scales, self._scale, self._size = scale, scale[:n], n
        more = len(scale) - n
        relative = model.A * scale[:n] / scale[:n, None]
        eye, units, nothing = np.eye(n), _units(n), np.zeros((n + more, n))
        before, after, begun = nothing.copy(), nothing.copy(), nothing.copy()
        begun[:n], after[:n], before[:n] = eye, eye, -relative
        self._sources = [Source(units, begun, nothing), Source(units, before, after)]
        self._start = _by_moments([piece[:, :n] for piece in self._pieces], relative)
        if more:
            before[n:, :d] = np.diag(scale[:d] / scale[n:])
            other = np.vstack([np.zeros((n, d)), -np.eye(d)])
            self._sources.append(Source(_units(d), other, np.zeros_like(other)))
            self._start = np.append(self._start, 0.5 * np.eye(d)[np.triu_indices(d)])
        self._repeated = repeated
        self._known: dict[float, Mixed] = {}

    def at(self, color: float) -> Mixed:
        """Return the likeliest covariances with one autocorrelation.

        Parameters
        ----------
        color : float
            From step to step [-].
        """
        if color not in self._known:
            likelihood = self._likelihood(self._pieces, color)
            near = min(self._known.values(), key=lambda one: abs(one.color - color), default=None)
            start = self._start if near is None else near.entries
            entries, value = likelihood.likeliest(start)
            self._known[color] = Mixed(color, likelihood, entries, value, likelihood.peak(entries))
        return self._known[color]

    def best(self) -> Mixed:
        """Return the likeliest of all with memory."""
        grid = np.linspace(np.log(_SHORTEST), np.log(_LONGEST), _GRID)
        values = [self._along(place) for place in grid]
        at = int(np.argmax(values))
        ends = (grid[max(at - 1, 0)], grid[min(at + 1, _GRID - 1)])
        found = minimize_scalar(
            lambda place: -self._along(place), ends, bounds=ends, method="bounded",
            options={"xatol": _CLOSE},
        )  # fmt: skip
        return max(self.at(_color(float(found.x))), self.at(_color(grid[at])), key=_peak)

    def part(self, found: Mixed, pieces: Sequence[Matrix]) -> Whittle:
        """Return the likelihood of the same covariances and memory by some of the runs alone.

        Parameters
        ----------
        found : Mixed
            The likeliest by all runs.
        pieces : sequence of (k, n) array
            Some of the runs.
        """
        return self._likelihood([piece / self._scales for piece in pieces], found.color)

    def scores(self, found: Mixed) -> Vector:
        """Return variances of the measurement noise in their standard deviations, (n,).

        Parameters
        ----------
        found : Mixed
            The likeliest.
        """
        middle, deviations = found.likelihood.unbounded(found.entries)
        own = slice(len(_units(self._size)), 2 * len(_units(self._size)))
        is_variance = np.equal(*np.triu_indices(self._size))
        scores = middle[own] / np.maximum(deviations[own], 1e-300)
        return np.asarray(scores[is_variance])

    def intervals(
        self, found: Mixed, *, has_memory: bool
    ) -> tuple[Interval, Interval, Interval | None]:
        """Return W, R and the autocorrelation, None without memory.

        Both values are positive definite. Where one hides the other, a variance's interval begins
        at zero and ends where spectra would be too unlikely. One of the measurement noise does
        also unless it is sure among those of all states (Bonferroni).

        Parameters
        ----------
        found : Mixed
            The likeliest.
        has_memory : bool
            Whether its autocorrelation is unknown, too.
        """
        half = len(_units(self._size))
        entries, (low, high) = found.entries[: 2 * half], self._ends(found)
        color = None
        if has_memory:
            color = self._colors(found)
            # What the autocorrelation leaves open adds to what is open with it (Zou 2008).
            others = [self.at(float(end)).entries[: 2 * half] for end in (color.low, color.high)]
            least, most = (part(others, axis=0) - entries for part in (np.min, np.max))
            high = entries + np.hypot(high - entries, np.maximum(most, 0.0))
            low = entries - np.hypot(entries - low, np.minimum(least, 0.0))
            variances = np.flatnonzero(np.tile(np.equal(*np.triu_indices(self._size)), 2))
            low[variances] = np.maximum(low[variances], 0.0)
        own = half + np.flatnonzero(np.equal(*np.triu_indices(self._size)))
        low[own[self.scores(found) <= float(ndtri(1.0 - _CHANCE / self._size))]] = 0.0
        back, units = np.outer(self._scale, self._scale), _units(self._size)
        W, R = (
            Interval(*(back * np.tensordot(one[part], units, 1) for one in (entries, low, high)))
            for part in (slice(0, half), slice(half, None))
        )
        return W, R, color

    def _likelihood(self, pieces: Sequence[Matrix], color: float) -> Whittle:
        """Return the likelihood of covariances by scaled runs, with one autocorrelation."""
        first, *others = self._sources
        sources = [first._replace(color=color), *others]
        seen = spectra(pieces, sources)
        units = tuple(source.units for source in sources)
        return Whittle(seen._replace(loss=seen.loss * self._repeated), units)

    def _along(self, place: float) -> float:
        """Return the log-likelihood by the logarithm of the time constant in steps."""
        return self.at(_color(float(place))).peak

    def _ends(self, found: Mixed) -> tuple[Vector, Vector]:
        """Return the ends of the intervals of W's and R's entries with one autocorrelation."""
        likelihood, entries = found.likelihood, found.entries
        middle, deviations = likelihood.unbounded(entries)
        around, beside = normal_interval(entries, deviations), normal_interval(middle, deviations)
        low, high = np.array(around.low), np.array(around.high)
        variances = np.flatnonzero(np.tile(np.equal(*np.triu_indices(self._size)), 2))
        low[variances] = np.maximum(low[variances], 0.0)
        # That no covariance is indefinite pulls the other one down; its upper end must not follow.
        ends = likelihood.upper_ends(entries, variances)
        high[variances] = np.maximum(ends, beside.high[variances])
        size = 2 * len(_units(self._size))
        return low[:size], high[:size]

    def _colors(self, found: Mixed) -> Interval:
        """Return the autocorrelation between ends that the likelihood hardly allows."""
        wanted = found.peak - 0.5 * float(chdtri(1.0, 1.0 - LEVEL)) * found.loss
        middle = float(np.log(-1.0 / np.log(found.color)))
        ends = []
        for end in (np.log(_SHORTEST), np.log(_LONGEST)):
            place = float(end)
            if self._along(place) < wanted:
                place = brentq(lambda one: self._along(one) - wanted, place, middle, xtol=_CLOSE)
            ends.append(_color(place))
        return Interval(*map(np.asarray, (found.color, *ends)))


def _color(place: float) -> float:
    """Return the autocorrelation by the logarithm of the time constant in steps."""
    return float(np.exp(-np.exp(-place)))


def _peak(one: Mixed) -> float:
    """Return the largest log-likelihood."""
    return one.peak


def _units(n: int) -> Matrix:
    """Return the symmetric matrices of unit entries, (entries, n, n)."""
    units = [np.zeros((n, n)) for _ in range(n * (n + 1) // 2)]
    for unit, i, j in zip(units, *np.triu_indices(n), strict=True):
        unit[i, j] = unit[j, i] = 1.0
    return np.array(units)


def _by_moments(pieces: Sequence[Matrix], A: Matrix) -> Vector:
    """Return a first guess of W and R, both positive definite."""
    count = sum(len(piece) for piece in pieces)
    power = sum((piece.T @ piece for piece in pieces), np.zeros(A.shape)) / count
    next_one = sum((piece[1:].T @ piece[:-1] for piece in pieces), np.zeros(A.shape)) / count
    seen = -np.linalg.solve(A, next_one)
    floor = 0.02 * np.eye(len(A))
    R = nearest_covariance(0.5 * (seen + seen.T)) + floor
    W = nearest_covariance(power - R - A @ R @ A.T) + floor
    upper = np.triu_indices(len(A))
    return np.concatenate([W[upper], R[upper]])
